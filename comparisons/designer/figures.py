"""The figures a designer chooses motor, bearings and lengths by, a row for each number, from curves of a case; SI."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache
from typing import Final

import numpy as np

from analytic.description.crank_motion import LARGEST, REGIMES, RPM, CrankMotion, Segment, crank_motion
from analytic.description.diagnosis import Source
from analytic.description.law import FULL_TURN
from analytic.description.linkage import Linkage
from analytic.description.loading import load
from analytic.description.schema import Published
from analytic.description.units import conversion
from analytic.designs.figures import STROKE, Figure, SignalExtreme, figures_named, part_figure
from analytic.dynamics import reduced
from analytic.dynamics.reduced import equilibria
from analytic.dynamics.released import FreeMotion, last_turns
from analytic.errors import LinkproofError, UnknownNameError
from analytic.kinematics.dead_centres import bottom_dead_centre, top_dead_centre
from analytic.kinematics.mechanism import Mechanism
from analytic.kinematics.structure import Revolute
from analytic.numerics.arrays import Array
from analytic.numerics.averages import NODES, WEIGHTS
from analytic.numerics.refine import extremes, highest
from analytic.signals import MAGNITUDE, THREAD_FEED, THREAD_LENGTH, feed, moving_points, signal, table, unit
from comparisons.designer.curves import DIRECTION, TRANSMISSION, Curves, Key, Measure, SignalFigure
from comparisons.motion.case import Case, case_of_file_regime

SHAKING: Final = "shaking force"
SAME_SPEED: Final = 1e-9  # share of the largest speed within which an instant counts as one of the largest speed
NEGLIGIBLE: Final = 1e-12  # share of the largest value of a kind below which a value is zero but for rounding
NEGLIGIBLE_MEAN: Final = 1e-9  # of its signal's peak: the integral of a mean is this near to the truth
FEWEST: Final = 4  # instants of the grid at that speed that make it more than a moment
PEAK_SPEED: Final = "peak speed"
PEAK_TORQUE: Final = ("peak torque", "peak force")  # of a drive along a line
BRAKING: Final = "peak braking power"
FRICTION: Final = "friction"
MEAN: Final = "signed mean"
DRIVE: Final[Mapping[str, Measure]] = {
    "peak torque": lambda at: np.abs(at.torque),
    "peak power": lambda at: at.torque * at.speed,
    BRAKING: lambda at: -at.torque * at.speed,
}
TABLES: Final = ("drive", "flywheel", "forces", "moment", "transmission", "output", "thread")
LOAD: Final = ("Mkr", "omega", "Peq")  # of the drive, side by side


Peaks = Mapping[str, SignalFigure]  # of every signal

REPRODUCED: Final = "reproduced"
NEAR: Final = "within 6 %"
# The sources call their own methods in agreement "within 2-6 %": that is the width of a figure that is met.
CLAIMED_ACCURACY: Final = 0.06
MARGIN: Final = math.radians(10.0)  # that a crank turns before a printed angle
TOGGLE_SHARE: Final = 0.5  # of the way from a toggle, where that is less


def figure_tables(curves: Curves, peaks: Peaks) -> dict[str, tuple[SignalFigure, ...]]:
    """The key figures of curves, those of each table by its name in ``TABLES``; () where there are none.

    ``peaks`` are those of all signals, by name.
    """
    groups = {name: name.removeprefix(TRANSMISSION) for name in curves.names if name.startswith(TRANSMISSION)}
    pivot = curves.case.mechanism.structure.pivot
    moment = {"shaking_moment": f"about {pivot.point if isinstance(pivot, Revolute) else 'the origin'}"}
    rows = (
        drive_figures(curves, peaks),
        flywheel_figures(curves),
        force_figures(curves, peaks),
        _named_peaks(peaks, moment),
        _named_peaks(peaks, groups),
        output_figures(curves, peaks),
        thread_figures(curves),
    )
    return {name: tuple(table) for name, table in zip(TABLES, rows, strict=True)}


def _named_peaks(peaks: Peaks, signals: Mapping[str, str]) -> Iterator[SignalFigure]:
    """The peaks of those ``signals`` that have one, as an iterator; ``signals`` has the name of the row for each."""
    return (replace(peaks[name], what=what) for name, what in signals.items() if name in peaks)


def drive_figures(curves: Curves, peaks: Peaks) -> Iterator[SignalFigure]:
    """Yield figures to choose a motor by: peaks of torque, power and speed, RMS and means; none without mass or load.

    Peaks are those of torque or force, driving and braking power, of speed where it changes, and of friction's share,
    if there is friction; each comes with the other two quantities at its instant. Means have a sign, the RMS has none.
    """
    if "Mkr" not in peaks:
        return

    def load(what: str, values: Iterable[float], time: float | None = None) -> Iterator[SignalFigure]:
        """Figures ``what`` of torque, power and speed with these values, as an iterator.

        At one instant, s, if given.
        """
        return (curves.figure(what, name, value, time) for name, value in zip(LOAD, values, strict=True))

    force = curves.linkage.phi.effort
    places = curves.places(DRIVE)
    if not curves.instants.is_steady:
        places[PEAK_SPEED] = _peak_speed_time(curves)
    points = {what: curves.values(LOAD, time) for what, time in places.items()}
    least = NEGLIGIBLE * max(abs(power) for *_, power in points.values())
    for what, point in points.items():
        if "power" in what and not curves.case.motion.peak_speed:
            continue
        if what != BRAKING or point[-1] < -least:
            yield from load(what.replace("torque", force), point, places[what])
    if curves.linkage.friction:
        (place,) = curves.places({FRICTION: lambda at: np.abs(at.friction_torque)}).values()
        share, speed = (float(values[0]) for values in _friction_at(curves, place))
        yield from load(f"peak {FRICTION} {force}", (share, speed, share * speed), place)
    square, *means = curves.means(
        lambda at: np.square(at.torque), lambda at: at.torque, lambda at: at.speed, lambda at: at.torque * at.speed
    )
    yield curves.figure(f"RMS {force}", "Mkr", math.sqrt(square))
    sizes = [NEGLIGIBLE_MEAN * abs(peaks[name].value or 0.0) for name in LOAD]
    yield from load(MEAN, [mean if abs(mean) > size else 0.0 for mean, size in zip(means, sizes, strict=True)])


def flywheel_figures(curves: Curves) -> Iterator[SignalFigure]:
    """Yield the size of the flywheel that limits a turning crank's fluctuation to the file's coefficient.

    None without a coefficient or a crank that goes on turning.
    """
    wanted, speed = curves.linkage.fluctuation, _running_speed(curves)
    if wanted and speed:
        yield curves.figure(f"for a fluctuation of {wanted:g}", "Jeq", flywheel(curves.case, speed, wanted))


def _running_speed(curves: Curves) -> float:
    """The speed, rad/s, signed, at which a crank goes on turning; 0 for any other motion.

    It goes on at a constant speed, or released, if it makes more than a turn: then it is the mean over φ of the last
    turn, which no flywheel changes. A linear drive, and a crank that cannot turn fully, do not.
    """
    motion = curves.case.motion
    if curves.linkage.is_linear or not curves.case.mechanism.crank_range().is_full_turn:
        return 0.0
    if isinstance(motion, FreeMotion):
        way = float(motion.angle(motion.duration) - motion.angle(0.0))
        return last_turns(motion).mean_speed_over_angle if abs(way) > FULL_TURN else 0.0
    return float(motion.speed(0.0)) if curves.instants.is_steady else 0.0


def flywheel(case: Case, speed: float, fluctuation: float) -> float:
    """Moment of inertia, kg m², to add on a crank that a constant torque drives at a mean ``speed``, rad/s.

    ``fluctuation`` is the coefficient δ that is allowed, (ω_max − ω_min) / ω_mean. The result is exact for loads that
    do not depend on the speed: with w the work of the mean torque less that of the drive from φ = 0 at constant speed,
    (J + Jeq) ω² = 2 w + Jeq ω₀² + C lies between its values at ω₀ (1 ∓ δ/2) everywhere (F. Wittenbauer, Zeitschrift für
    Mathematik und Physik 50, 1904). 0 where none is needed.
    """
    from scipy.interpolate import CubicHermiteSpline  # noqa: PLC0415 - what wants no flywheel does not pay for it

    cycle = case.mechanism.cycle / abs(speed)
    steady = Curves(replace(case, motion=CrankMotion("", (Segment(0.0, cycle, (0.0, speed)),))))
    time, (mean,) = steady.grid, steady.means(lambda at: at.torque * at.speed)
    cells, nodes = np.diff(time), NODES[:, None]
    inner = steady.truth_at((time[:-1] + cells * nodes).ravel())
    gained = cells * (mean - WEIGHTS @ (inner.torque * inner.speed).reshape(len(nodes), -1))
    excess = np.append(0.0, np.cumsum(gained))
    work = CubicHermiteSpline(time, excess, mean - steady.on_grid.torque * steady.on_grid.speed)

    def bounds(at: Array) -> Array:
        """The energies, J, whose largest values add up to those of the flywheel, at instants (n,), s: (2, n)."""
        energy = 0.5 * speed**2 * signal(steady.truth_at(at), "Jeq")
        return np.stack([s * (work(at) + energy * (1.0 - (1.0 + 0.5 * s * fluctuation) ** 2)) for s in (1.0, -1.0)])

    (high, low), _ = highest(bounds, time, bounds(time))
    return max(float(high + low) / (fluctuation * speed**2), 0.0)


def _friction_at(curves: Curves, time: float) -> tuple[Array, Array]:
    """The share of friction in the drive's torque, N m or N, and its speed, rad/s or m/s, at an instant, s.

    Each is (1,).
    """
    truth = curves.truth_at(np.array([time]))
    return truth.friction_torque, np.atleast_1d(truth.speed)


def force_figures(curves: Curves, peaks: Peaks) -> Iterator[SignalFigure]:
    """Yield two figures for the largest force of every joint and of the linkage on its frame: its size and direction.

    The joint names them, and ``on`` is the link on which the force acts. Directions are in rad, from x.
    """
    joints = {f"joint_force:{joint}": (joint, link) for joint, link in _loaded_links(curves).items()}
    every = {**joints, "shaking_force": (SHAKING, "ground")}
    vectors = {vector: words for vector, words in every.items() if vector + MAGNITUDE in peaks}
    truth = curves.truth_at(np.array([peaks[vector + MAGNITUDE].time for vector in vectors]))
    for row, (vector, (what, link)) in enumerate(vectors.items()):
        peak = replace(peaks[vector + MAGNITUDE], what=what, on=link)
        x, y = (float(curves.signal_values(truth, f"{vector}:{component}")[row]) for component in "xy")
        yield from (peak, curves.figure(what, vector + DIRECTION, math.atan2(y + 0.0, x + 0.0), peak.time, link))


def output_figures(curves: Curves, peaks: Peaks) -> Iterator[SignalFigure]:
    """Yield the output's stroke, the ends of its travel, largest speed and acceleration; none without an output.

    The ends are the least and the largest S.
    """
    if "S" not in peaks:
        return
    places = curves.places({"least S": lambda at: -signal(at, "S"), "largest S": lambda at: signal(at, "S")})
    values = {what: curves.values(("S",), time)[0] for what, time in places.items()}
    ends = [curves.figure(what, "S", value, places[what]) for what, value in values.items()]
    stroke = curves.figure("stroke", "S", values["largest S"] - values["least S"])
    yield replace(stroke, at_open_end=any(end.at_open_end for end in ends))
    yield from ends
    yield from _named_peaks(peaks, {"v": "peak v", "a": "peak a"})


def thread_figures(curves: Curves) -> Iterator[SignalFigure]:
    """Yield the thread's feed and length where feed or eyes' heights are extreme, and the feed's range.

    Where a feed is required, the actual one's largest miss, with its sign, and the RMS of all follow. None without a
    thread that has a feed.
    """
    path = curves.linkage.thread
    if path is None or THREAD_FEED not in curves.names:
        return
    measures: dict[str, Measure] = {
        "least feed": lambda at: -signal(at, THREAD_FEED),
        "largest feed": lambda at: signal(at, THREAD_FEED),
    }
    for eye in dict.fromkeys(eye.point for eye in path.eyes if eye.point in moving_points(curves.linkage)):
        measures[f"{eye} highest"] = lambda at, eye=eye: at.sweep.point(eye)[1]  # type: ignore[misc]
        measures[f"{eye} lowest"] = lambda at, eye=eye: -at.sweep.point(eye)[1]  # type: ignore[misc]
    both = (THREAD_FEED, THREAD_LENGTH)
    points = {what: (time, curves.values(both, time)) for what, time in curves.places(measures).items()}
    for what, (time, values) in points.items():
        yield from (curves.figure(what, name, value, time) for name, value in zip(both, values, strict=True))
    yield curves.figure("range of the feed", THREAD_FEED, points["largest feed"][1][0] - points["least feed"][1][0])
    if required := required_feed(curves):
        apart = required["actual"] - required["required"]
        worst = int(np.argmax(np.abs(apart)))
        largest = curves.figure("farthest from required", THREAD_FEED, apart[worst])
        yield replace(largest, phi=float(required["phi"][worst]))
        yield curves.figure("RMS from required", THREAD_FEED, float(np.sqrt(np.mean(apart**2))))


def required_feed(curves: Curves) -> dict[str, Array]:
    """φ, rad, the feed, m, that the file requires there, and the actual one, (n,) each, in the file's order.

    They are under "phi", "required" and "actual". {} if it requires none, and where the thread has no feed.
    """
    path = curves.linkage.thread
    if path is None or not path.required or THREAD_FEED not in curves.names:
        return {}
    phi, required = np.array(path.required).T
    return {"phi": phi, "required": required, "actual": feed(curves.case.mechanism, path, phi)}


def _peak_speed_time(curves: Curves) -> float:
    """Time of the largest speed, s; of a constant largest speed, the time of the largest torque during it."""
    place = curves.places({"speed": lambda at: np.abs(at.speed)})["speed"]
    fastest = abs(curves.values(("omega",), place)[0]) * (1.0 - SAME_SPEED)
    if np.count_nonzero(np.abs(curves.on_grid.speed) >= fastest) < FEWEST:
        return place
    torque = curves.places({"torque": lambda at: np.where(np.abs(at.speed) >= fastest, np.abs(at.torque), -1.0)})
    return torque["torque"]


def _loaded_links(curves: Curves) -> dict[str, str]:
    """The name of the link on which each joint's force acts, by the joint's; of a slot the body with its pin."""
    linkage, sweep = curves.linkage, curves.case.start()
    pins = {joint: link for pin in linkage.pins for joint, link in pin.joints.items()}
    sliders = {slider.name: slider.link for slider in linkage.sliders}
    return {**pins, **sliders, **{slot.name: sweep.carrier(slot.point) for slot in linkage.slots}}


# Figures of a case by name, SI: of signals over its motion, and of the mechanism alone.
#
# A signal's figure has the name of ``analytic.designs.figures``, and its means are over the time. Of a mechanism, in
# any motion, there are
#
# ``Jeq.pulsation``     half the range of Jeq over a turn, over its mean
# ``equilibrium``       crank angle, rad, of the undriven linkage's stable rest with the least potential energy
# ``top_dead_centre``   crank angle, rad, at which the output is highest along its direction
# ``time_ratio``        crank angle of the output's slower stroke over that of its faster one
# ``range.low .high``   ends, rad, of the range of a crank that cannot turn fully

MechanismFigure = Callable[[Mechanism], float]


def _resting_angle(mechanism: Mechanism) -> float:
    """Crank angle, rad in [0, 2π), of the stable rest with the least potential energy.

    Raises LinkproofError where there is no such rest.
    """
    stable = [rest.angle for rest in equilibria(mechanism) if rest.stable]
    if not stable:
        raise LinkproofError(f"'{mechanism.linkage.name}' has no stable equilibrium: its loads balance at no angle")
    return min(stable, key=lambda angle: float(reduced.potential_energy(mechanism.sweep(angle)))) % FULL_TURN


def _time_ratio(mechanism: Mechanism) -> float:
    """Crank angle of the output's slower stroke divided by that of its faster one, 1 or more.

    Raises LinkproofError without an output or where it stands still, AssemblyError for a crank that makes no turn.
    """
    stroke = (bottom_dead_centre(mechanism).angle - top_dead_centre(mechanism).angle) % FULL_TURN
    strokes = sorted((stroke, FULL_TURN - stroke))
    return strokes[1] / strokes[0]


def _range_limit(mechanism: Mechanism, end: int) -> float:
    """The lower (0) or upper (1) end of the crank's range, rad; raises LinkproofError for a full turn."""
    reach = mechanism.crank_range()
    if reach.is_full_turn:
        raise LinkproofError(f"'{mechanism.linkage.name}': its crank turns fully, so its range has no limits")
    return reach.limits[end]


