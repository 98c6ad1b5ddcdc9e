"""Sheets made: the closed form of a mechanism over one motion, and where its bodies are, as plain data."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from functools import partial
from typing import Any, Final, TypeVar

import numpy as np

from analytic.description.crank_motion import RPM, CrankMotion, Segment, swing
from analytic.description.law import FULL_TURN
from analytic.description.linkage import Linkage, PrescribedRegime, ReleasedRegime, ThreadGuide
from analytic.description.loading import parse
from analytic.description.units import FileUnit
from analytic.description.written import file_unit, finite
from analytic.dynamics import reduced
from analytic.dynamics.reduced import equilibria
from analytic.dynamics.released import FreeMotion, Rotation, energy_imbalance, last_turns, steady_state
from analytic.errors import LinkproofError
from analytic.kinematics.crank_range import CrankRange
from analytic.kinematics.dead_centres import top_of_turn
from analytic.kinematics.mechanism import Mechanism
from analytic.numerics.arrays import Array, distinct
from analytic.numerics.refine import grid, in_turn, periodic_mean
from analytic.signals import THREAD_FEED, reference_angle, reference_length, stop_position
from comparisons.designer.curves import Curves, Instants, SignalFigure, choose_samples
from comparisons.designer.figures import compare_published, figure_tables, required_feed
from comparisons.designer.linkage_check import file_facts, mechanism_facts
from comparisons.designer.open_ends import inset_ends, open_end_warning
from comparisons.designer.sheet import Positions, Released, Sheet, ThreadSheet
from comparisons.motion.case import Case, motion_of_file_regime

POSITIONS_SHOWN: Final = 121  # of a turn, a range or a motion
TURN_ROUNDING: Final = 1e-9  # of a turn: what is missing of a whole one for rounding

PER_TURN, FEWEST_INSTANTS, MOST_INSTANTS = 60, 2000, 100_000  # instants at which a motion is looked at
LAST_TURN_SAMPLES: Final = 361


def positions_over_range(mechanism: Mechanism) -> Positions:
    """The positions of all bodies over a turn from φ = 0, or over the crank's range, short of its limits.

    At a limit a body may be infinitely far away. Raises AssemblyError where the linkage cannot be assembled.
    """
    reach = mechanism.crank_range()
    low, high = (0.0, FULL_TURN) if reach.is_full_turn else inset_ends(reach)
    angle = np.linspace(low, high, POSITIONS_SHOWN)
    return positions_at(mechanism, angle, closed=reach.is_full_turn)


def positions_over_motion(curves: Curves) -> Positions:
    """The positions of a case's bodies: over φ of one turn if its motion makes one, else over the motion's time.

    The turn begins at φ = 0 and is the mechanism's period. Raises AssemblyError where the linkage cannot make the
    motion.
    """
    case = curves.case
    mechanism, (low, high) = case.mechanism, case.reach
    if not mechanism.linkage.is_linear and high - low >= FULL_TURN * (1.0 - TURN_ROUNDING):
        return positions_at(mechanism, np.linspace(0.0, mechanism.period, POSITIONS_SHOWN), closed=True)
    truth = curves.truth_at(np.linspace(0.0, case.motion.duration, POSITIONS_SHOWN))
    positions = positions_at(mechanism, truth.sweep.angle, closed=False)
    bodies = {
        name: np.array([x, y, curves.signal_values(truth, f"link:{name}:angle")])
        for name, (x, y, _) in positions.bodies.items()
    }
    return replace(positions, over="time", axis=truth.time, bodies=bodies)


def positions_at(mechanism: Mechanism, angle: Array, *, closed: bool) -> Positions:
    """The positions of all bodies over φ (n,), rad or m; ``closed`` if that is a whole turn.

    Raises AssemblyError where the linkage cannot be assembled at one of them.
    """
    sweep, linkage = mechanism.sweep(angle), mechanism.linkage
    bodies = {name: np.array(np.broadcast_arrays(*sweep.poses(name)[:2], sweep.angles(name))) for name in linkage.links}
    carriers = {slot.point: sweep.carrier(slot.point) for slot in linkage.slots}
    return Positions("phi", angle, bodies, carriers, closed)


T = TypeVar("T")

STEADY: Final = "constant-speed"
OVER_RANGE: Final = f"{STEADY} over its range"
USUAL_SPEED: Final = 1000.0 * RPM
FEW, MOST = 361, 721  # instants of a page
MOST_NUMBERS: Final = 40_000  # of all its signals


def usual_case(mechanism: Mechanism, prescribed: Sequence[CrankMotion] = (), regimes: Sequence[str] = ()) -> Case:
    """The case of a linkage's page: a turn at the speed at which the first motion ends, else at 1000 rpm.

    A motion that ends at rest gives its peak speed; where motion or loads repeat only after several turns, these are
    made. A crank that makes no turn follows the first motion, or swings over its range. Motions of the linkage's own
    count by the names of their ``regimes``, after those ``prescribed``; for a crank without a turn, the rest of them
    last. Raises AssemblyError where the linkage cannot be assembled.
    """
    reach = mechanism.crank_range()
    of_file = {
        regime.name: regime.motion for regime in mechanism.linkage.regimes if isinstance(regime, PrescribedRegime)
    }
    motions = (*prescribed, *(motion for name, motion in of_file.items() if name in regimes))
    if not reach.is_full_turn:
        return Case(mechanism, next(iter((*motions, *of_file.values())), None) or range_motion(reach))
    speed = float(motions[0].speed(motions[0].duration)) or motions[0].peak_speed if motions else USUAL_SPEED
    start, duration = (mechanism.cycle if speed < 0.0 else 0.0), mechanism.cycle / abs(speed)
    return Case(mechanism, CrankMotion(STEADY, (Segment(0.0, duration, (start, speed)),)))


def range_motion(reach: CrankRange, speed: float = USUAL_SPEED, *, backwards: bool = False) -> CrankMotion:
    """A swing over a range, short of its limits, at the largest ``speed``, rad/s; from its upper end if ``backwards``.

    A linear drive takes about one second, whatever the speed.
    """
    first, last = inset_ends(reach, backwards=backwards)
    fastest = abs(last - first) if reach.phi.is_linear else speed
    return replace(swing(STEADY, first, last, speed=fastest), regime=OVER_RANGE)


def conditions(case: Case) -> str:
    """The conditions of a case as a sheet states them: mechanism, variant, motion and gravity in words.

    A case with words of its own has these in place of motion and gravity.
    """
    linkage, motion = case.mechanism.linkage, case.motion
    name = f"{linkage.name} ({linkage.variant})"
    if case.conditions:
        return f"{name}: {case.conditions}"
    angle = file_unit("m" if linkage.is_linear else "rad", linkage)
    unit = file_unit("m/s", linkage) if linkage.is_linear else FileUnit("rpm", RPM)
    first, last = (float(motion.angle(np.array([t]))[0]) / angle.size for t in (0.0, motion.duration))
    sign = "" if linkage.is_linear else " clockwise" if last < first else " counter-clockwise"
    most = "" if Instants(motion).is_steady else "up to "
    mark = "°" if angle.name == "deg" else f" {angle.name}"
    speed = f"{most}{motion.peak_speed / unit.size:.6g} {unit.name}{sign}"
    course = f"φ from {first:.6g}{mark} to {last:.6g}{mark}"
    moves = f", {speed}, {course} in {motion.duration:.4g} s" if motion.peak_speed else f", {course}"
    return f"{name}: {motion.regime}{moves}, gravity {'on' if any(linkage.gravity) else 'off'}"


def sheet(case: Case, chosen: Array | None = None, *, every_peak: bool = False) -> Sheet:
    """The sheet of a case, its tables and files at ``chosen`` instants (n,), s, by default over the whole motion.

    With ``every_peak`` there are peaks of signals too that no table has, which takes twice as long. Raises
    LinkproofError where the linkage cannot make the motion.
    """
    case.check_motion()
    curves = Curves(case)
    tabled = [name for name in _signals_besides_bodies(curves) if not name.endswith((":x", ":y"))]
    return _build_sheet(curves, curves.names if every_peak else tabled, chosen)


def _build_sheet(curves: Curves, names: Sequence[str], chosen: Array | None = None) -> Sheet:
    """The sheet of these curves, without facts: peaks of the signals ``names``, SI; what is only rounding is 0.

    Tables are at the ``chosen`` instants (n,), s; by default there are none of chosen instants.
    """
    peaks = curves.peaks(names)
    figures = figure_tables(curves, peaks)
    result = Sheet(
        linkage=curves.linkage,
        facts={},
        conditions=conditions(curves.case),
        axis=curves.instants.axis,
        units={name: curves.unit(name) for name in curves.names},
        values=curves.table(curves.on_grid),
        peaks=peaks,
        figures=figures,
        remarks=tuple(_write_remarks(curves, any(figure.value is None for figure in figures["forces"]))),
        chosen=None if chosen is None else curves.table(curves.truth_at(chosen)),
        positions=positions_over_motion(curves),
        motion=curves.case.motion if isinstance(curves.case.motion, CrankMotion) else None,
        required=required_feed(curves),
        open_end_warning=_open_end_warning(curves, peaks),
    )
    return result.without_rounded_figures()


def _open_end_warning(curves: Curves, peaks: Mapping[str, SignalFigure]) -> str:
    """A sentence on the open ends at which signals have their ``peaks``; "" without any."""
    ends = [
        end for end in curves.open_ends if any(peak.phi is not None and end.has(peak.phi) for peak in peaks.values())
    ]
    return open_end_warning(curves.case.mechanism, ends) if ends else ""


def _signals_besides_bodies(curves: Curves) -> list[str]:
    """Names of all signals except those of points and links, which follow from the positions."""
    return [name for name in curves.names if not name.startswith(("point:", "link:"))]


def _write_remarks(curves: Curves, is_unbounded: bool) -> Iterator[str]:
    """Yield sentences on signs, zeros, gravity and Newton's method, and on what no row can show.

    That is what the file lacks, a thread feed without zero, and, if ``is_unbounded``, joint forces at a change point.
    """
    linkage, mechanism = curves.linkage, curves.case.mechanism
    if "Mkr" in curves.names:
        turning = "along the drive" if linkage.is_linear else "counter-clockwise"
        yield f"Positive is {turning}; a joint's force acts on the link named; directions count from x."
    else:
        yield "No torques and forces: no link has mass, and there are no loads."
    if any(linkage.gravity):
        yield f"Gravity is {np.hypot(*linkage.gravity):.6g} m/s^2 along {_direction(linkage, *linkage.gravity)}."
    if is_unbounded:
        yield "Joint forces have no bound at the change point that the motion passes, so none are given there."
    if mechanism.is_numerical:
        yield "A group without a formula is solved by Newton's method: the figures are a numerical reference."
    if linkage.thread is not None and THREAD_FEED not in curves.names:
        try:
            reference_length(mechanism, linkage.thread)
        except LinkproofError as error:
            yield f"No thread feed: {str(error).removeprefix('thread: ')}."
    if linkage.output is None:
        yield "No S, v and a: the file names no output."
    else:
        x, y = linkage.output.along
        zero = "the farthest point that the motion reaches" if top_of_turn(mechanism) is None else "the top dead centre"
        yield f"S counts from {zero} and is positive along {_direction(linkage, -x, -y)}."


def _direction(linkage: Linkage, x: float, y: float) -> str:
    """The direction of the vector (x, y) as text, in the file's unit of angle, from -180° to 180°: "30°"."""
    unit = file_unit("rad", linkage)
    return f"{np.arctan2(y + 0.0, x + 0.0) / unit.size:.6g}{'°' if unit.name == 'deg' else f' {unit.name}'}"


