"""The closed form as machine code, for long sweeps, many designs and released cranks."""
