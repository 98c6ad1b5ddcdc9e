"""The invariants of every true motion, checked on the engine's own motion, without the closed form."""
