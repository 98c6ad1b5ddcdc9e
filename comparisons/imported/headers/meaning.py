"""The signal of a linkage that a header means: one, or none with the reason."""

from __future__ import annotations

from contextlib import suppress
from dataclasses import dataclass
from functools import cached_property
from typing import Final

import numpy as np

from analytic import signals
from analytic.description.linkage import Linkage
from analytic.errors import UnknownNameError, listed, shortened
from analytic.kinematics.mechanism import Mechanism
from comparisons.imported.columns import MAGNITUDE, TIME, Column
from comparisons.imported.headers.header import SplitHeader, splits
from comparisons.imported.headers.said import (
    DIMENSIONS,
    TURNING,
    NotJudgedError,
    Said,
    by_owner,
    check_known,
    quantities_in,
)
from comparisons.imported.headers.units import OFFERED, Unit, parsed
from comparisons.imported.headers.words import Names, Word, bodies, names_of, words

ORDERS: Final = {"displacement": ("S", "", "phi"), "speed": ("v", "v", "omega"), "acceleration": ("a", "a", "epsilon")}


@dataclass(frozen=True)
class Meaning:
    """The signal that a column means, the unit it is in (None: the header states none), and what was taken so."""

    signal: str
    unit: Unit | None
    printed: str
    taken: str = ""


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
        known = signals.names(Mechanism(self.linkage))
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
        """What a column means; raises NotJudgedError with the reason, UnknownNameError for an unknown unit."""
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
        found = words(name, names)
        check_known(found)
        return self._signal(self._said(found, unit), column)

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

    def _said(self, found: list[Word], unit: Unit | None) -> Said:
        meanings = frozenset(m for word in found if not (word.kind and len(word.text) == 1) for m in word.meanings)
        quantities, components = quantities_in(meanings)
        joints, points = list(bodies(found, "joint")), list(bodies(found, "point"))
        if unit is not None:
            if not quantities and (joints or points or meanings & {"drive", "output"}):
                quantities = frozenset(DIMENSIONS) - {"energy", "time", "inertia"}
            fitting = frozenset(q for q in quantities if unit.measures(DIMENSIONS[q]))
            quantities = fitting or quantities
        elif not quantities and points and components:
            quantities = frozenset({"displacement"})
        return Said(quantities, components, meanings, tuple(bodies(found, "link")), tuple(points), tuple(joints))

    def _signal(self, said: Said, column: Column) -> tuple[str, str]:
        """The signal of what was said, and what was taken for granted."""
        if "elsewhere" in said.meanings:
            raise NotJudgedError("the closed form has no such quantity")
        if not said.quantities:
            raise NotJudgedError("its name contains no known quantity")
        quantities = by_owner(said)
        if len(quantities) > 1:
            raise NotJudgedError(f"it may be {' or '.join(sorted(quantities)).replace('_', ' ')}: add its unit")
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

    def _is_crank(self, said: Said) -> bool:
        return all(link == self.linkage.crank for link in said.links)

    def _turning(self, quantity: str, said: Said) -> tuple[str, str]:
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

    def _of_drive(self, quantity: str, said: Said) -> tuple[str, str]:
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

    def _moving(self, quantity: str, said: Said) -> tuple[str, str]:
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
        slides = output is not None and any(slider.point == output.point for slider in self.linkage.sliders)
        is_output = (
            slides
            and output is not None
            and [*points] == [output.point]
            and not said.links
            and quantity in said.meanings
        )
        if (points and not is_output) or component or output is None or "path" in said.meanings:
            known = listed(signals.moving_points(self.linkage))
            raise NotJudgedError(f"its name has no point with a component, as in 'D.x' (points are {known})")
        if said.links and set(said.links) != {output.link}:
            raise NotJudgedError(f"it is of {listed(said.links)}, which is not the output, and has no point")
        return of_output, f"taken as the output's, {output.point} along {_direction(output.along)}"

    def _force(self, said: Said, column: Column) -> tuple[str, str]:
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

    def _joints(self, said: Said) -> list[str]:
        """The joints that may be meant: those named, or those at the point named, on the link named if there is one."""
        known = self.linkage.joint_names
        named = set(said.joints) or {j for j in known for point in said.points if j.startswith(f"{point}:")}
        on_link = {j for j in named for link in said.links if j.endswith(f":{link}")}
        return sorted(on_link or named)


def _direction(along: tuple[float, float]) -> str:
    return f"[{along[0]:.4g}, {along[1]:.4g}]"