def usual_sheet(linkage: Linkage, prescribed: Sequence[CrankMotion] = (), regimes: Sequence[str] = ()) -> Sheet:
    """The sheet of a page of a linkage under its usual motion, with those of these regimes that it has.

    ``prescribed`` and ``regimes`` are as for ``usual_case``. A linkage that cannot be computed has a bare sheet.
    """
    try:
        return page_sheet(usual_case(Mechanism(linkage), prescribed, regimes), regimes)
    except LinkproofError as error:
        return bare_sheet(linkage, str(error))


def bare_sheet(linkage: Linkage, reason: str) -> Sheet:
    """The sheet of a linkage that cannot be computed: only its description and the reason, in ``missing["values"]``."""
    return Sheet(linkage, file_facts(linkage), missing={"values": reason})


def page_sheet(case: Case, regimes: Sequence[str] = ()) -> Sheet:
    """The sheet of a case with all that a page shows, at as many instants as its curves need.

    Includes those of the ``regimes`` in which the crank is released. Parts that fail are in ``missing`` with the
    reason. Raises LinkproofError where the linkage cannot make the motion.
    """
    case.check_motion()
    curves, mechanism, linkage = Curves(case), case.mechanism, case.mechanism.linkage
    missing: dict[str, str] = {}
    names = _signals_besides_bodies(curves)
    whole, part = _build_sheet(curves, names), partial(_try_part, missing)
    thin = _thin_signals(curves, names, [whole.peaks[name].time or 0.0 for name in names])
    values = {name: curve if np.any(whole.values[name]) else np.zeros_like(curve) for name, curve in thin.items()}
    chosen = {name: regime for name, regime in linkage.released.items() if name in regimes}
    tried = {
        name: part(f"released.{name}", partial(motion_of_file_regime, mechanism, regime), None)
        for name, regime in chosen.items()
    }
    motions = {name: motion for name, motion in tried.items() if motion is not None}
    releases = {
        n: part(f"released.{n}", partial(describe_release, mechanism, chosen[n], motion), None)
        for n, motion in motions.items()
    }
    return replace(
        whole,
        units={name: whole.units[name] for name in names},
        values=values,
        facts=part("facts", lambda: mechanism_facts(mechanism), file_facts(linkage)),
        shares=_inertia_shares(mechanism, values["phi"]),
        thread=part("thread", lambda: _thread_sheet(mechanism), None),
        published=part("published", lambda: _published_records(linkage), ()),
        released={name: motion for name, motion in releases.items() if motion is not None},
        missing=missing,
    )


