"""An engine's history read back: interpolated, integrated, as motions of bodies and powers of loads."""
