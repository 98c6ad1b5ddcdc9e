"""The figures printed in the sources beside ours, in every variant of a mechanism."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, replace

import numpy as np

from analytic.description.crank_motion import RPM, crank_motion
from analytic.description.law import FULL_TURN
from analytic.description.linkage import Linkage
from analytic.description.loading import load
from analytic.description.schema import Published
from analytic.description.units import conversion
from analytic.dynamics import reduced
from analytic.dynamics.equilibrium import equilibria
from analytic.errors import LinkproofError, UnknownNameError
from analytic.kinematics.mechanism import Mechanism
from analytic.numerics.extremes import Extremes, extremes
from analytic.turn.unit_functions import bottom_dead_centre, top_dead_centre, unit_functions
from comparisons.reference.case import own_motion
from comparisons.reference.signal_figures import signal_figure

# The sources call their own methods in agreement "within 2-6 %": that is the width of a figure that is met.
CLAIMED = 0.06
# Instants over the run-up at which its peaks are looked for: a 500th of a turn at full speed.
INSTANTS = 35001


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


Figure = Callable[[Mechanism], float]


def _inertia(mechanism: Mechanism, link: str | None = None) -> Extremes:
    names = None if link is None else [link]
    return extremes(lambda phi: reduced.reduced_inertia(mechanism.sweep(phi), names))


def _run_up_peaks(mechanism: Mechanism) -> tuple[float, float]:
    """Peak |Mkr|, N m, and peak Peq, W, of the linear run-up from φ = 0."""
    motion = crank_motion("run-up")
    time = np.linspace(0.0, motion.duration, INSTANTS)
    speed = motion.speed(time)
    torque = reduced.drive_torque(mechanism.sweep(motion.angle(time)), speed, motion.acceleration(time))
    return float(np.max(np.abs(torque))), float(np.max(torque * speed))


def _resting_angle(mechanism: Mechanism) -> float:
    """The stable equilibrium of the undriven crank with the least potential energy, degrees."""
    stable = [found.angle for found in equilibria(mechanism) if found.stable]
    if not stable:
        raise LinkproofError(f"'{mechanism.linkage.name}' has no stable equilibrium: its loads balance at no angle")
    lowest = min(stable, key=lambda angle: float(reduced.potential_energy(mechanism.sweep(angle))))
    return math.degrees(lowest) % 360.0


def _start_acceleration(mechanism: Mechanism, regime: str) -> float:
    """Crank acceleration at the start of a regime of the linkage's own, rad/s²."""
    own = mechanism.linkage.released[regime]
    return float(own_motion(mechanism, replace(own, duration=SHORT)).acceleration(np.zeros(())))


def _time_ratio(mechanism: Mechanism) -> float:
    """Crank angle of the output's slower stroke over that of its faster one, between its outermost dead centres."""
    there = (bottom_dead_centre(mechanism).angle - top_dead_centre(mechanism).angle) % FULL_TURN
    strokes = sorted((there, FULL_TURN - there))
    return strokes[1] / strokes[0]


def _limit(mechanism: Mechanism, end: int) -> float:
    """The lowest or the highest angle of a crank that cannot turn fully, rad."""
    reach = mechanism.crank_range()
    if reach.is_full_turn:
        raise LinkproofError(f"'{mechanism.linkage.name}': its crank turns fully, so its range has no limits")
    return reach.limits[end]


FIGURES: Mapping[str, tuple[str, Figure]] = {
    "Jeq.pulsation": ("", lambda m: _inertia(m).relative_pulsation),
    "Mkr.peak": ("N m", lambda m: _run_up_peaks(m)[0]),
    "Peq.peak": ("W", lambda m: _run_up_peaks(m)[1]),
    "equilibrium": ("°", _resting_angle),
    "time_ratio": ("", _time_ratio),
    "range.low": ("rad", lambda m: _limit(m, 0)),
    "range.high": ("rad", lambda m: _limit(m, 1)),
    "S.harmonic_deviation": ("", lambda m: unit_functions(m).deviations[0]),
    "v.harmonic_deviation": ("", lambda m: unit_functions(m).deviations[1]),
    "a.harmonic_deviation": ("", lambda m: unit_functions(m).deviations[2]),
}

