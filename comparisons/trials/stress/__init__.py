"""Stability maps: axes, cells, verdicts and borders."""