def _pulsation(mechanism: Mechanism) -> float:
    """Relative pulsation of Jeq, half its range over its mean, over a turn."""
    return extremes(lambda phi: reduced.reduced_inertia(mechanism.sweep(phi))).relative_pulsation


# Each with its SI unit.
MECHANISM_FIGURES: Final[Mapping[str, tuple[str, MechanismFigure]]] = {
    "Jeq.pulsation": ("", _pulsation),
    "equilibrium": ("rad", _resting_angle),
    "top_dead_centre": ("rad", lambda mechanism: top_dead_centre(mechanism).angle),
    "time_ratio": ("", _time_ratio),
    "range.low": ("rad", lambda mechanism: _range_limit(mechanism, 0)),
    "range.high": ("rad", lambda mechanism: _range_limit(mechanism, 1)),
}


def figures_by_name(mechanism: Mechanism, name: str) -> Mapping[str, Figure | MechanismFigure]:
    """The figures of a case that a typed name stands for, by name; raises LinkproofError for an unknown one.

    A signal's name alone stands for several. One of ``MECHANISM_FIGURES`` is the function that computes it from the
    mechanism, any other a Figure.
    """
    return (
        {name: MECHANISM_FIGURES[name][1]}
        if name in MECHANISM_FIGURES
        else figures_named(mechanism, name, in_time=True)
    )


