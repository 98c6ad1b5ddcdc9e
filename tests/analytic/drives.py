"""Linkages that are not driven by a crank, or not made of dyads, in tests/linkages/drives."""

from functools import cache

from analytic.description.loading import load
from analytic.kinematics.mechanism import Mechanism
from tests.analytic.linkages import FOLDER


def path_of(name: str) -> str:
    """The file of a linkage."""
    return str(FOLDER / "drives" / f"{name}.toml")


@cache
def driven(name: str) -> Mechanism:
    """A linkage of the folder."""
    return Mechanism(load(path_of(name)))
