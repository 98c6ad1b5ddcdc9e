"""The truth an engine is compared with: cases and their start states."""