# "Jeq:LINK.mean" is the mean reduced inertia of one link.
LINK_PREFIX, LINK_SUFFIX = "Jeq:", ".mean"
# "start_acceleration:REGIME" is the crank's at the start of a regime of the linkage's own.
START_PREFIX, SHORT = "start_acceleration:", 1e-3


def figure(mechanism: Mechanism, name: str, speed: float = 1.0) -> tuple[str, float]:
    """SI unit and value of a figure of a mechanism by name: one of these, or one of a signal, at a crank's ``speed``.

    The speed is in rad/s. Raises LinkproofError for a figure that we cannot compute.
    """
    if name in FIGURES:
        unit, compute = FIGURES[name]
        return unit, compute(mechanism)
    link = name.removeprefix(LINK_PREFIX).removesuffix(LINK_SUFFIX)
    if name == f"{LINK_PREFIX}{link}{LINK_SUFFIX}" and link in mechanism.linkage.links:
        return "kg m²", _inertia(mechanism, link).mean
    regimes = [f"{START_PREFIX}{own.name}" for own in mechanism.linkage.released.values()]
    if name in regimes:
        return "rad/s²", _start_acceleration(mechanism, name.removeprefix(START_PREFIX))
    links = [f"{LINK_PREFIX}{link}{LINK_SUFFIX}" for link in mechanism.linkage.links]
    if name.startswith((LINK_PREFIX, START_PREFIX)):
        raise UnknownNameError("published quantity", name, [*links, *regimes])
    return signal_figure(mechanism, name, speed)


def compare_published(linkages: Iterable[Linkage]) -> tuple[PublishedRecord, ...]:
    """Every printed figure of these linkages against ours, in each linkage's own variant."""
    return tuple(record for linkage in linkages for record in _records(linkage))


def all_variants(name: str) -> tuple[Linkage, ...]:
    """A mechanism in each of its variants, the file's own first."""
    first = load(name)
    return (first, *(load(name, variant) for variant in first.variants[1:]))


def applies(linkage: Linkage, entry: Published) -> bool:
    """Whether a printed figure is of the linkage's variant."""
    return entry.variant is None or entry.variant == linkage.variant


def _records(linkage: Linkage) -> Iterator[PublishedRecord]:
    """One mechanism serves all figures of its linkage."""
    entries = [entry for entry in linkage.published if applies(linkage, entry)]
    if entries:
        mechanism = Mechanism(linkage)
        yield from (_record(mechanism, entry) for entry in entries)


def _record(mechanism: Mechanism, entry: Published) -> PublishedRecord:
    linkage = mechanism.linkage
    unit, ours = in_printed_unit(entry, *figure(mechanism, entry.quantity, speed_of(entry)))
    quantity = entry.quantity
    if entry.relative_to is not None:
        other = load(entry.relative_to)
        variant = linkage.variant if linkage.variant in other.variants else None
        ours /= figure(Mechanism(load(entry.relative_to, variant)), entry.quantity)[1]
        quantity, unit = f"{entry.quantity} / {entry.relative_to}", ""
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


def speed_of(entry: Published) -> float:
    """Speed of the crank that a figure is printed for, rad/s; 1 where none is."""
    return 1.0 if entry.speed is None else entry.speed * RPM


def in_printed_unit(entry: Published, unit: str, ours: float) -> tuple[str, float]:
    """Unit and value as they are printed, from SI."""
    return (unit, ours) if entry.unit is None else (entry.unit, ours / conversion(entry.unit, unit))


def verdict(entry: Published, ours: float) -> str:
    """Reproduced to the printed digits, within the 6 % the sources claim of themselves, or not reproduced.

    Where the source is known to be less accurate than its digits, its accuracy counts.
    """
    if abs(ours - entry.value) <= max(entry.half_digit * (1.0 + 1e-9), entry.accuracy):
        return "reproduced"
    return "within 6 %" if abs(ours - entry.value) <= CLAIMED * abs(entry.value) else "not reproduced"
