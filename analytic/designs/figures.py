"""Figures: a signal over the motion of the crank reduced to one number, such as a peak or a mean."""

from __future__ import annotations

import math
import re
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from difflib import get_close_matches
from enum import StrEnum
from math import nan, pi
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from analytic.description.linkage import Linkage
from analytic.errors import SIMILAR, SYMBOLS, LinkproofError, shortened, symbol
from analytic.kinematics.mechanism import Mechanism
from analytic.numerics.arrays import Array
from analytic.signals import MAGNITUDE, THREAD_FEED, names_with_magnitudes, table


class Reduction(StrEnum):
    """How a signal over the sampled angles becomes one number.

    ``PEAK`` is the largest magnitude; ``RANGE`` the largest less the smallest; ``AT`` the value at one crank angle.
    Means are integrals over the angle, whatever the samples.
    """

    PEAK = "peak"
    MEAN = "mean"
    RMS = "rms"
    MAX = "max"
    MIN = "min"
    RANGE = "range"
    AT = "at"


# The extremes that figures are made of, by ``SignalExtreme.way``.
EXTREMES: Final[Mapping[Reduction, tuple[int, ...]]] = {
    Reduction.PEAK: (0,),
    Reduction.MAX: (1,),
    Reduction.MIN: (-1,),
    Reduction.RANGE: (1, -1),
}


SQUARE: Final = 0.5 * pi
NEAR: Final = 1e-7  # rad: how near a kink is closed in on at least


class SignalExtreme(NamedTuple):
    """The highest (1), the lowest (-1) value of a signal, or the largest magnitude (0)."""

    signal: str
    way: int

    def side(self, values: Array) -> Array:
        """The sign, 1.0 or -1.0, of each value: that of the extreme, or of a largest magnitude that of the value."""
        if self.way:
            return np.full(values.shape, float(self.way))
        return np.where(values < 0.0, -1.0, 1.0)

    def height(self, values: Array, side: Array | None = None) -> Array:
        """The number that is largest at the extreme: the signal times ``side``, by default that of each value."""
        return (self.side(values) if side is None else side) * values

    def is_kink(self, value: ArrayLike) -> Array:
        """For each value, rad, whether it is the top of a transmission angle at 90°.

        No number of the design changes such a top.
        """
        can_be = self.way >= 0 and self.signal.startswith("transmission_angle:")
        return np.asarray(can_be & (np.asarray(value) > SQUARE - NEAR))

    def value(self, height: Array, side: Array) -> Array:
        """The signal's value from a height and its ``side``, 1 or -1: their product."""
        return side * height


@dataclass(frozen=True)
class Figure:
    """A figure of a design, SI: a signal of ``analytic.signals``, or the magnitude of a vector, and its reduction.

    A magnitude is ``joint_force:A:magnitude`` or ``shaking_force:magnitude``. ``angle``, rad, belongs to ``AT``; in its
    place may stand a ``time``, s, where the motion is one in time.
    """

    signal: str
    reduction: Reduction
    angle: float = nan
    time: float = nan

    @property
    def is_magnitude(self) -> bool:
        """Whether it is a peak: a largest magnitude, which has no sign."""
        return self.reduction is Reduction.PEAK

    @property
    def is_mean(self) -> bool:
        """Whether it is an integral over the motion, a mean or an RMS."""
        return self.reduction in (Reduction.MEAN, Reduction.RMS)

    @property
    def extremes(self) -> tuple[SignalExtreme, ...]:
        """The extremes from which it is computed; none for a mean or a single value."""
        return tuple(SignalExtreme(self.signal, way) for way in EXTREMES.get(self.reduction, ()))

    def integrand(self, values: Array) -> Array:
        """The integrand of a mean: the signal, or its square for an RMS."""
        return np.square(values) if self.reduction is Reduction.RMS else values

    def of_mean(self, mean: Array) -> Array:
        """The figure, given the mean of its integrand: the mean itself, or its root for an RMS."""
        return np.sqrt(mean) if self.reduction is Reduction.RMS else mean

    def of(self, ends: Sequence[Array]) -> Array:
        """The figure of each design, (designs,), from its extremes' values ``ends``: one, or the first less the second.

        Of a peak it is the magnitude.
        """
        value = ends[0] if len(ends) == 1 else ends[0] - ends[1]
        return np.abs(value) if self.is_magnitude else value


