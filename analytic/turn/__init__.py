"""Figures of one turn of the crank: unit functions of the output, thread feed."""
