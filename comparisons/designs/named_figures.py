"""Figures of a design by the names that are typed: ``Mkr.peak``, ``joint_force:A.peak``, ``point:D:y@30``, ``stroke``.

``SIGNAL.REDUCTION``     a signal of ``linkproof results`` over the motion: .peak .mean .rms .max .min .range
``SIGNAL@30``            its value at a crank angle, degrees, or ``@0.5rad``; of a drive along a line in the file's unit
``joint_force:A.peak``   of a vector without a component, its magnitude
``joint_force.peak``     of every joint; likewise transmission_angle, of every group
``transmission_angle.peak``  the least, which is the worst
``stroke``               the range of S
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from difflib import get_close_matches
from typing import Final

from analytic import signals
from analytic.designs.figures import Figure, Reduction
from analytic.errors import SIMILAR, SYMBOLS, LinkproofError, shortened
from analytic.kinematics.mechanism import Mechanism
from analytic.signals import MAGNITUDE
from comparisons.datasheet.curves import FORCES
from comparisons.datasheet.units import FileUnit, file_unit

STROKE: Final = "stroke"
ANGLES: Final = "transmission_angle"
FAMILIES: Final = ("joint_force", ANGLES)
REDUCTIONS: Final = tuple(one.value for one in Reduction if one is not Reduction.AT)
NEEDS: Final[Mapping[str, str]] = {  # what a linkage must have for these signals, in words
    **dict.fromkeys(("S", "v", "a"), "an output point"),
    **dict.fromkeys(("Mkr", "Peq", "Teq", "Jeq", "joint_force"), "masses of all links"),
}
NEAREST: Final = 3  # names in a message
NOT_OF_A_DESIGN: Final = ("phi", "omega", "epsilon")  # they are given


@dataclass(frozen=True)
class NamedFigure:
    """A figure of a design by its name, with the unit of the file."""

    name: str
    figure: Figure
    unit: FileUnit

    @property
    def shown(self) -> str:
        """The name with the unit, as tables are headed."""
        return f"{self.name} [{self.unit.name}]" if self.unit.name else self.name


def named_figures(mechanism: Mechanism, names: Iterable[str]) -> tuple[NamedFigure, ...]:
    """The figures of these names, each once, in their order; a family stands for all its members.

    Raises LinkproofError for a signal or a reduction that there is not, and for a wrong angle.
    """
    known = _signals(mechanism)
    found = {one.name: one for name in names for one in _figures(mechanism, known, name)}
    return tuple(found.values())


def figure_names(mechanism: Mechanism) -> list[str]:
    """Every figure by name, the peaks first; those at an angle have names without end."""
    return _examples(_signals(mechanism))


def _signals(mechanism: Mechanism) -> dict[str, str]:
    """Signals by the names they are asked for: a vector's own name stands for its magnitude."""
    found = {}
    for name in signals.names(mechanism):
        if name in NOT_OF_A_DESIGN:
            continue
        found[name] = name
        if name.startswith(FORCES) and name.endswith(":y"):
            vector = name.removesuffix(":y")
            found[vector] = vector + MAGNITUDE
    return found


def _figures(mechanism: Mechanism, known: Mapping[str, str], name: str) -> list[NamedFigure]:
    signal, mark, angle = name.rpartition("@")
    if mark:
        return [_named(mechanism, f"{one}@{angle}", _angle(mechanism, name, angle), known[one])
                for one in _members(mechanism, known, signal, name)]  # fmt: skip
    signal, _, word = ("S", ".", "range") if name == STROKE else name.rpartition(".")
    if word not in REDUCTIONS:
        raise _unknown(name, known)
    how = Reduction.MIN if word == Reduction.PEAK and signal.startswith(ANGLES) else Reduction(word)
    return [
        _named(mechanism, STROKE if name == STROKE else f"{one}.{word}", how, known[one])
        for one in _members(mechanism, known, signal, name)
    ]


def _examples(known: Mapping[str, str]) -> list[str]:
    """Every figure, the peaks first."""
    return [STROKE, *(f"{one}.{word}" for word in REDUCTIONS for one in (*known, *FAMILIES))]


def _members(mechanism: Mechanism, known: Mapping[str, str], signal: str, name: str) -> list[str]:
    """The signal, or every member of the family: the magnitudes of all forces, the angles of all groups."""
    ending = MAGNITUDE if signal == "joint_force" else ""
    members = [one for one, told in known.items() if told == f"{one}{ending}" and one.startswith(f"{signal}:")]
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
    """What to say of a figure that there is not: the nearest few."""
    examples, (word, _, how) = _examples(known), name.partition("@")[0].partition(".")
    symbol = f"{SYMBOLS.get(word.lower(), word)}.{how if how in REDUCTIONS else 'peak'}"
    by_case = {one.lower(): one for one in examples}
    near = get_close_matches(name.lower(), by_case, n=NEAREST, cutoff=SIMILAR)
    meant = dict.fromkeys([*([symbol] if symbol in examples else []), *(by_case[one] for one in near)])
    hint = f"did you mean {' or '.join(repr(one) for one in [*meant][:NEAREST])}? " if meant else ""
    return LinkproofError(
        f"unknown figure '{shortened(name)}': {hint}a figure is {STROKE}, or a signal of `linkproof results` with "
        f"{', '.join(f'.{one}' for one in REDUCTIONS)} or @ANGLE behind its name; `linkproof list --figures` shows all"
    )


def _angle(mechanism: Mechanism, name: str, text: str) -> float:
    """The place of the driver behind the @, rad or m."""
    is_linear = mechanism.linkage.is_linear
    unit = file_unit("m", mechanism.linkage) if is_linear else FileUnit("degrees", math.radians(1.0))
    in_radians = text.endswith("rad") and not is_linear
    try:
        place = float(text.removesuffix("rad") if in_radians else text)
    except ValueError:
        place = math.nan
    if not math.isfinite(place):
        raise LinkproofError(f"{name}: expected a crank angle in {unit.name} after '@', got '{text}'; correct it")
    return place if in_radians else place * unit.size


def _named(mechanism: Mechanism, name: str, how: Reduction | float, signal: str) -> NamedFigure:
    si = signals.unit(signal, mechanism.linkage)
    figure = Figure(signal, how) if isinstance(how, Reduction) else Figure(signal, Reduction.AT, how)
    return NamedFigure(name, figure, file_unit(si, mechanism.linkage))
