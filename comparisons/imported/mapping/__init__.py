"""The mapping: which column is which signal, in which unit, and the corrections that are agreed to."""
