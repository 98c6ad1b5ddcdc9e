"""Numbers of a linkage's file that designs differ in, by name, in the units of the file; and the file of a design."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Final, NamedTuple

import numpy as np

from analytic.description.changes import SPEED, design_numbers, named_numbers, with_numbers
from analytic.description.changes import numbers as numbers_of
from analytic.description.law import FULL_TURN
from analytic.description.linkage import Linkage
from analytic.description.loading import DESIGN, parse, rewritten
from analytic.description.units import FileUnit, Kind, conversion
from analytic.description.written import file_unit, kind_unit
from analytic.designs.derivatives import figure_gradients
from analytic.designs.figures import Figure, figures_named
from analytic.designs.results import design_figures
from analytic.errors import LinkproofError, StructureError, UnknownNameError, listed
from analytic.kinematics.dead_centres import top_dead_centre
from analytic.kinematics.decomposition import find_structure
from analytic.kinematics.mechanism import Mechanism
from analytic.kinematics.sweep import Sweep
from analytic.numerics.arrays import Array
from analytic.signals import MovingSweep, signal, unit
from comparisons.designer.linkage_check import load_name
from comparisons.designer.open_ends import inset_ends, open_end_warning, open_ends

LISTING: Final = "those that `linkproof list MECHANISM` shows"
TYPED_NUMBER: Final = re.compile(r"\s*(?P<number>[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)\s*(?P<unit>\D.*?)?\s*")


@dataclass(frozen=True)
class Named:
    """A number of a linkage or of its designs by its name, with the unit that the linkage's file has for it."""

    name: str
    unit: FileUnit
    si_unit: str

    @property
    def shown(self) -> str:
        """The name with its unit, as it heads a table: "rod.B.x [mm]"; alone without a unit."""
        return f"{self.name} [{self.unit.name}]" if self.unit.name else self.name

    def si(self, text: str) -> float:
        """The SI value of a number as it is typed: in the unit of the file, or with one of its own, 17cm.

        Raises LinkproofError for no finite number, and for a unit that does not measure this.
        """
        number, size = self._read(text)
        return number * size

    def in_file(self, text: str) -> float:
        """The number that a text gives, in the unit of the file; takes and raises the same as ``si``."""
        number, size = self._read(text)
        return number if size == self.unit.size else float(f"{number * size / self.unit.size:.15g}")

    def _read(self, text: str) -> tuple[float, float]:
        """A typed number and the size of its unit in SI.

        Raises LinkproofError for no finite number, and for a unit that does not measure this.
        """
        read = TYPED_NUMBER.fullmatch(text)
        number = float(read["number"]) if read else math.nan
        if read is None or not math.isfinite(number):
            raise LinkproofError(
                f"{self.name}: expected a finite number{f' of {self.unit.name}' if self.unit.name else ''}, got "
                f"'{text}'; correct it"
            )
        return number, self.unit.size if read["unit"] is None else self._unit_size(read["unit"])

    def _unit_size(self, unit: str) -> float:
        """Size in SI of a unit that is typed; raises LinkproofError for one that does not measure this."""
        if unit == self.unit.name:
            return self.unit.size
        try:
            return conversion(unit, self.si_unit)
        except UnknownNameError as error:
            raise LinkproofError(f"{self.name}: {error}") from error


@dataclass(frozen=True)
class Parameter(Named):
    """A number of the file (``analytic.description.changes``), its kind and its SI value."""

    kind: Kind
    value: float


def parameters(linkage: Linkage) -> dict[str, Parameter]:
    """Every number that designs of a linkage may differ in, by name; the driver's speed is not among them."""
    numbers = design_numbers(linkage).items()
    return {
        name: Parameter(name, kind_unit(kind, linkage.units), kind.si, kind, value) for name, (kind, value) in numbers
    }