def _thin_signals(curves: Curves, names: Sequence[str], peaks: Sequence[float]) -> dict[str, Array]:
    """Signals ``names``, SI, by name, at few instants that show them and their ``peaks``, at these instants, s.

    Where φ is the axis it ascends.
    """
    truth = curves.truth_at(distinct(np.append(curves.grid, peaks)))
    groups = curves.table(truth, names)
    most = min(MOST, MOST_NUMBERS // len(groups))
    few = choose_samples(truth.time, np.array(list(groups.values())), min(FEW, most), most)
    places = distinct(np.append(few, np.searchsorted(truth.time, peaks)))
    if curves.instants.axis == "phi" and groups["phi"][-1] < groups["phi"][0]:
        places = places[::-1]
    return {name: values[places] for name, values in groups.items()}


def _published_records(linkage: Linkage) -> tuple[Mapping[str, Any], ...]:
    """The printed figures beside ours, of every variant of the file, as mappings of a PublishedRecord's fields.

    () without any. Raises LinkproofError where a variant cannot make the motion of one.
    """
    if not linkage.published:
        return ()
    readings = [parse(linkage.text, linkage.name, linkage.name, variant) for variant in linkage.variants]
    return tuple(vars(record) for record in compare_published(readings))


def _inertia_shares(mechanism: Mechanism, angle: Array) -> dict[str, dict[str, Array]]:
    """Shares of Jeq at φ (n,), rad or m, by name, in two mappings, "groups" and "links"; {} where nothing has mass.

    They are in kg m², of a linear drive in kg.
    """
    linkage, sweep = mechanism.linkage, mechanism.sweep(angle)
    if linkage.is_massless:
        return {}
    order = [linkage.crank, *(name for group in mechanism.structure.groups for name in group.links)]
    links = {name: reduced.link_inertia(sweep, name) for name in order if name in linkage.links}
    return {"groups": dict(reduced.group_inertia(sweep)), "links": links}


def _thread_sheet(mechanism: Mechanism) -> ThreadSheet | None:
    """The thread's contour and the paths of its eyes over a turn or the range; None without a thread.

    Raises LinkproofError where the thread has no reference angle, or the linkage cannot be assembled.
    """
    path = mechanism.linkage.thread
    if path is None:
        return None
    angle = reference_angle(mechanism, path)
    sweep = mechanism.sweep(angle)
    turn = mechanism.sweep(positions_over_range(mechanism).axis)
    return ThreadSheet(
        contour=np.array([stop_position(sweep, stop)[:2] for stop in path.stops]),
        stops=tuple(stop.name if isinstance(stop, ThreadGuide) else stop.point for stop in path.stops),
        paths={eye.point: turn.point(eye.point) for eye in path.eyes},
        reference_angle=angle,
    )


def _try_part(missing: dict[str, str], name: str, make: Callable[[], T], fallback: T) -> T:
    """The part of a sheet that ``make`` returns; after a LinkproofError ``fallback``.

    The error's message is then put into ``missing`` under ``name``.
    """
    try:
        return make()
    except LinkproofError as error:
        missing[name] = str(error)
        return fallback


def describe_release(mechanism: Mechanism, regime: ReleasedRegime, motion: FreeMotion) -> Released:
    """The facts and curves of a ``motion`` with released crank, of a regime of the linkage's file.

    The facts are its ``torque``, N m, which besides changes ``over`` the "angle" or the "time", or does not ("");
    ``rests``, the angles, rad, at which it can rest, each with whether it is stable there; the mean reduced
    ``damping``, N m s/rad; the ``error_bound`` of φ, rad, and ``balance`` of energy of the closed form; speeds, rad/s,
    and coefficient of fluctuation of its last whole turn (``ending``) and of the rotation that would repeat itself
    (``settled``), None without a constant torque or such a rotation; φ at the ``end``, rad, within a turn.
    """
    # There may be no whole turn, and no rotation that repeats itself.
    ending = _try_part({}, "", lambda: last_turns(motion), None) if regime.torque else None
    settled = _try_part({}, "", lambda: steady_state(mechanism, regime.torque), None) if regime.torque else None
    facts: dict[str, Any] = {
        "torque": regime.torque,
        "over": "angle" if regime.over_angle is not None else "time" if regime.over_time is not None else "",
        "rests": [{"angle": rest.angle, "stable": bool(rest.stable)} for rest in equilibria(mechanism, regime.torque)],
        "damping": periodic_mean(reduced.damping_coefficient(mechanism.sweep(grid()))),
        "error_bound": finite(motion.error_bound),
        "balance": finite(energy_imbalance(motion)),
        "ending": _rotation_speeds(ending),
        "settled": _rotation_speeds(settled),
        "end": float(in_turn(float(motion.angle(motion.duration)))),
    }
    time = _dense_times(motion)
    curves = np.stack([time, motion.angle(time), motion.speed(time), motion.acceleration(time)])
    shown = curves[:, choose_samples(time, curves[1:], FEW, MOST)]
    return Released(
        facts, dict(zip(("time", "phi", "omega", "epsilon"), shown, strict=True)), _last_turn(motion, ending)
    )


def _rotation_speeds(rotation: Rotation | None) -> dict[str, float] | None:
    """The speeds, rad/s, and the fluctuation of a rotation, by the names of its attributes; None without a rotation."""
    names = ("mean_speed", "mean_speed_over_angle", "fluctuation", "smallest", "largest")
    return None if rotation is None else {name: getattr(rotation, name) for name in names}


def _dense_times(motion: FreeMotion) -> Array:
    """Even instants (n,), s, of a motion, PER_TURN to a turn, but from FEWEST_INSTANTS to MOST_INSTANTS in all."""
    turns = abs(float(motion.angle(motion.duration)) - motion.start[0]) / FULL_TURN
    return np.linspace(0.0, motion.duration, int(np.clip(PER_TURN * turns, FEWEST_INSTANTS, MOST_INSTANTS)))


def _last_turn(motion: FreeMotion, ending: Rotation | None) -> dict[str, Array]:
    """Angle, speed and acceleration over the last whole turn, SI, φ ascending from 0 to 2π; {} without an ``ending``.

    They are (n,) under "phi", "omega" and "epsilon".
    """
    if ending is None:
        return {}
    start = motion.duration - FULL_TURN / abs(ending.mean_speed)
    time = np.linspace(start, motion.duration, LAST_TURN_SAMPLES)[1:]
    angle = motion.angle(time) % FULL_TURN
    order = np.argsort(angle)
    curves = (angle, motion.speed(time), motion.acceleration(time))
    return {name: curve[order] for name, curve in zip(("phi", "omega", "epsilon"), curves, strict=True)}