def figure_unit(name: str, linkage: Linkage) -> str:
    """SI unit of a figure of the linkage, by its name; "" without a unit; raises KeyError for an unknown kind."""
    if name in MECHANISM_FIGURES:
        return MECHANISM_FIGURES[name][0]
    return unit("S" if name == STROKE else part_figure(name)[0], linkage)


def case_figures(curves: Curves, figures: Mapping[Key, Figure | MechanismFigure]) -> dict[Key, float]:
    """Values, SI, of figures over the motion, by the keys of ``figures``, as from ``figures_by_name``.

    Raises LinkproofError for a place or an instant that the motion does not have, and for what the mechanism lacks.
    """
    of_signals = {name: entry for name, entry in figures.items() if isinstance(entry, Figure)}
    values = {name: entry(curves.case.mechanism) for name, entry in figures.items() if not isinstance(entry, Figure)}

    def height(end: SignalExtreme) -> Measure:
        """The measure that is highest at an extreme of a signal: at the least or the largest value, or magnitude."""
        return lambda at: end.height(curves.signal_values(at, end.signal))

    places = curves.places({end: height(end) for quantity in of_signals.values() for end in quantity.extremes})
    at_places = curves.truth_at(np.array([*places.values()]))
    ends = {end: curves.signal_values(at_places, end.signal)[row] for row, end in enumerate(places)}
    means = {
        quantity: lambda at, entry=quantity: entry.integrand(curves.signal_values(at, entry.signal))
        for quantity in of_signals.values()
        if quantity.is_mean
    }
    averages = dict(zip(means, curves.means(*means.values()) if means else (), strict=True))
    for name, figure in of_signals.items():
        if figure.extremes:
            values[name] = float(figure.of([ends[end] for end in figure.extremes]))
        elif figure.is_mean:
            values[name] = float(figure.of_mean(np.array(averages[figure])))
        else:
            values[name] = float(curves.signal_values(curves.truth_at(_figure_time(curves, figure)), figure.signal)[0])
    return values


