"""The figures printed in the sources beside ours, in every variant of a mechanism."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from functools import lru_cache
from typing import Final

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

REPRODUCED: Final = "reproduced"
NEAR: Final = "within 6 %"
# The sources call their own methods in agreement "within 2-6 %": that is the width of a figure that is met.
CLAIMED_ACCURACY: Final = 0.06
MARGIN: Final = math.radians(10.0)  # that a crank turns before a printed angle
TOGGLE_SHARE: Final = 0.5  # of the way from a toggle, where that is less


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
    ours: float
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


def _records(linkage: Linkage) -> Iterator[PublishedRecord]:
    """The printed figures of one linkage's variant beside ours; one mechanism serves them all."""
    entries = [entry for entry in linkage.published if entry.variant in (None, linkage.variant)]
    if entries:
        mechanism = Mechanism(linkage)
        yield from (_record(mechanism, entry) for entry in entries)


def _record(mechanism: Mechanism, entry: Published) -> PublishedRecord:
    """A printed figure beside ours."""
    linkage, ours = mechanism.linkage, _evaluate(mechanism, entry)
    quantity = f"{entry.quantity} - {entry.less}" if entry.less else entry.quantity
    unit = figure_unit(entry.quantity, linkage)
    if entry.relative_to:
        unit, quantity = "", f"{quantity} / {entry.relative_to}"
    elif entry.unit is not None:
        ours /= conversion(entry.unit, unit)
        unit = entry.unit
    return PublishedRecord(
        mechanism=linkage.name,
        variant=linkage.variant,
        quantity=quantity,
        unit=unit,
        published=entry.value,
        half_digit=entry.half_digit,
        ours=ours,
        deviation=ours / entry.value - 1.0 if entry.value else None,
        verdict=verdict(entry, ours),
        source=entry.place,
        note=entry.note,
    )


def verdict(entry: Published, ours: float) -> str:
    """How our value meets a printed one: reproduced to its digits, within the 6 % the sources claim, or not reproduced.

    Where the source is known to be less accurate than its digits, its accuracy counts.
    """
    if abs(ours - entry.value) <= max(entry.half_digit * (1.0 + 1e-9), entry.accuracy):
        return REPRODUCED
    return NEAR if abs(ours - entry.value) <= CLAIMED_ACCURACY * abs(entry.value) else "not reproduced"


def _evaluate(mechanism: Mechanism, entry: Published) -> float:
    """The figure of the closed form, SI."""
    ours = published_figure(mechanism, entry)
    if entry.less:
        ours -= _other_figure(mechanism, entry, entry.less)
    return ours / _other_figure(mechanism, entry, entry.relative_to) if entry.relative_to else ours


def _other_figure(mechanism: Mechanism, entry: Published, other: str) -> float:
    """A printed figure's value, SI, for the ``other`` signal of the linkage or the other mechanism."""
    if other in table(mechanism):
        _, mark, place = entry.quantity.rpartition("@" if "@" in entry.quantity else ".")
        return published_figure(mechanism, entry.model_copy(update={"quantity": f"{other}{mark}{place}"}))
    of, variant = load(other), mechanism.linkage.variant
    return published_figure(Mechanism(load(other, variant) if variant in of.variants else of), entry)


def published_figure(mechanism: Mechanism, entry: Published) -> float:
    """Our value, SI, of a printed figure's quantity in its motion; raises LinkproofError where there is none."""
    name = entry.quantity
    if name in MECHANISM_FIGURES:
        return MECHANISM_FIGURES[name][1](mechanism)
    figures = figures_by_name(mechanism, name)
    if len(figures) > 1:
        raise LinkproofError(f"published quantity: expected one figure, got '{name}', which is several; name one")
    (item,) = figures.values()
    angle = item.angle if isinstance(item, Figure) and entry.regime is None else math.nan
    end = None if math.isnan(angle) else angle
    speed = 1.0 if entry.speed is None else entry.speed * RPM
    (value,) = case_figures(Curves(_case(mechanism, entry.regime, speed, end)), figures).values()
    return value


@lru_cache(maxsize=8)
def _case(mechanism: Mechanism, regime: str | None, speed: float, end: float | None) -> Case:
    """The case that figures are printed for: a ``regime``, or a steady ``speed``, rad/s.

    Such a crank makes a turn, or turns up to the angle ``end``, rad, where one is given.
    """
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
