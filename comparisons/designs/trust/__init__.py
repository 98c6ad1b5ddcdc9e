"""How far engines may be trusted over a space of designs: a sample of it, simulated."""
