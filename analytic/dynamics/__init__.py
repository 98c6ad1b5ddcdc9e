"""What the crank feels of the linkage: reduced inertia, generalised force, joint forces, equilibria."""