def _figure_time(curves: Curves, figure: Figure) -> Array:
    """The instant (1,), s, of a figure at a time, or of the first passage of its place, whole turns aside.

    Raises LinkproofError where the motion has none.
    """
    if math.isnan(figure.time):
        return curves.instants.times_of_angles(np.array([figure.angle]), "", 1.0)
    return curves.instants.checked_times(np.array([figure.time]))


@dataclass(frozen=True)
class PublishedRecord:
    """A printed figure beside ours, both in the printed unit.

    ``half_digit`` is half a unit of the last printed digit. ``deviation`` is ours over published less one, None where 0
    is published. ``verdict`` is that of ``verdict``, ``source`` the place where it is printed.
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
    """Every printed figure of these linkages against ours, in their order, each linkage in its own variant.

    Raises LinkproofError where a linkage cannot make the motion of a figure.
    """
    return tuple(record for linkage in linkages for record in _records(linkage))


def check_published(mechanism: Mechanism) -> None:
    """Raise DescriptionError, with the line, for a printed figure of an unknown quantity, unit or regime.

    So too for a speed that is none. Figures of other variants are left alone.
    """
    linkage = mechanism.linkage
    source = Source(f"{linkage.name}.toml", linkage.text, linkage.variant)
    regimes = [entry.name for entry in linkage.regimes]
    for number, entry in enumerate(linkage.published):
        if entry.variant not in (None, linkage.variant):
            continue
        key = "quantity"
        try:
            figures_by_name(mechanism, entry.quantity)
            key = "unit"
            if entry.unit is not None and not entry.relative_to:
                conversion(entry.unit, figure_unit(entry.quantity, linkage))
            key = "regime"
            if entry.regime is not None and entry.regime not in (*regimes, *REGIMES):
                raise UnknownNameError(f"regime of '{linkage.name}'", entry.regime, [*regimes, *REGIMES])
            key = "speed"
            if entry.speed is not None and not 1.0 / LARGEST <= abs(entry.speed) * RPM <= LARGEST:
                raise LinkproofError(f"expected a crank that turns, got {entry.speed:g} rpm; leave it out for 1 rad/s")
        except LinkproofError as error:
            raise source.fault(f"published.{number}.{key}: {error}") from error


def _records(linkage: Linkage) -> Iterator[PublishedRecord]:
    """Yield the records of the figures printed for one linkage's variant, in the file's order.

    Raises LinkproofError where it cannot make the motion of one.
    """
    entries = [entry for entry in linkage.published if entry.variant in (None, linkage.variant)]
    if entries:
        mechanism = Mechanism(linkage)
        asked = [*_asked(mechanism, entries)]
        values = published_figures([part for parts in asked for part in parts])
        for entry, parts in zip(entries, asked, strict=True):
            ours, values = values[: len(parts)], values[len(parts) :]
            yield _record(mechanism, entry, _combined(entry, *ours))


def _asked(mechanism: Mechanism, entries: Iterable[Published]) -> Iterator[list[tuple[Mechanism, Published]]]:
    """Yield for each printed figure a list of what it is made of, each a figure of a mechanism.

    It is the figure itself, then the one to subtract, then the divisor, as far as it has them. These are of another
    signal of this linkage, or of another mechanism, in this linkage's variant if it has that. Raises LinkproofError for
    a mechanism that cannot be read.
    """
    variant, signals = mechanism.linkage.variant, table(mechanism)

    @cache
    def named(name: str) -> Mechanism:
        """Another mechanism, by its name, in this linkage's variant if it has that; each read once."""
        linkage = load(name)
        return Mechanism(load(name, variant) if variant in linkage.variants else linkage)

    def other(entry: Published, name: str) -> tuple[Mechanism, Published]:
        """The same figure of another signal, or of another mechanism, called ``name``."""
        if name not in signals:
            return named(name), entry
        return mechanism, entry.model_copy(update={"quantity": f"{name}{part_figure(entry.quantity)[1]}"})

    for entry in entries:
        yield [(mechanism, entry), *(other(entry, name) for name in (entry.less, entry.relative_to) if name)]


