"""The reference: linkage description, Assur groups, kinematics and reduced dynamics in closed form."""