def parameter(linkage: Linkage, name: str, speed: float = math.nan) -> Parameter:
    """A number of a linkage by name, or "speed", which is the driver's ``speed``, rad/s or m/s, without its sign.

    Raises UnknownNameError for another name.
    """
    if name == SPEED:
        return Parameter(SPEED, linkage.phi.speed_unit, Kind.SPEED.si, Kind.SPEED, abs(speed))
    known = parameters(linkage)
    if name not in known:
        raise UnknownNameError(f"parameter of '{linkage.name}'", name, [*known, SPEED], LISTING)
    return known[name]


def mass_words(linkage: Linkage, names: Iterable[str]) -> str:
    """A clause, from its comma, on the masses of designs that vary these numbers, by name.

    It is ", masses scaled with lengths" or ", masses as in the file"; "" where no length of a moving link varies.
    """
    places = {name: number.path for name, number in named_numbers(linkage).items()}
    if not any(places.get(name, ())[0:3:2] == ("links", "points") for name in names):
        return ""
    return ", masses scaled with lengths" if linkage.scales_mass else ", masses as in the file"


# The linkage file of a design: other numbers, the same assembly modes as the original.


def design_file(mechanism: Mechanism, numbers: Mapping[str, float]) -> str:
    """The text of the linkage file with these numbers, SI, by name; its sketch moves if needed to keep the modes.

    A speed among them is left out, for files have none. Nothing is written. Raises UnknownNameError for an unknown
    name, LinkproofError for numbers that describe no linkage, AssemblyError where the design has no such sketch.
    """
    original, structure = mechanism.linkage, mechanism.structure
    numbers = {name: value for name, value in numbers.items() if name != SPEED}
    if original.scales_mass:
        before, after = numbers_of(original), numbers_of(with_numbers(original, numbers))
        numbers = {name: value for name, value in after.items() if value != before[name]}
    signs = tuple(dyad.sign for dyad in structure.dyads)
    text = rewritten(original.text, original.name, original.variant, numbers, new_variant=DESIGN)
    try:
        new = Mechanism(parse(text, original.name, original.name))
        if structure.is_numerical or tuple(dyad.sign for dyad in new.structure.dyads) == signs:
            return text
    except StructureError:  # the sketch leaves a mode open
        pass
    design = with_numbers(original, numbers)
    sweep = Sweep(design, find_structure(design).with_signs(signs), np.asarray(design.sketch_angle))
    sketch = {
        f"sketch.{point}.{axis}": float(value)
        for point in design.sketch
        for axis, value in zip("xy", sweep.point(point), strict=True)
    }
    return rewritten(original.text, original.name, original.variant, {**numbers, **sketch}, new_variant=DESIGN)


# Figures of a design by name, in the units of its linkage's file.


@dataclass(frozen=True)
class NamedFigure(Named):
    """A figure of a design."""

    figure: Figure


def named_figures(mechanism: Mechanism, names: Iterable[str]) -> tuple[NamedFigure, ...]:
    """The figures of these names, each once, in their order; a family stands for all its members.

    Raises LinkproofError for an unknown signal or reduction, a signal that the linkage lacks, and a wrong angle.
    """
    figures = {name: figure for typed in names for name, figure in figures_named(mechanism, typed).items()}
    linkage = mechanism.linkage
    units = {name: unit(figure.signal, linkage) for name, figure in figures.items()}
    return tuple(NamedFigure(name, file_unit(si, linkage), si, figures[name]) for name, si in units.items())


def known_figures(mechanism: Mechanism, names: Iterable[str]) -> tuple[NamedFigure, ...]:
    """The figures of these names, in their order, without those that the linkage lacks or does not know."""
    figures: list[NamedFigure] = []
    for name in names:
        try:
            figures += named_figures(mechanism, [name])
        except LinkproofError:
            continue
    return tuple(figures)


# The case in which designs are compared: a linkage whose driver moves at constant speed over a turn, or over a range.


