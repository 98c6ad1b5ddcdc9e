"""Every mechanism under every regime in every engine and setting, judged into records."""
