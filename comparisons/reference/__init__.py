"""The truth an engine is compared with: cases, their start states, published figures."""