# Figures by the names that are typed and printed: ``Mkr.peak``, ``joint_force:A.peak``, ``point:D:y@30``, ``stroke``.
#
# ``SIGNAL.REDUCTION`` a signal of ``linkproof results`` over the motion: .peak .mean .rms .max .min .range
# ``SIGNAL@30`` its value at a crank angle, degrees, or ``@0.5rad``; of a drive along a line in the file's unit
# ``joint_force:A.peak`` of a vector without a component, its magnitude ``joint_force.peak`` of every joint; likewise
# transmission_angle, of every group ``transmission_angle.peak`` the least, which is the worst ``stroke`` the range of
# S
#
# Along a motion in time there are ``omega.max`` and ``Mkr@0.03s``, a value at a time, besides. Signals computed on
# request, as ``Jeq:coupler``, have figures too.

STROKE: Final = "stroke"
TRANSMISSION_ANGLE: Final = "transmission_angle"
FAMILIES: Final = ("joint_force", TRANSMISSION_ANGLE)
REDUCTIONS: Final = tuple(reduction.value for reduction in Reduction if reduction is not Reduction.AT)
NEEDS: Final[Mapping[str, str]] = {  # what a linkage must have for these signals, in words
    **dict.fromkeys(("S", "v", "a"), "an output point"),
    **dict.fromkeys(("Mkr", "Peq", "Teq", "Jeq", "joint_force"), "masses of all links"),
}
MOST_SUGGESTED: Final = 3  # names in a message
INSTANT: Final = re.compile(r"(?P<number>[-+]?(?:\d+\.?\d*|\.\d+)(?:e[-+]?\d+)?)(?P<unit>deg|rad|s|)")
# The motion is given, and the feed counts from a position that differs from design to design.
NOT_OF_A_DESIGN: Final = ("phi", "omega", "epsilon", THREAD_FEED)


def figures_named(mechanism: Mechanism, name: str, *, in_time: bool = False) -> dict[str, Figure]:
    """The figures by name that a typed name stands for: one, or one for each member of a family.

    ``name`` is as "Mkr.peak", "stroke", or "S@30" at a crank angle; the peak of a transmission angle is its least.
    ``in_time`` allows figures of a motion, at a time, as "Mkr@0.03s". Raises LinkproofError for an unknown signal or
    reduction, for a signal that the linkage lacks, and for a wrong angle or time.
    """
    name = symbol(name)
    listed = _signals(mechanism, () if in_time else NOT_OF_A_DESIGN)
    known = listed | {key: key for key, on_request in table(mechanism).items() if not on_request.is_listed}
    signal, ending = ("S", ".range") if name == STROKE else part_figure(name)
    if ending.startswith("@"):
        where = ending[1:]
        members = _signals_of_family(mechanism, known, signal, name)
        angle, time = _instant(mechanism.linkage, name, where, in_time=in_time)
        return {f"{member}@{where}": Figure(known[member], Reduction.AT, angle, time) for member in members}
    word = ending[1:]
    if not word:
        raise _unknown(name, listed)
    how = Reduction.MIN if word == Reduction.PEAK and signal.startswith(TRANSMISSION_ANGLE) else Reduction(word)
    members = _signals_of_family(mechanism, known, signal, name)
    return {STROKE if name == STROKE else f"{member}.{word}": Figure(known[member], how) for member in members}


def part_figure(name: str) -> tuple[str, str]:
    """A figure's name divided into its signal and its end, such as ``.peak`` or ``@30``; "" without an end.

    Names of links and points may have any of these signs.
    """
    signal, _, word = name.rpartition(".")
    if word in REDUCTIONS:
        return signal, f".{word}"
    signal, mark, where = name.rpartition("@")
    return (signal, f"@{where}") if mark else (name, "")


def figure_names(mechanism: Mechanism) -> list[str]:
    """Every figure of a design by name: ``stroke``, the peaks, then the other reductions, those of families included.

    None at an angle, of a signal on request, of the driver's own motion or of the thread's feed.
    """
    return _known_figures(_signals(mechanism))


