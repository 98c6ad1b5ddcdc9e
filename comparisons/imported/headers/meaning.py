"""The signal of a linkage that a header means: one, or none with the reason."""

from __future__ import annotations

import difflib
from collections.abc import Iterable, Mapping
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache
from typing import Final

import numpy as np

from analytic.description.linkage import Linkage
from analytic.errors import LinkproofError, UnknownNameError, listed, shortened
from analytic.kinematics.mechanism import Mechanism
from comparisons.imported.columns import MAGNITUDE, TIME, Column
from comparisons.imported.headers.header import SplitHeader, splits
from comparisons.imported.headers.units import OFFERED, Dimension, Unit, parsed
from comparisons.imported.headers.words import MEANINGS, Names, Word, bodies, names_of, words
from comparisons.reference import signals

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
ORDERS: Final = {"displacement": ("S", "", "phi"), "speed": ("v", "v", "omega"), "acceleration": ("a", "a", "epsilon")}
TURNING: Final = {
    "angle": ("phi", "angle"),
    "angular_speed": ("omega", "omega"),
    "angular_acceleration": ("epsilon", "alpha"),
}
# The quantity that turns where a word speaks of any.
ANGULAR: Final = {"displacement": "angle", "speed": "angular_speed", "acceleration": "angular_acceleration"}
COMPONENTS: Final = ("x", "y", "z", MAGNITUDE)
SIMILAR: Final = 0.85  # share of equal letters from which one word is taken for a misspelling of another
SHORTEST: Final = 5  # letters of a word that may be misspelled


class NotJudgedError(LinkproofError):
    """A column that means no signal, or may mean several; the message is the reason."""


@dataclass(frozen=True)
class Meaning:
    """The signal that a column means, the unit it is in (None: the header states none), and what was taken so."""

    signal: str
    unit: Unit | None
    printed: str
    taken: str = ""


@dataclass(frozen=True)
class _Said:
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


