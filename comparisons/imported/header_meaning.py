"""The signal of a linkage that a header means: the one of which all its words and its unit are true.

Of every signal it is known which words are true of it and which it needs. No word of a header is passed over: one that
is unknown, or true of no signal that the others mean, leaves the column to the mapping.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Final

import numpy as np

from analytic import signals
from analytic.description.linkage import GROUND, Linkage
from analytic.errors import LinkproofError, listed, shortened
from analytic.kinematics.mechanism import Mechanism
from comparisons.imported.columns import TIME, Column
from comparisons.imported.header_words import Meanings, Table, Unit, header_words, name_meanings, parse_unit

LONGEST: Final = 200  # characters of a header that is read
# A name and its unit: "Torque (N*m)", "Torque [Nm]", "M{Nm}"; "M in Nm", "M / Nm", "M, Nm", "torque_Nm", "Torque Nm".
WITH_UNIT: Final = (
    r"(.*?)\s*[(\[{<]\s*([^()\[\]{}<>]*(?:\([^()]*\)[^()\[\]{}<>]*)?)\s*[)\]}>]\s*",
    r"(.+?)\s+in\s+(\S.*)", r"([^/]+?)\s*/\s*(\S.*)", r"(.+?)\s*[,:;]\s*(\S.*)", r"(.+)_([^_]+)", r"(.+)\s+(\S+)",
)  # fmt: skip
REPEAT_NUMBER: Final = re.compile(r"\s#\d+$")  # the number of a repeated header
# What a signal in an SI unit measures, and what else is true of it.
QUANTITIES: Final = {
    "s": {TIME}, "m": {"displacement"}, "m/s": {"speed"}, "m/s²": {"acceleration"}, "N": {"force"}, "N m": {"torque"},
    "rad": {"angle", "displacement"}, "rad/s": {"angular_speed", "speed"},
    "rad/s²": {"angular_acceleration", "acceleration"},
    "W": {"power"}, "J": {"energy"}, "kg m²": {"inertia"}, "kg": {"inertia"},
}  # fmt: skip
EVERY_QUANTITY: Final[Meanings] = frozenset().union(*QUANTITIES.values())
AROUND: Final = {"angular", "angle", "z"}
DRIVE: Final = ("phi", "omega", "epsilon", "Mkr", "Peq")
COMPONENTS: Final = frozenset({"x", "y", "z", "magnitude"})  # each of which has to be true: "vx" is a speed and x


class NotJudgedError(LinkproofError):
    """A column that means no signal, or may mean several; the message is the reason."""


@dataclass(frozen=True)
class Meaning:
    """The signal that a column means, its unit (None: the header states none), and the assumption made, "" for none."""

    signal: str
    unit: Unit | None
    printed: str
    assumption: str = ""


@dataclass(frozen=True)
class _Vocabulary:
    """The vocabulary of a signal: words for its ``quantity``, each set that it ``needs`` one of, and all ``words``."""

    quantity: Meanings
    needs: tuple[Meanings, ...]
    words: Meanings


def splits(header: str, unit: str) -> Iterator[tuple[str, str]]:
    """Name and unit of a header, the likeliest first, "" for none; ``unit`` is that which the file states apart."""
    header = REPEAT_NUMBER.sub("", header)
    if parse_unit(unit):
        yield header, unit
        return
    for form in WITH_UNIT:
        match = re.fullmatch(form, header)
        if match and parse_unit(match[2].strip("()[]")):
            yield match[1], match[2].strip("()[]")
    yield header, ""


@dataclass(frozen=True)
class HeaderParser:
    """Parser of headers: the signals of one linkage by words of several languages and by names of its parts."""

    linkage: Linkage

    @cached_property
    def signals(self) -> tuple[str, ...]:
        """Names of all signals, with the magnitudes of forces."""
        return signals.names_with_magnitudes(Mechanism(self.linkage))

    @cached_property
    def _names(self) -> Table:
        points = {point for link in self.linkage.links.values() for point in link.points} | {*self.linkage.ground}
        return name_meanings({*self.linkage.links, *points, *self.linkage.joint_names} - {GROUND})

    @cached_property
    def _vocabularies(self) -> dict[str, _Vocabulary]:
        """The words that may mean each signal."""
        return {
            name: self._vocabulary_of(name)
            for name in (TIME, *self.signals)
            if not name.startswith("transmission_angle")
        }

    def _vocabulary_of(self, name: str) -> _Vocabulary:
        """The vocabulary of a signal or of time."""
        linkage, output = self.linkage, self.linkage.output
        kind, _, rest = name.partition(":")
        part, _, component = rest.rpartition(":")
        point, _, link = part.partition(":")
        quantity, axes = QUANTITIES[self.si_unit_name(name)], {component[-1:]} & {"x", "y"}
        drive = {"drive", f":{linkage.crank}"}
        others = {*AROUND} if "rad" in self.si_unit_name(name) or "N m" in self.si_unit_name(name) else {"linear"}
        owner = {f":{part}"}
        if kind in DRIVE:
            owner = drive if linkage.is_linear and kind != "Peq" else quantity | drive
            others |= {"length"} if kind == "phi" else set()
        elif kind in signals.OUTPUT and output is not None:
            owner = quantity | {"output"}
            slides = any(slider.point == output.point for slider in linkage.sliders)
            others |= {f":{output.link}", *([f":{output.point}"] if slides else [])}
        elif kind in ("point", "joint_force"):
            others |= {f":{n}" for n, body in linkage.links.items() if point in body.points and link in ("", n)}
            others |= {"path"} if kind == "point" else {"reaction"}
            owner |= {f":{point}"} if kind == "joint_force" else set()
        elif kind != "link":
            owner = {TIME: {TIME}, "Teq": {"kinetic"}, "Jeq": {"reduced"}}.get(kind, {"shaking"})
            others |= {"torque"} if kind == "Jeq" else {"reaction"}  # "moment of inertia"
        others |= {"magnitude"} if name.endswith(signals.MAGNITUDE) else set()
        needs = (frozenset(owner), *([frozenset(axes)] if axes else []))
        return _Vocabulary(frozenset(quantity), needs, frozenset().union(quantity, others, *needs))

    def unit(self, name: str) -> Unit:
        """SI unit of a signal or of time."""
        unit = parse_unit(self.si_unit_name(name))
        assert unit is not None, name
        return unit

    def si_unit_name(self, name: str) -> str:
        """The name of the SI unit of a signal or of time."""
        return "s" if name == TIME else signals.unit(name, self.linkage)

    def in_stated_unit(self, signal: str, column: Column) -> Meaning:
        """A signal in the unit that a header states where it measures the signal."""
        for _, text in splits(column.header, column.unit):
            unit = parse_unit(text)
            if unit is not None and unit.measures(self.unit(signal).dimension):
                return Meaning(signal, unit, text)
        return Meaning(signal, None, "")

    def meaning(self, column: Column) -> Meaning:
        """The signal that a column means; raises NotJudgedError with the reason."""
        if len(column.header) > LONGEST:
            raise NotJudgedError(f"its name '{shortened(column.header)}' is longer than {LONGEST} characters")
        reasons = []
        for name, text in splits(column.header, column.unit):
            try:
                return self._meaning(name.strip(), parse_unit(text), text, column)
            except NotJudgedError as reason:
                reasons.append(reason)
        raise reasons[0]

    def _meaning(self, name: str, unit: Unit | None, printed: str, column: Column) -> Meaning:
        """The signal that a name with a unit means."""
        if name in (TIME, *self.signals):
            if unit and not unit.measures(self.unit(name).dimension):
                raise NotJudgedError(f"'{printed}' is no unit of {name}")
            return Meaning(name, unit, printed)
        read = []
        for word, meanings in header_words(name, self._names):
            if not meanings:
                raise NotJudgedError(
                    f"'{shortened(word)}' in its name is no unit, link, point or joint, nor a known word"
                )
            read.append(meanings)
        fitting = self._fitting(read, unit)
        if not fitting:
            others = self._fitting(read, None) if unit else {}
            raise NotJudgedError(
                f"'{printed}' is no unit of {listed(others)}" if others else self._why_no_signal(read, unit)
            )
        names_stated = {name: sum(word.startswith(":") for word in stated) for name, stated in fitting.items()}
        best = [name for name in fitting if names_stated[name] == max(names_stated.values())]
        best = [name for name in best if ":" not in name] or best
        if len(best) > 1:
            raise NotJudgedError(f"it may be {listed(best)}: add its unit, or the name and component that it lacks")
        return Meaning(best[0], unit, printed, self._assumption(best[0], fitting[best[0]], column))

    def _fitting(self, read: Sequence[Meanings], unit: Unit | None) -> dict[str, Meanings]:
        """Signals of which all words read are true and whose required words are there, each with what fits."""
        fitting = {}
        for name, true in self._vocabularies.items():
            if unit is not None and not unit.measures(self.unit(name).dimension):
                continue
            every = frozenset[str]().union(*(meanings & true.words for meanings in read))
            is_true = all(meanings & true.words and meanings & COMPONENTS <= true.words for meanings in read)
            is_place = name.startswith("point:") and name[-2] == ":"  # "D.x", without a word for it
            measured = every & EVERY_QUANTITY
            has_quantity = measured & true.quantity if measured else unit is not None or is_place
            if is_true and has_quantity and all(every & need for need in true.needs):
                fitting[name] = every
        return fitting

    def _why_no_signal(self, read: Sequence[Meanings], unit: Unit | None) -> str:
        """Why a header whose words are all known means no signal; names the signals of that kind."""
        stated = frozenset[str]().union(*read)
        kind = [name for name, true in self._vocabularies.items() if stated & true.quantity]
        kind = kind or [name for name in self._vocabularies if unit and unit.measures(self.unit(name).dimension)]
        if "elsewhere" in stated or not kind:
            return "the closed form has no such quantity"
        return f"its name fits none of {listed(dict.fromkeys(name.rpartition(':')[0] or name for name in kind))}"

    def _assumption(self, signal: str, stated: Meanings, column: Column) -> str:
        """The assumption behind a column's signal, "" for none; raises NotJudgedError if its values contradict."""
        output = self.linkage.output
        if signal in DRIVE and not stated & {"drive", f":{self.linkage.crank}"}:
            return "its name has no link: taken as the crank's"
        if signal in signals.OUTPUT and output is not None:
            return f"taken as the output's, {output.point} along [{output.along[0]:.4g}, {output.along[1]:.4g}]"
        if signal.endswith(signals.MAGNITUDE):
            if np.any(column.values < 0.0):
                raise NotJudgedError("its name has no component, and it changes its sign, as no size of a force does")
            return "" if "magnitude" in stated else "its name has no component: taken as the size of the force"
        return ""