def _signals(mechanism: Mechanism, without: Collection[str] = NOT_OF_A_DESIGN) -> dict[str, str]:
    """Names of signals, but those ``without``, by the name a user types: a vector's own for its magnitude."""
    names = [name for name in names_with_magnitudes(mechanism) if name not in without]
    return {name.removesuffix(MAGNITUDE): name for name in names}


def _known_figures(known: Mapping[str, str]) -> list[str]:
    """Names of all figures of the ``known`` signals, by the names typed, and of their families; none at an angle.

    ``stroke`` comes first, if there is S, then the peaks, then the other reductions.
    """
    families = [kind for kind in FAMILIES if any(name.startswith(f"{kind}:") for name in known)]
    stroke = [STROKE] if "S" in known else []
    return [*stroke, *(f"{name}.{word}" for word in REDUCTIONS for name in (*known, *families))]


def _signals_of_family(mechanism: Mechanism, known: Mapping[str, str], signal: str, name: str) -> list[str]:
    """The names, as typed, of the signals that a typed ``signal`` means: itself, or all forces or groups of a family.

    ``known`` has the signals' names by the typed ones; ``name`` is the whole figure's, for messages. Raises
    LinkproofError for an unknown signal, and for one that the linkage lacks.
    """
    ending = MAGNITUDE if signal == "joint_force" else ""
    members = [key for key, words in known.items() if words == f"{key}{ending}" and key.startswith(f"{signal}:")]
    if signal in NEEDS and signal not in known and not members:
        raise LinkproofError(
            f"{STROKE if signal == 'S' else signal}: expected a linkage with {NEEDS[signal]}, got "
            f"'{mechanism.linkage.name}' without; add what is missing to its file, or name another figure"
        )
    if signal in FAMILIES:
        return members
    if signal not in known:
        raise _unknown(name, known)
    return [signal]


def _unknown(name: str, known: Mapping[str, str]) -> LinkproofError:
    """The LinkproofError for an unknown figure, with the nearest names among figures of the ``known`` signals."""
    examples, (word, _, how) = _known_figures(known), name.partition("@")[0].partition(".")
    how, word = word.partition("_")[::2] if word.partition("_")[0] in REDUCTIONS else (how, word)  # peak_torque
    usual = f"{SYMBOLS.get(word.lower(), word)}.{how if how in REDUCTIONS else 'peak'}"
    by_case = {example.lower(): example for example in examples}
    near = get_close_matches(name.lower(), by_case, n=MOST_SUGGESTED, cutoff=SIMILAR)
    meant = dict.fromkeys([*([usual] if usual in examples else []), *(by_case[key] for key in near)])
    hint = f"did you mean {' or '.join(repr(key) for key in [*meant][:MOST_SUGGESTED])}? " if meant else ""
    return LinkproofError(
        f"unknown figure '{shortened(name)}': {hint}a figure is {STROKE}, or a signal of `linkproof results` with "
        f"{', '.join(f'.{reduction}' for reduction in REDUCTIONS)} or @ANGLE behind its name; "
        "`linkproof list MECHANISM` shows all"
    )


def _instant(linkage: Linkage, name: str, text: str, *, in_time: bool) -> tuple[float, float]:
    """The place, rad or m, and the time, s, that the text behind "@" gives; the one not given is nan.

    A place without unit is in degrees or the file's unit of length; ``name`` is the figure's, for the message. Raises
    LinkproofError for a wrong text, or for a time unless ``in_time``.
    """
    read = INSTANT.fullmatch(text)
    measure = read["unit"] if read else None
    if read is None or (linkage.is_linear and measure in ("deg", "rad")) or (measure == "s" and not in_time):
        unit = linkage.units["length"] if linkage.is_linear else "degrees"
        time = ", or a time such as 0.03s" if in_time else ""
        raise LinkproofError(f"{name}: expected a crank angle in {unit}{time} after '@', got '{text}'; correct it")
    number = float(read["number"])
    if measure == "s":
        return math.nan, number
    if measure == "rad":
        return number, math.nan
    return number * linkage.phi.unit.size, math.nan
