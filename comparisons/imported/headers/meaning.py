"""The signal of a linkage that a header means: the one of which all its words and its unit are true.

Of every signal it is known which words are true of it and which it needs. No word of a header is passed over: one that
is unknown, or true of no signal that the others mean, leaves the column to the mapping.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Final

import numpy as np

from analytic import signals
from analytic.description.linkage import GROUND, Linkage
from analytic.errors import LinkproofError, UnknownNameError, listed, shortened
from analytic.kinematics.mechanism import Mechanism
from comparisons.imported.columns import TIME, Column
from comparisons.imported.headers.header import splits
from comparisons.imported.headers.units import OFFERED, Unit, parsed
from comparisons.imported.headers.words import Table, Word, named, words

Words = frozenset[str]
LONGEST: Final = 200  # characters of a header that is read
# The quantity itself, its speed, its acceleration: of what moves along a line, of what turns.
STRAIGHT: Final = ({"displacement"}, {"speed"}, {"acceleration"})
TURNING: Final = ({"angle", "displacement"}, {"angular_speed", "speed"}, {"angular_acceleration", "acceleration"})
AXES: Final = ("x", "y")
COMPONENTS: Final = frozenset({*AXES, "z", "magnitude"})  # each of which has to be true: "vx" is a speed and x
AROUND: Final = {"angular", "angle", "z"}  # true of all that turns
OF_DRIVE: Final = ("phi", "omega", "epsilon", "Mkr", "Peq")


class NotJudgedError(LinkproofError):
    """A column that means no signal, or may mean several; the message is the reason."""


@dataclass(frozen=True)
class Meaning:
    """The signal that a column means, the unit it is in (None: the header states none), and what was taken so."""

    signal: str
    unit: Unit | None
    printed: str
    taken: str = ""


class _True:
    """What is true of a signal: words for its ``quantity``, each set that it ``needs`` one of, and ``others``."""

    def __init__(self, quantity: set[str], *needs: set[str], others: set[str]) -> None:
        self.quantity, self.needs, self.others = quantity, needs, others
        self.words: Words = frozenset(quantity.union(others, *needs))


@dataclass(frozen=True)
class Recognition:
    """Headers in the words of one linkage."""

    linkage: Linkage

    @cached_property
    def signals(self) -> tuple[str, ...]:
        """Names of all signals, with the magnitudes of forces."""
        return signals.names_with_magnitudes(Mechanism(self.linkage))

    @cached_property
    def _names(self) -> Table:
        points = {point for link in self.linkage.links.values() for point in link.points} | {*self.linkage.ground}
        return named({*self.linkage.links, *points, *self.linkage.joint_names} - {GROUND})

    @cached_property
    def _true(self) -> dict[str, _True]:
        linkage, drive = self.linkage, {"drive", f":{self.linkage.crank}"}
        along, output = linkage.is_linear, linkage.output
        driven = (*(STRAIGHT if along else TURNING), {"force"} if along else {"torque"})
        others = {"linear", "length"} if along else AROUND
        true = {TIME: _True({TIME}, {TIME}, others=set())}
        for name, quantity in zip(OF_DRIVE, driven, strict=False):
            true[name] = _True(quantity, drive if along else quantity | drive, others=others)
        true["Peq"] = _True({"power"}, {"power"} | drive, others=set())
        true["Teq"] = _True({"energy"}, {"kinetic"}, others=set())
        true["Jeq"] = _True({"inertia"}, {"reduced"}, others={"torque"})  # "moment of inertia"
        true["shaking_moment"] = _True({"torque"}, {"shaking"}, others={"reaction", "z"})
        if output is not None:
            slides = any(slider.point == output.point for slider in linkage.sliders)
            owners = {"linear", f":{output.link}", f":{output.point}" if slides else ""}
            for name, quantity in zip(signals.OUTPUT, STRAIGHT, strict=True):
                true[name] = _True(quantity, quantity | {"output"}, others=owners)
        parts = (name for name in self.signals if ":" in name and not name.startswith("transmission_angle"))
        true |= {name: self._of_part(name) for name in parts}
        return {name: true[name] for name in (TIME, *self.signals) if name in true}

    def _of_part(self, name: str) -> _True:
        """What is true of a signal of a point, a link or a joint, and of the force on the ground."""
        kind, _, rest = name.partition(":")
        part, _, component = rest.rpartition(":")
        point, _, link = part.partition(":")
        links = {f":{n}" for n, one in self.linkage.links.items() if point in one.points and link in ("", n)}
        axes = {component[-1:]} & {*AXES}
        needs = [axes] if axes else []
        if kind == "point":
            quantity = STRAIGHT[signals.ORDERS.index(component) // 2]
            return _True(quantity, {f":{part}"}, *needs, others={"linear", "path", *links})
        if kind == "link":
            quantity = TURNING[tuple(signals.COMPONENTS["link"]).index(component)]
            return _True(quantity, {f":{part}"}, others=AROUND)
        owner = {f":{part}", f":{point}"} if kind == "joint_force" else {"shaking"}
        return _True({"force"}, owner, *needs, others={"reaction", *(links if part else ())} | (axes or {"magnitude"}))

    @cached_property
    def _quantities(self) -> Words:
        return Words().union(*(true.quantity for true in self._true.values()))

    def unit(self, name: str) -> Unit:
        """SI unit of a signal or of time."""
        text = self.si(name)
        unit = parsed(text)
        assert unit is not None, text
        return unit

    def si(self, name: str) -> str:
        """The name of the SI unit of a signal or of time."""
        return "s" if name == TIME else signals.unit(name, self.linkage)

    def offered_units(self, signal: str) -> list[str]:
        """Some names of units that a signal may be in."""
        return OFFERED.get(self.unit(signal).dimension) or [self.si(signal)]

    def printed_unit(self, column: Column, signal: str) -> tuple[Unit | None, str]:
        """The unit that a header states where it measures a signal; None and "" if it states none."""
        for _, text in splits(column.header, column.unit):
            unit = parsed(text)
            if unit is not None and unit.measures(self.unit(signal).dimension):
                return unit, text
        return None, ""

    def meaning(self, column: Column) -> Meaning:
        """What a column means; raises NotJudgedError with the reason, UnknownNameError for an unknown unit."""
        if len(column.header) > LONGEST:
            raise NotJudgedError(f"its name '{shortened(column.header)}' is longer than {LONGEST} characters")
        reasons, unknown = [], []
        for name, text in splits(column.header, column.unit):
            unit = parsed(text)
            if text and unit is None:
                unknown.append((name, text))
                continue
            try:
                signal, taken = self._signal(name.strip(), unit, text, column)
            except NotJudgedError as reason:
                reasons.append(reason)
            else:
                return Meaning(signal, unit, text, taken)
        for name, text in unknown:
            try:
                signal, _ = self._signal(name.strip(), None, "", column)
            except NotJudgedError as reason:
                reasons.append(reason)
            else:
                raise UnknownNameError(f"unit of '{shortened(name)}'", text, self.offered_units(signal))
        raise reasons[0]

    def _signal(self, name: str, unit: Unit | None, printed: str, column: Column) -> tuple[str, str]:
        """The signal that a name in a unit means, and what was taken for granted."""
        if name in self._true or name in self.signals:
            if unit and not unit.measures(self.unit(name).dimension):
                raise NotJudgedError(f"'{printed}' is no unit of {name}")
            return name, ""
        read = list(words(name, self._names))
        for word in read:
            if not word.meanings:
                raise NotJudgedError(
                    f"'{shortened(word.text)}' in its name is no link, point or joint, nor a known word"
                )
        fitting = self._fitting(read, unit)
        if not fitting:
            others = self._fitting(read, None) if unit else {}
            raise NotJudgedError(f"'{printed}' is no unit of {listed(others)}" if others else self._why(read, unit))
        named = {name: sum(word.startswith(":") for word in stated) for name, stated in fitting.items()}
        best = [name for name in fitting if named[name] == max(named.values())]
        best = [name for name in best if ":" not in name] or best
        if len(best) > 1:
            raise NotJudgedError(f"it may be {listed(best)}: add its unit, or the name and component that it lacks")
        return best[0], self._taken(best[0], fitting[best[0]], column)

    def _fitting(self, read: list[Word], unit: Unit | None) -> dict[str, Words]:
        """The signals of which all words are true and that need no other, each with what the words say of it."""
        fitting = {}
        for name, true in self._true.items():
            true_words = [word.meanings & true.words for word in read if word.meanings & COMPONENTS <= true.words]
            every = Words().union(*true_words)
            is_place = name.startswith("point:") and name[-2] == ":"  # "D.x", without a word for it
            measured = every & self._quantities
            has_quantity = bool(measured & true.quantity) if measured else unit is not None or is_place
            if (
                len(true_words) == len(read)
                and all(true_words)
                and has_quantity
                and all(every & need for need in true.needs)
            ):
                fitting[name] = every
        return {n: stated for n, stated in fitting.items() if unit is None or unit.measures(self.unit(n).dimension)}

    def _why(self, read: list[Word], unit: Unit | None) -> str:
        """Why words that are all known mean no signal: what there is of their kind."""
        stated = Words().union(*(word.meanings for word in read))
        kind = [name for name, true in self._true.items() if stated & true.quantity]
        kind = kind or [name for name in self._true if unit and unit.measures(self.unit(name).dimension)]
        if "elsewhere" in stated or not kind:
            return "the closed form has no such quantity"
        return f"its name fits none of {listed(dict.fromkeys(one.rpartition(':')[0] or one for one in kind))}"

    def _taken(self, signal: str, stated: Words, column: Column) -> str:
        """What is taken for granted of a column that means a signal; raises NotJudgedError where its values differ."""
        output = self.linkage.output
        if signal in OF_DRIVE and not stated & {"drive", f":{self.linkage.crank}"}:
            return "its name has no link: taken as the crank's"
        if signal in ("S", "v", "a") and output is not None:
            return f"taken as the output's, {output.point} along [{output.along[0]:.4g}, {output.along[1]:.4g}]"
        if signal.endswith(signals.MAGNITUDE):
            if np.any(column.values < 0.0):
                raise NotJudgedError("its name has no component, and it changes its sign, as no size of a force does")
            return "" if "magnitude" in stated else "its name has no component: taken as the size of the force"
        return ""
