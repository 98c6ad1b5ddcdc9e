"""What the words of a header say: quantities that it may be of, components, and whose they are."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Final

from analytic.errors import LinkproofError, listed, shortened
from comparisons.imported.columns import MAGNITUDE
from comparisons.imported.headers.units import Dimension
from comparisons.imported.headers.words import Word

# Exponents of m, kg, s and rad.
DIMENSIONS: Final[Mapping[str, Dimension]] = {
    "time": (0, 0, 1, 0),
    "angle": (0, 0, 0, 1),
    "angular_speed": (0, 0, -1, 1),
    "angular_acceleration": (0, 0, -2, 1),
    "displacement": (1, 0, 0, 0),
    "speed": (1, 0, -1, 0),
    "acceleration": (1, 0, -2, 0),
    "torque": (2, 1, -2, 0),
    "force": (1, 1, -2, 0),
    "power": (2, 1, -3, 0),
    "energy": (2, 1, -2, 0),
    "inertia": (2, 1, 0, 0),
}
TURNING: Final = {
    "angle": ("phi", "angle"),
    "angular_speed": ("omega", "omega"),
    "angular_acceleration": ("epsilon", "alpha"),
}
# The quantity that turns where a word speaks of any.
ANGULAR: Final = {"displacement": "angle", "speed": "angular_speed", "acceleration": "angular_acceleration"}
COMPONENTS: Final = ("x", "y", "z", MAGNITUDE)


class NotJudgedError(LinkproofError):
    """A column that means no signal, or may mean several; the message is the reason."""


@dataclass(frozen=True)
class Said:
    """What the words of a header say: quantities it may be of, components, and whose."""

    quantities: frozenset[str]
    components: frozenset[str]
    meanings: frozenset[str]
    links: tuple[str, ...]
    points: tuple[str, ...]
    joints: tuple[str, ...]

    @property
    def component(self) -> str:
        """The one component, "" if there is none; raises NotJudgedError for several."""
        if len(self.components) > 1:
            raise NotJudgedError(f"its name has the components {listed(sorted(self.components))}")
        return next(iter(self.components), "")


def by_owner(said: Said) -> frozenset[str]:
    """Of the quantities that words and unit leave, those that what is named can have."""
    quantities = said.quantities
    if len(quantities) == 1:
        return quantities
    turning, along = quantities & set(TURNING), quantities - set(TURNING)
    if said.points or said.meanings & {"output"} or said.components & {"x", "y"}:
        return along or quantities
    if said.links or "drive" in said.meanings:
        return turning or quantities
    return quantities


def quantities_in(meanings: Iterable[str]) -> tuple[frozenset[str], frozenset[str]]:
    """The quantities and components that meanings allow; a unit may leave one of several."""
    meanings = set(meanings)
    components: set[str] = {part for part in COMPONENTS if part in meanings}
    for meaning in list(meanings):
        quantity, _, part = meaning.rpartition("_")
        if part in COMPONENTS and quantity in DIMENSIONS:
            meanings.add(quantity)
            components |= {part}
    if "angle_or_angular_acceleration" in meanings:
        meanings |= {"angle", "angular_acceleration"}
    if "path" in meanings or meanings >= {"length", "drive"}:  # any other length is no signal
        meanings.add("displacement")
    if "kinetic" in meanings:
        meanings.add("energy")
    quantities = meanings & set(DIMENSIONS)
    if "inertia" in quantities or quantities >= {"torque", "inertia"}:
        quantities = {"inertia"}
    if quantities > {"angle"} and quantities & set(ANGULAR):  # "Winkel", "角": of an angle, before another word
        quantities -= {"angle"}
        meanings.add("angular")
    for linear, angular in ANGULAR.items():
        if linear in quantities and "linear" not in meanings:
            quantities.add(angular)
            if "angular" in meanings:
                quantities.discard(linear)
    return frozenset(quantities), frozenset(components)


def check_known(found: Iterable[Word]) -> None:
    """Raise NotJudgedError for a word that means nothing: whoever exported it has to say what it is."""
    for word in found:
        if not (word.meanings or word.kind):
            raise NotJudgedError(f"'{shortened(word.text)}' in its name is no link, point or joint, nor a known word")
