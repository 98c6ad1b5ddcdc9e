"""Many designs of one linkage at once: numbers of its description that vary, and resulting signals and figures."""