SAMPLES: Final = 180  # crank angles of a turn, or places of a range
DEAD_CENTRE_MOVES: Final = math.radians(0.5)  # by less, a load over the crank angle is where it was


class OpenEndFigures(NamedTuple):
    """The names of figures whose extremes lie at an open end of a motion, and a sentence on them; () and "" if none."""

    names: tuple[str, ...]
    sentence: str


@dataclass(frozen=True)
class SteadyCase:
    """A linkage whose driver moves at a constant speed, rad/s or m/s, signed, through ``places``, rad or m, ascending.

    The end of a full turn is not sampled twice. ``conditions`` has linkage and motion in words. Among the numbers of a
    design may be "speed", without sign: it replaces the case's, in the same direction.
    """

    mechanism: Mechanism
    places: Array
    speed: float
    is_full_turn: bool
    conditions: str = ""

    @property
    def linkage(self) -> Linkage:
        """The linkage as its file describes it."""
        return self.mechanism.linkage

    def parameter(self, name: str) -> Parameter:
        """A number of the linkage by name, or the driver's speed; raises UnknownNameError."""
        return parameter(self.linkage, name, self.speed)

    def figures(
        self,
        numbers: Mapping[str, Array],
        figures: Sequence[NamedFigure],
        *,
        refine: bool = True,
        path: str = "auto",
    ) -> Array:
        """Figures of designs, SI: (figures, designs), nan where a design cannot be assembled at every place.

        ``numbers`` (designs,) are SI values by the names of parameters; without any it is the file's design. With
        ``refine`` extremes are those between the places too. ``path`` is "numpy", "compiled" or "auto". Raises
        LinkproofError for an unknown name and for numbers that no design can have.
        """
        return design_figures(
            self.mechanism, numbers, [each.figure for each in figures], self.places, speed=self.speed,
            period=self._period, refine=refine, path=path,
        )  # fmt: skip

    def figures_of(self, design: Mapping[str, float], figures: Sequence[NamedFigure]) -> Array:
        """Figures (figures,), SI, of one design, extremes refined; nan if it cannot be assembled at every place.

        ``design`` has its numbers, SI, by name. Raises LinkproofError as ``figures``.
        """
        return self.figures({name: np.array([value]) for name, value in design.items()}, figures)[:, 0]

    def gradients(self, design: Mapping[str, float], figures: Sequence[NamedFigure]) -> tuple[Array, Array]:
        """Figures (figures,) of one design, refined, and their derivatives by its numbers (figures, numbers), SI.

        The numbers are SI values by name. A derivative is nan where equal tops have different ones. Raises
        LinkproofError as ``figures``, and AssemblyError where the design cannot be assembled.
        """
        every = [each.figure for each in figures]
        return figure_gradients(self.mechanism, design, every, self.places, speed=self.speed, period=self._period)

    @property
    def _period(self) -> float | None:
        """The period of loads, rad, at whose end the curves close; None of a range."""
        return self.linkage.load_period if self.is_full_turn else None

    def redesigned(self, design: Mapping[str, float]) -> SteadyCase:
        """A copy of the case with other numbers, SI, by name, in the same assembly modes.

        A speed and unknown names are ignored. Raises StructureError or AssemblyError for a group of a higher class that
        the sketch then leaves open or that does not meet, ZeroDivisionError for a direction of zeros.
        """
        numbers = {name: value for name, value in design.items() if name != SPEED}
        return replace(self, mechanism=self.mechanism.redesigned(with_numbers(self.linkage, numbers)))

    def open_ends(self, figures: Sequence[NamedFigure]) -> OpenEndFigures:
        """The figures whose extremes lie at an end of the motion beside a dead position, in the case's own design.

        There they say no more than where the motion is cut off. A full turn has no such ends: no names and "". Raises
        AssemblyError where the design cannot be assembled.
        """
        ends = () if self.is_full_turn else open_ends(self.mechanism, self.places[0], self.places[-1])
        tops = {each.name: self._tops(each) for each in figures} if ends else {}
        names = tuple(name for name, places in tops.items() if any(end.has(top) for end in ends for top in places))
        if not names:
            return OpenEndFigures((), "")
        verb = "has its extreme" if len(names) == 1 else "have their extremes"
        met = [end for end in ends if any(end.has(top) for places in tops.values() for top in places)]
        words = open_end_warning(self.mechanism, met)
        return OpenEndFigures(names, f"{listed(names)} {verb} at an open end of the motion: {words}")

    def _tops(self, named: NamedFigure) -> list[float]:
        """The sampled places, rad or m, of the extremes that make a figure."""
        heights = (extreme.height(signal(self._moving, named.figure.signal)) for extreme in named.figure.extremes)
        return [float(self.places[np.argmax(height)]) for height in heights]

    @cached_property
    def _moving(self) -> MovingSweep:
        """The motion and loads of the file's linkage at the sampled places; S counts from the farthest of them."""
        sweep = self.mechanism.sweep(self.places)
        farthest = float(np.max(sweep.output())) if self.linkage.output else 0.0
        return MovingSweep(self.mechanism, sweep, np.asarray(self.speed), np.zeros(()), farthest)

    def loads_that_stay(self, designs: Iterable[Mapping[str, float]]) -> str:
        """A sentence on loads over the crank angle whose place in the stroke changes in a design; "" without any.

        ``designs`` are numbers, SI, by name; those without dead centres are left out. It is about the first of them
        whose top dead centre moves by more than DEAD_CENTRE_MOVES from the file's.
        """
        linkage = self.linkage
        tables = [law.angles is not None and law.over == "phi" for law in linkage.laws]
        loads = [load_name(load) for load, is_over_angle in zip(linkage.applied, tables, strict=True) if is_over_angle]
        if not loads or linkage.is_linear or linkage.output is None:
            return ""
        try:
            own = top_dead_centre(self.mechanism).angle
        except LinkproofError:
            return ""
        for design in designs:
            try:
                moved = top_dead_centre(self.redesigned(design).mechanism).angle
            except LinkproofError:
                continue
            if abs((moved - own + math.pi) % FULL_TURN - math.pi) > DEAD_CENTRE_MOVES:
                stay = "stays at its crank angles" if len(loads) == 1 else "stay at their crank angles"
                return (
                    f"the {' and the '.join(loads)} {stay} while the top dead centre moves from "
                    f"{linkage.phi.text(own)} to {linkage.phi.text(moved)}: where the load belongs to the stroke, give "
                    "it over = 'S' in the file"
                )
        return ""


def case_at_speed(
    mechanism: Mechanism, speed: float, *, samples: int = SAMPLES, start: float | None = None, end: float | None = None
) -> SteadyCase:
    """A turn at a ``speed``, rad/s, signed, or the range of a driver that makes none, or from ``start`` to ``end``.

    ``start`` and ``end``, rad or m, count if both are given. There are ``samples`` places, to each turn if loads repeat
    after several. The range is that of the linkage as its file has it, short of its limits. The speed of a linear
    driver is in m/s. Raises LinkproofError for a speed that is zero or not finite, AssemblyError where the linkage
    cannot be assembled as sketched.
    """
    if not math.isfinite(speed) or speed == 0.0:
        raise LinkproofError(f"--speed: expected a finite speed that is not zero, got {speed:g}; give another")
    if start is None or end is None:
        reach = mechanism.crank_range()
        if reach.is_full_turn:
            way = mechanism.linkage.load_period
            places = np.linspace(0.0, way, samples * round(way / FULL_TURN), endpoint=False)
            return SteadyCase(mechanism, places, speed, is_full_turn=True)
        start, end = inset_ends(reach)
    return SteadyCase(mechanism, np.linspace(min(start, end), max(start, end), samples), speed, is_full_turn=False)
