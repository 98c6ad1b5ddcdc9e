"""The figures printed in the sources beside ours, in every variant of a mechanism."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from functools import lru_cache
from typing import Any, Final, NamedTuple

from analytic.description.crank_motion import REGIMES, RPM, crank_motion
from analytic.description.law import FULL_TURN
from analytic.description.linkage import Linkage
from analytic.description.loading import load
from analytic.description.schema import Published
from analytic.description.units import conversion
from analytic.designs.figures import Figure
from analytic.errors import LinkproofError, UnknownNameError
from analytic.kinematics.mechanism import Mechanism
from analytic.signals import table
from comparisons.datasheet.curves import Curves
from comparisons.datasheet.figures import MECHANISM_FIGURES, case_figures, figure_unit, figures_by_name
from comparisons.reference.case import Case, case_of_file_regime

# The sources call their own methods in agreement "within 2-6 %": that is the width of a figure that is met.
CLAIMED_ACCURACY: Final = 0.06
MARGIN: Final = math.radians(10.0)  # that a crank turns before a printed angle
TOGGLE_SHARE: Final = 0.5  # of the way from a toggle, where that is less
OLD_QUANTITY: Final = re.compile(r"start_acceleration:.*|.* - .*|.*@\S+s:.*")  # quantities of an older file format
OLD_RUN_UP_QUANTITIES: Final = ("Mkr.peak", "Peq.peak")  # which needed no regime then


@dataclass(frozen=True)
class PublishedRecord:
    """A printed figure beside ours, both in the printed unit.

    ``deviation`` is ours over published less one, None where 0 is published.
    """

    mechanism: str
    variant: str
    quantity: str
    unit: str
    published: float
    half_digit: float
    ours: float | None
    deviation: float | None
    verdict: str
    source: str
    note: str


def compare_published(linkages: Iterable[Linkage]) -> tuple[PublishedRecord, ...]:
    """Every printed figure of these linkages against ours, in each linkage's own variant."""
    return tuple(record for linkage in linkages for record in _records(linkage))


def all_variants(name: str) -> tuple[Linkage, ...]:
    """A mechanism in each of its variants, the file's own first."""
    first = load(name)
    return (first, *(load(name, variant) for variant in first.variants[1:]))


def published_figures(linkage: Linkage) -> list[Published]:
    """The printed figures of the linkage's variant."""
    return [entry for entry in linkage.published if entry.variant in (None, linkage.variant)]


def _records(linkage: Linkage) -> Iterator[PublishedRecord]:
    """The printed figures of one linkage beside ours; one mechanism serves them all."""
    entries = published_figures(linkage)
    mechanism = Mechanism(linkage) if entries else None
    for entry in entries:
        assert mechanism is not None
        yield PublishedRecord(**record_fields(linkage, entry, _evaluate(mechanism, entry)))


def record_fields(linkage: Linkage, entry: Published, value: float | None) -> dict[str, Any]:
    """The fields of the ``PublishedRecord`` of a printed figure beside a ``value`` of ours or an engine's, SI."""
    unit, ours = figure_unit(entry.quantity, linkage), value
    quantity = f"{entry.quantity} - {entry.less}" if entry.less else entry.quantity
    if entry.relative_to:
        unit, quantity = "", f"{quantity} / {entry.relative_to}"
    elif entry.unit is not None:
        ours = None if value is None else value / conversion(entry.unit, unit)
        unit = entry.unit
    return {
        "mechanism": linkage.name,
        "variant": linkage.variant,
        "quantity": quantity,
        "unit": unit,
        "published": entry.value,
        "half_digit": entry.half_digit,
        "ours": ours,
        "deviation": ours / entry.value - 1.0 if ours is not None and entry.value else None,
        "verdict": "" if ours is None else verdict(entry, ours),
        "source": entry.place,
        "note": entry.note,
    }


def verdict(entry: Published, ours: float) -> str:
    """How our value meets a printed one: reproduced to its digits, within the 6 % the sources claim, or not reproduced.

    Where the source is known to be less accurate than its digits, its accuracy counts.
    """
    if abs(ours - entry.value) <= max(entry.half_digit * (1.0 + 1e-9), entry.accuracy):
        return "reproduced"
    return "within 6 %" if abs(ours - entry.value) <= CLAIMED_ACCURACY * abs(entry.value) else "not reproduced"


