"""Small projects of a user's, and pytest run in them with the plug-in loaded as it is installed, or by its module."""

from importlib.metadata import entry_points
from pathlib import Path

ROOT = Path(__file__).parents[3]
PLUGIN = "linkproof" if "linkproof" in entry_points(group="pytest11").names else "linkproof.pytest_plugin"
BAR = """
title = "a bar that turns"
units = { length = "m", mass = "kg", inertia = "kg*m^2", angle = "deg" }
crank = "bar"
gravity = [0, -9.81]
[ground]
O = [0, 0]
[links.bar]
points = { O = [0, 0] }
mass = 2.0
centre = [0.1, 0]
inertia = 0.01
"""
QUANTITIES = ("Jeq", "Teq", "Mkr", "Peq", "joint_force:O")
INVARIANTS = ("joint_gap", "closure", "assembly_mode", "crank_phase", "energy_balance", "torque_two_routes",
              "force_balance")  # fmt: skip


def project(pytester, *lines, **linkages):
    """Write a ``linkproof.toml`` of these lines and files of linkages, by name, in ``linkages/``."""
    folder = pytester.mkdir("linkages")
    for name, text in (linkages or {"bar": BAR}).items():
        (folder / f"{name}.toml").write_text(text)
    text = "\n".join(('linkages = ["linkages/*.toml"]', *(lines or ('engines = ["direct"]',))))
    (pytester.path / "linkproof.toml").write_text(text)


def run(pytester, *words):
    """Run pytest in this process."""
    return pytester.runpytest_inprocess("-p", PLUGIN, "-p", "no:cacheprovider", *words)
