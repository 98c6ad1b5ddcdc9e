"""What holds in every true motion, checked on the engine's own; no closed form enters."""