def _evaluate(mechanism: Mechanism, entry: Published) -> float:
    """The figure of the closed form, SI."""
    ours = published_figure(mechanism, entry)
    if entry.less:
        ours -= _other_figure(mechanism, entry, entry.less)
    return ours / _other_figure(mechanism, entry, entry.relative_to) if entry.relative_to else ours


def _other_figure(mechanism: Mechanism, entry: Published, other: str) -> float:
    """A printed figure's value, SI, for the ``other`` signal of the linkage or the other mechanism."""
    if other in table(mechanism):
        return published_figure(mechanism, entry.model_copy(update={"quantity": rename_signal(entry.quantity, other)}))
    of, variant = load(other), mechanism.linkage.variant
    return published_figure(Mechanism(load(other, variant) if variant in of.variants else of), entry)


def rename_signal(quantity: str, signal: str) -> str:
    """A figure's name with its signal replaced: Mkr.peak of Peq is Peq.peak."""
    _, mark, rest = quantity.rpartition("@" if "@" in quantity else ".")
    return signal + mark + rest


def published_figure(mechanism: Mechanism, entry: Published) -> float:
    """Our value, SI, of a printed figure's quantity in its motion; raises LinkproofError where there is none."""
    name = entry.quantity
    if OLD_QUANTITY.fullmatch(name) or (name in OLD_RUN_UP_QUANTITIES and entry.regime is None and entry.speed is None):
        raise LinkproofError(
            f"published quantity '{name}': expected a figure by its name alone, and its motion beside it; write "
            "epsilon@0s with regime = REGIME for a start, Mkr.peak or Peq.max with regime = 'run-up' for a run-up, and "
            "less = SIGNAL for a difference"
        )
    if name in MECHANISM_FIGURES:
        return MECHANISM_FIGURES[name][1](mechanism)
    curves = Curves(case_of_motion(mechanism, motion_of_figure(mechanism, entry)))
    value, *more = case_figures(curves, figures_by_name(mechanism, name)).values()
    if more:
        raise LinkproofError(f"published quantity: expected one figure, got '{name}', which is several; name one")
    return value


class PrintedMotion(NamedTuple):
    """Motion of a printed figure: a ``regime``, or a steady ``speed``, rad/s, over a turn or up to ``angle``, rad."""

    regime: str | None
    speed: float
    angle: float | None


def motion_of_figure(mechanism: Mechanism, entry: Published) -> PrintedMotion:
    """The motion that a figure is printed for."""
    item, *_ = figures_by_name(mechanism, entry.quantity).values()
    angle = item.angle if isinstance(item, Figure) and entry.regime is None else math.nan
    speed = 1.0 if entry.speed is None else entry.speed * RPM
    return PrintedMotion(entry.regime, speed, None if math.isnan(angle) else angle)


@lru_cache(maxsize=8)
def case_of_motion(mechanism: Mechanism, printed: PrintedMotion) -> Case:
    """The case of a motion, the same for all figures that are printed for it."""
    regime, speed, end = printed
    regimes = {entry.name: entry for entry in mechanism.linkage.regimes}
    if regime in regimes:
        return case_of_file_regime(mechanism, regimes[regime])
    if regime is not None:
        if regime not in REGIMES:
            raise UnknownNameError(f"regime of '{mechanism.linkage.name}'", regime, [*regimes, *REGIMES])
        return Case(mechanism, crank_motion(regime))
    way = FULL_TURN
    if end is None:
        mechanism.check_full_turn()
        end = way
    else:
        way, reach = MARGIN, mechanism.crank_range()
        if not reach.is_full_turn:
            way = min(way, TOGGLE_SHARE * abs(end - reach.limits[0 if speed > 0.0 else 1]))
    motion = crank_motion(
        "constant-speed", speed=abs(speed), clockwise=speed < 0.0, start_angle=end - math.copysign(way, speed),
        ramp_time=0.0, hold_time=way / abs(speed),
    )  # fmt: skip
    return Case(mechanism, motion)
