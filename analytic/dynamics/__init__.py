"""Dynamics reduced to the crank: reduced inertia, generalised force, joint forces, equilibria."""
