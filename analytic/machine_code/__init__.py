"""The closed form as machine code: its formulas traced into one list of operations, printed as a function, compiled."""