def _combined(entry: Published, ours: float, *others: float) -> float:
    """Our value of a printed figure, SI: ``ours``, less or over the values ``others`` of what else ``_asked`` gives."""
    if entry.less:
        ours -= others[0]
    return ours / others[-1] if entry.relative_to else ours


def _record(mechanism: Mechanism, entry: Published, ours: float) -> PublishedRecord:
    """The record of a printed figure with our value, SI, beside it, in the printed unit.

    To a place whole turns are added until it is nearest to the printed one.
    """
    linkage = mechanism.linkage
    quantity = f"{entry.quantity} - {entry.less}" if entry.less else entry.quantity
    unit = figure_unit(entry.quantity, linkage)
    if entry.relative_to:
        unit, quantity = "", f"{quantity} / {entry.relative_to}"
    elif entry.unit is not None:
        ours /= conversion(entry.unit, unit)
        unit = entry.unit
    if _is_place(entry, mechanism):
        turn = 2.0 * math.pi / conversion(unit or "rad", "rad")
        ours += turn * round((entry.value - ours) / turn)
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


def _is_place(entry: Published, mechanism: Mechanism) -> bool:
    """Whether a printed figure is an angle of which whole turns do not count.

    It is one of ``MECHANISM_FIGURES`` or of a signal at an instant or a place, with the SI unit rad, and relative to
    nothing.
    """
    is_angle = figure_unit(entry.quantity, mechanism.linkage) == "rad" and not entry.relative_to
    return is_angle and (entry.quantity in MECHANISM_FIGURES or part_figure(entry.quantity)[1].startswith("@"))


