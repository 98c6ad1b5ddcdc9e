"""Linkages of any size: a crank with a chain of four-bars behind it, each driven by the rocker before it."""

HEAD = """title = "chain of dyads"
source = "made up for the tests"
units = { length = "mm", mass = "kg", inertia = "kg*m^2", angle = "deg" }
crank = "crank"
gravity = [0, -9.81]

[links.crank]
points = { O0 = [0, 0], P0 = [20, 0] }
mass = 0.1
inertia = 1e-5
"""

DYAD = """
[links.coupler{number}]
points = {{ P{before} = [0, 0], P{number} = [100, 0] }}
mass = 0.1
centre = [50, 0]
inertia = 1e-5

[links.rocker{number}]
points = {{ O{number} = [0, 0], P{number} = [45, 0] }}
mass = 0.1
inertia = 1e-5
"""


def chain_of_dyads(dyads: int) -> str:
    """The text of a linkage of 2 ``dyads`` + 1 links; its crank turns fully."""
    numbers = range(1, dyads + 1)
    groups = "".join(DYAD.format(number=number, before=number - 1) for number in numbers)
    ground = "".join(f"O{number} = [{100 * number}, 0]\n" for number in (0, *numbers))
    sketch = ", ".join(f"P{number} = [{100 * number}, 45]" for number in numbers)
    return f"{HEAD}{groups}\n[ground]\n{ground}\n[sketch]\nangle = 90\npoints = {{ {sketch} }}\n"