@dataclass(frozen=True)
class Recognition:
    """Headers in the words of one linkage."""

    linkage: Linkage

    @cached_property
    def names(self) -> Names:
        """Names of links, points and joints."""
        return names_of(self.linkage)

    @cached_property
    def signals(self) -> tuple[str, ...]:
        """Names of all signals, with the sizes of joint forces."""
        known = signals.names_of(Mechanism(self.linkage))
        sizes = [
            f"{name[:-2]}:{MAGNITUDE}" for name in known if name.startswith("joint_force:") and name.endswith(":x")
        ]
        return (*known, *sizes)

    def unit(self, name: str) -> Unit:
        """SI unit of a signal or of time."""
        text = self.si(name)
        unit = parsed(text)
        assert unit is not None, text
        return unit

    def si(self, name: str) -> str:
        """The name of the SI unit of a signal or of time."""
        return "s" if name == TIME else "N" if name.endswith(f":{MAGNITUDE}") else signals.unit(name, self.linkage)

    def printed_unit(self, column: Column, signal: str) -> tuple[Unit | None, str]:
        """The unit that a header states where it measures a signal; None and "" if it states none."""
        dimension = self.unit(signal).dimension
        for split in splits(column.header, column.unit):
            unit = parsed(split.unit)
            if unit is not None and unit.measures(dimension):
                return unit, split.unit
        return None, ""

    def meaning(self, column: Column) -> Meaning:
        """What a column means; raises NotJudgedError with the reason, UnknownNameError for a unit that is none."""
        tried = []
        for split in splits(column.header, column.unit):
            try:
                return self._meaning(split, column)
            except NotJudgedError as reason:
                tried.append((split, reason))
        raise tried[0][1] if tried[0][0].is_certain else tried[-1][1]

    def _meaning(self, split: SplitHeader, column: Column) -> Meaning:
        name = split.name.strip()
        unit = parsed(split.unit) if split.unit else None
        if name in self.signals or name == TIME:
            return self._checked(Meaning(name, unit, split.unit), split)
        named, taken = self._named(name, unit, column)
        if named not in self.signals and named != TIME:
            raise NotJudgedError(f"the linkage has no {named}")
        return self._checked(Meaning(named, unit, split.unit, taken), split)

    def _named(self, name: str, unit: Unit | None, column: Column) -> tuple[str, str]:
        """What a name means; "M [Nm]" is a torque even where a point is called M."""
        try:
            return self._read(name, unit, column, self.names)
        except NotJudgedError as reason:
            if len(name) == 1 and unit:
                with suppress(NotJudgedError):
                    return self._read(name, unit, column, Names({}))
            raise reason

    def _read(self, name: str, unit: Unit | None, column: Column, names: Names) -> tuple[str, str]:
        """The signal that a name in a unit means, and what was taken for granted."""
        found, spelled = _known(words(name, names))
        named, taken = self._signal(self._said(found, unit), column)
        return named, "; ".join(filter(None, (spelled, taken)))

    def _checked(self, meaning: Meaning, split: SplitHeader) -> Meaning:
        if not split.unit:
            return meaning
        if meaning.unit is None:
            if split.is_certain and not self._is_name(split.unit):
                raise UnknownNameError(
                    f"unit of '{shortened(split.name)}'", split.unit, self.offered_units(meaning.signal)
                )
            raise NotJudgedError(f"'{split.unit}' is no unit")
        if not meaning.unit.measures(self.unit(meaning.signal).dimension):
            raise NotJudgedError(f"'{split.unit}' is no unit of {meaning.signal}")
        return meaning

    def offered_units(self, signal: str) -> list[str]:
        """Some names of units that a signal may be in."""
        return OFFERED.get(self.unit(signal).dimension) or [self.si(signal)]

    def _is_name(self, text: str) -> bool:
        """Whether what stands in brackets is more of the name: ``Torque (Motor1)``."""
        return all(word.meanings or word.kind for word in words(text, self.names))

    def _said(self, found: list[Word], unit: Unit | None) -> _Said:
        meanings = frozenset(m for word in found if not (word.kind and len(word.text) == 1) for m in word.meanings)
        quantities, components = _quantities(meanings)
        joints, points = list(bodies(found, "joint")), list(bodies(found, "point"))
        if unit is not None:
            if not quantities and (joints or points or meanings & {"drive", "output"}):
                quantities = frozenset(DIMENSIONS) - {"energy", "time", "inertia"}
            fitting = frozenset(q for q in quantities if unit.measures(DIMENSIONS[q]))
            quantities = fitting or quantities
        elif not quantities and points and components:
            quantities = frozenset({"displacement"})
        return _Said(quantities, components, meanings, tuple(bodies(found, "link")), tuple(points), tuple(joints))

    def _signal(self, said: _Said, column: Column) -> tuple[str, str]:
        """The signal of what was said, and what was taken for granted."""
        if "elsewhere" in said.meanings:
            raise NotJudgedError("the closed form has no such quantity")
        if not said.quantities:
            raise NotJudgedError("its name says no quantity that is known")
        quantities = _by_owner(said)
        if len(quantities) > 1:
            raise NotJudgedError(f"it may be {' or '.join(sorted(quantities)).replace('_', ' ')}: its unit would tell")
        (quantity,) = quantities
        if quantity == "time":
            return TIME, ""
        if quantity in TURNING:
            return self._turning(quantity, said)
        if quantity in ORDERS:
            return self._moving(quantity, said)
        if quantity == "force":
            return self._force(said, column)
        return self._of_drive(quantity, said)

    def _is_crank(self, said: _Said) -> bool:
        return all(link == self.linkage.crank for link in said.links)

    def _turning(self, quantity: str, said: _Said) -> tuple[str, str]:
        of_crank, of_link = TURNING[quantity]
        if said.component in ("x", "y"):
            raise NotJudgedError("it turns out of the plane of the linkage")
        if said.joints or said.points or said.meanings & {"reaction", "output"}:
            raise NotJudgedError("an angle is that of a link, and its name has a point or a joint")
        if len(set(said.links)) > 1:
            raise NotJudgedError(f"its name has the links {listed(said.links)}")
        if not self._is_crank(said):
            return f"link:{said.links[0]}:{of_link}", ""
        if self.linkage.is_linear:
            raise NotJudgedError("its name has no link, and the drive does not turn")
        owned = said.links or "drive" in said.meanings
        return of_crank, "" if owned else "its name has no link: taken as the crank's"

    def _of_drive(self, quantity: str, said: _Said) -> tuple[str, str]:
        """Torque, power, kinetic energy and reduced inertia."""
        if quantity == "torque" and said.meanings & {"shaking"}:
            return "shaking_moment", ""
        if not self._is_crank(said) or said.points or said.joints or said.meanings & {"reaction", "output"}:
            raise NotJudgedError(f"the closed form has the {quantity} of the drive and of the whole linkage only")
        if quantity == "torque" and said.component in ("x", "y"):
            raise NotJudgedError("it acts out of the plane of the linkage")
        if quantity == "energy" and "kinetic" not in said.meanings:
            raise NotJudgedError("it may be kinetic or potential energy, or their sum")
        if quantity == "inertia" and "reduced" not in said.meanings:
            raise NotJudgedError("it may be the inertia of a link: that reduced to the crank is Jeq")
        name = {"torque": "Mkr", "power": "Peq", "energy": "Teq", "inertia": "Jeq"}[quantity]
        owned = said.links or "drive" in said.meanings or name in ("Teq", "Jeq")
        return name, "" if owned else "its name has no drive: taken as the crank's"

    def _moving(self, quantity: str, said: _Said) -> tuple[str, str]:
        of_output, of_point, of_drive = ORDERS[quantity]
        component = said.component
        if component == "z":
            raise NotJudgedError("it moves out of the plane of the linkage")
        points = dict.fromkeys(said.points)
        if len(points) > 1 or (said.joints and not points):
            raise NotJudgedError(f"its name has more than one point: {listed((*points, *said.joints))}")
        if points and component in ("x", "y"):
            return f"point:{next(iter(points))}:{of_point}{component}", ""
        along = self.linkage.is_linear
        if along and not points and ("drive" in said.meanings or self.linkage.crank in said.links):
            return of_drive, ""
        output = self.linkage.output
        if points or component or output is None or "path" in said.meanings:
            known = listed(signals.moving_points(self.linkage))
            raise NotJudgedError(f"its name has no point with a component, as in 'D.x' (points are {known})")
        if said.links and set(said.links) != {output.link}:
            raise NotJudgedError(f"it is of {listed(said.links)}, which is not the output, and has no point")
        return of_output, f"taken as the output's, {output.point} along {_direction(output.along)}"

    def _force(self, said: _Said, column: Column) -> tuple[str, str]:
        component = said.component
        if component == "z":
            raise NotJudgedError("it acts out of the plane of the linkage")
        if "shaking" in said.meanings and component in ("x", "y"):
            return f"shaking_force:{component}", ""
        if "drive" in said.meanings and self.linkage.is_linear:
            return "Mkr", ""
        joints = self._joints(said)
        if len(joints) != 1:
            known = listed(joints or self.linkage.joint_names)
            raise NotJudgedError(f"its name has not one joint (joints are {known})")
        if component in ("x", "y"):
            return f"joint_force:{joints[0]}:{component}", ""
        if np.any(column.values < 0.0):
            raise NotJudgedError(
                "its name has no component, and it changes its sign, which the size of a force does not"
            )
        taken = "" if component else "its name has no component: taken as the size of the force"
        return f"joint_force:{joints[0]}:{MAGNITUDE}", taken

    def _joints(self, said: _Said) -> list[str]:
        """The joints that may be meant: those named, or those at the point named, on the link named if there is one."""
        known = self.linkage.joint_names
        named = set(said.joints) or {j for j in known for point in said.points if j.startswith(f"{point}:")}
        on_link = {j for j in named for link in said.links if j.endswith(f":{link}")}
        return sorted(on_link or named)


def _by_owner(said: _Said) -> frozenset[str]:
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


def _quantities(meanings: Iterable[str]) -> tuple[frozenset[str], frozenset[str]]:
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


def _known(found: list[Word]) -> tuple[list[Word], str]:
    """Words that all mean something, misspelled ones put right, and what was put right."""
    result, spelled = [], []
    for word in found:
        if word.meanings or word.kind:
            result.append(word)
            continue
        near = _nearest(word.text.lower())
        if near is None:
            raise NotJudgedError(f"'{shortened(word.text)}' in its name is no link, point or joint, nor a known word")
        result.append(replace(word, meanings=frozenset(MEANINGS[near])))
        spelled.append(f"'{word.text}' read as '{near}'")
    return result, "; ".join(spelled)


@lru_cache(maxsize=4096)
def _nearest(word: str) -> str | None:
    """The known word that a word is a misspelling of, if any."""
    near = difflib.get_close_matches(word, MEANINGS, n=1, cutoff=SIMILAR) if len(word) >= SHORTEST else []
    return near[0] if near else None


def _direction(along: tuple[float, float]) -> str:
    return f"[{along[0]:.4g}, {along[1]:.4g}]"