def verdict(entry: Published, ours: float) -> str:
    """How our value meets a printed one: reproduced to its digits, within the 6 % the sources claim, or not reproduced.

    Both are in the printed unit. Where the source is known to be less accurate than its digits, its accuracy counts.
    The words are "reproduced", "within 6 %" and "not reproduced".
    """
    if abs(ours - entry.value) <= max(entry.half_digit * (1.0 + 1e-9), entry.accuracy):
        return REPRODUCED
    return NEAR if abs(ours - entry.value) <= CLAIMED_ACCURACY * abs(entry.value) else "not reproduced"


def published_figures(asked: Sequence[tuple[Mechanism, Published]]) -> list[float]:
    """Our values, SI, of printed figures' quantities in their motions, in their order.

    Those of one motion are found together. Raises LinkproofError for an unknown quantity or regime, for a motion that
    the linkage cannot make, and where a quantity is several figures.
    """
    values: dict[int, float] = {}
    motions: dict[tuple[Mechanism, str | None, float, float | None], dict[int, Figure | MechanismFigure]] = {}
    for number, (mechanism, entry) in enumerate(asked):
        figures = figures_by_name(mechanism, entry.quantity)
        if len(figures) > 1:
            raise LinkproofError(
                f"published quantity: expected one figure, got '{entry.quantity}', which is several; name one"
            )
        (item,) = figures.values()
        if not isinstance(item, Figure):
            values[number] = item(mechanism)
            continue
        end = item.angle if entry.regime is None and not math.isnan(item.angle) else None
        speed = 1.0 if entry.speed is None else entry.speed * RPM
        motions.setdefault((mechanism, entry.regime, speed, end), {})[number] = item
    for motion, found in motions.items():
        values |= case_figures(Curves(_case(*motion)), found)
    return [values[number] for number in range(len(asked))]


def _case(mechanism: Mechanism, regime: str | None, speed: float, end: float | None) -> Case:
    """The case that figures are printed for: a ``regime``, of the file or a general one, or a steady ``speed``, rad/s.

    Without a regime the crank makes a turn, or where an angle ``end``, rad, is given the last MARGIN, rad, or less up
    to it. Raises UnknownNameError for an unknown regime, and LinkproofError for a crank that makes no turn.
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
