"""Assur groups: found, solved in closed form, differentiated over the crank angle, and bounded in their error."""
