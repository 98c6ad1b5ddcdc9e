"""The motions of ``Motion``: prescribed ones and the regimes of a linkage; refusals of impossible ones.

A campaign takes ``requested_motions``; a command about one motion takes ``named_case``, ``requested_case`` or, with the
instants of a table, ``requested_results``.

Of a drive along a line ``--from``, ``--to`` and ``--speed`` are in the file's unit of length; without a speed its
motion has the mean speed of one second, without ends it goes over the range of the drive.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from analytic.description.crank_motion import (
    LARGEST,
    LAWS,
    RAMPS,
    REGIMES,
    RPM,
    CrankMotion,
    Segment,
    Standstill,
    crank_motion,
    swing,
)
from analytic.description.linkage import Linkage
from analytic.description.units import factor
from analytic.errors import LinkproofError, UnknownNameError
from analytic.kinematics.mechanism import Mechanism
from comparisons.designer.building import STEADY, range_motion
from comparisons.designer.curves import Instants
from comparisons.designer.open_ends import inset_ends
from comparisons.motion.case import Case, case_of_file_regime
from reports.api.options import TIMED, Numbers
from reports.api.options import Motion as Asked

EVERYTHING = "all"
OWN = "own"  # every regime that a linkage defines for itself
TURNING, SWINGING = "run-up", STEADY  # the regime where none is named


def requested_motions(
    options: Asked, linkages: Sequence[Linkage]
) -> tuple[tuple[CrankMotion, ...], str, tuple[str, ...]]:
    """Prescribed motions of a campaign, their conditions in words, and names of regimes of the linkages' own.

    Raises LinkproofError for motions that are impossible or unknown.
    """
    check_motion(options)
    return (*_prescribed_motions(options, linkages), _own_regimes(options, linkages))


def requested_case(options: Asked, mechanism: Mechanism) -> Case:
    """The linkage under the one requested motion: by default a turn at constant speed, or the range of the crank.

    At speed 0 it stands still at those places. Raises LinkproofError for a motion that is impossible or unknown, and
    for several.
    """
    if options.speed == 0.0:
        moving = requested_case(replace(options, speed=math.copysign(1.0, options.speed)), mechanism)
        if not isinstance(moving.motion, CrankMotion):
            raise LinkproofError("--speed 0 holds the crank, and the regime releases it: leave one of the two out")
        return replace(moving, motion=Standstill("at rest", moving.motion.segments))
    case = named_case(options, mechanism)
    has_length = options.swings or options.is_timed or _own_regimes(options, [mechanism.linkage])
    if case is None or (tuple(options.regime) == (STEADY,) and not has_length):
        return _default_case(options, mechanism)
    return replace(case, mechanism=mechanism)  # a torque over the angle is the drive's, not a load


def requested_results(
    linkage: Linkage, options: Asked, at: Numbers | None = None, time: Numbers | None = None
) -> tuple[Case, NDArray[np.float64] | None]:
    """The motion of a request, as a case, and the instants (n,), s, of its tables; None for the whole motion.

    They are the first passages of ``at``, degrees or the file's unit of travel, or at a ``time``, s. Raises
    LinkproofError for impossible ones and for both.
    """
    if at is not None and time is not None:
        raise LinkproofError("--at and --time both choose the instants of the table: leave one of the two out")
    case = requested_case(options, Mechanism(linkage))
    linkage, instants = case.mechanism.linkage, Instants(case.motion, turns=not case.mechanism.linkage.is_linear)
    if at is not None:
        return case, instants.times_of_angles(np.array(at), linkage.phi.mark, linkage.phi.unit.size)
    return case, None if time is None else instants.checked_times(np.array(time))


def named_case(options: Asked, mechanism: Mechanism) -> Case | None:
    """The case of the one motion that the options name; None if they name none.

    A released motion is integrated. Raises LinkproofError for several, and for one that is impossible or unknown.
    """
    check_motion(options)
    linkage = mechanism.linkage
    regimes = _own_regimes(options, [linkage])
    if len(options.regime) > 1 or {EVERYTHING, OWN} & {*options.regime}:
        raise LinkproofError(f"expected one motion, got --regime {', '.join(options.regime)}: choose one of them")
    if regimes:
        return case_of_file_regime(mechanism, next(regime for regime in linkage.regimes if regime.name in regimes))
    if options.regime or options.swings:
        ((motion,), _) = _prescribed_motions(options, [linkage])
        return Case(mechanism, motion)
    if options.is_timed:
        raise LinkproofError(
            "--ramp-time and --hold-time apply only to a motion over time: add --regime run-up, or leave them out"
        )
    return None


def _default_case(options: Asked, mechanism: Mechanism) -> Case:
    """The case at constant speed over a turn or, if the driver makes none, over its range, short of the limits.

    A turn is one period of the loads, which may be several turns.
    """
    if mechanism.linkage.is_linear:
        ((motion,), _) = _prescribed_motions(options, [mechanism.linkage])
        return Case(mechanism, motion)
    start = math.radians(options.start_angle)
    speed, backwards = abs(options.rpm) * RPM, options.turns_back
    reach = mechanism.crank_range(start if options.start_angle else None)
    if reach.is_full_turn:
        motion = CrankMotion(
            STEADY, (Segment(0.0, mechanism.linkage.load_period / speed, (start, -speed if backwards else speed)),)
        )
        return Case(mechanism, motion)
    return Case(mechanism, range_motion(reach, speed, backwards=backwards))


def offered_regimes(options: Asked) -> tuple[str, ...]:
    """Names of the regimes, of a swing or of a crank that turns on, that these options allow for every linkage."""
    return tuple(LAWS) if options.swings else REGIMES


def check_motion(options: Asked) -> None:
    """Raise LinkproofError for an impossible motion, in the words and the units of its options.

    Names of unknown regimes pass.
    """
    if not 1.0 / LARGEST <= abs(options.rpm) <= LARGEST / RPM:
        bound = f" up to {LARGEST / RPM:.3g}" if LARGEST < abs(options.rpm) < math.inf else ""
        raise LinkproofError(
            f"--speed: expected a finite number of rpm other than 0{bound}, got {options.rpm:g}; correct it"
        )
    _check_number("--start-angle", options.start_angle, "degrees", -LARGEST)
    if options.swings:
        _check_swing(options)
    else:
        _check_turning(options)


def _check_turning(options: Asked) -> None:
    """Raise LinkproofError for options that make no motion of a crank that turns on.

    These are a regime that only a swing has, a time that is negative or not finite, no ramp time for a run-up, and no
    time at all at constant speed.
    """
    for name in options.regime:
        if name in LAWS and name not in REGIMES:
            raise LinkproofError(f"--regime {name} goes from one crank angle to another: add --from and --to")
    ramps = EVERYTHING in options.regime or not options.regime or {*options.regime} & {*RAMPS}
    _check_number("--ramp-time", options.ramp_time, "s", 1.0 / LARGEST if ramps else 0.0)
    _check_number("--hold-time", options.hold_time, "s", 0.0)
    if not ramps and "constant-speed" in options.regime and options.ramp_time + options.hold_time <= 0.0:
        raise LinkproofError("--hold-time: expected a positive number of s without a ramp time, got 0; correct it")


def _check_swing(options: Asked) -> None:
    """Raise LinkproofError for options that make no motion from one angle to another.

    These are one end alone, an end that is not finite, equal ends, a negative speed towards a larger angle, times, a
    start angle, and a run-up.
    """
    start, end = options.from_angle, options.to_angle
    if start is None or end is None:
        given, lacking = ("--to", "--from") if start is None else ("--from", "--to")
        raise LinkproofError(f"expected both ends of a swing, got only {given}: add {lacking}")
    _check_number("--from", start, "degrees", -LARGEST)
    _check_number("--to", end, "degrees", -LARGEST)
    if start == end:
        raise LinkproofError(f"expected a swing between two crank angles, got {start:g}° twice: correct --to")
    if options.turns_back and end > start:
        raise LinkproofError(
            f"from {start:g}° to {end:g}° is counter-clockwise, and --speed {options.rpm:g} is not: leave out its "
            "sign, or exchange --from and --to"
        )
    default = Asked()
    for name in TIMED[::-1]:
        if getattr(options, name) != getattr(default, name):
            raise LinkproofError(
                f"--{name.replace('_', '-')} does not apply to a swing, which --from and --to define: leave it out"
            )
    for name in options.regime:
        if name in RAMPS:
            raise LinkproofError(
                f"--regime {name} does not end at an angle, so it cannot take --to: choose "
                f"{', '.join(LAWS)}, or leave --from and --to out"
            )


def _check_number(option: str, value: float, unit: str, least: float) -> None:
    """Raise LinkproofError for an option's value that is not finite, beyond all bounds or below ``least``.

    ``option``, such as "--from", and ``unit`` are for the message.
    """
    if not least <= value <= LARGEST:  # written so that nan fails too
        kind = "positive finite" if least > 0.0 else "finite" if least else "finite, not negative"
        raise LinkproofError(f"{option}: expected a {kind} number of {unit}, got {value:g}; correct it")


def _motions(options: Asked) -> tuple[CrankMotion, ...]:
    """The requested prescribed motions of a crank, without regimes that the linkages define; () without any.

    By default a run-up, or of a swing one at constant speed.
    """
    known, speed = offered_regimes(options), abs(options.rpm) * RPM
    usual = SWINGING if options.swings else TURNING
    asked = known if EVERYTHING in options.regime else options.regime or (usual,)
    names = [name for name in dict.fromkeys(asked) if name in known]
    if options.from_angle is not None and options.to_angle is not None:
        start, end = math.radians(options.from_angle), math.radians(options.to_angle)
        return tuple(swing(name, start, end, speed=speed) for name in names)
    times = {"ramp_time": options.ramp_time, "hold_time": options.hold_time}
    start = math.radians(options.start_angle)
    return tuple(
        crank_motion(name, speed=speed, clockwise=options.turns_back, start_angle=start, **times) for name in names
    )


def _prescribed_motions(options: Asked, linkages: Sequence[Linkage]) -> tuple[tuple[CrankMotion, ...], str]:
    """The requested prescribed motions, without regimes that linkages define, and their conditions in words.

    Raises LinkproofError for a motion that does not suit a linear drive, or if one of several linkages has such a
    drive.
    """
    linear = [linkage for linkage in linkages if linkage.is_linear]
    if not linear:
        return _motions(options), options.conditions
    linkage = linear[0]
    if len(linkages) > 1:
        raise LinkproofError(
            f"'{linkage.name}' is driven along a line and cannot share a motion with other linkages: run it separately"
        )
    regimes = {regime.name for regime in linkage.regimes}
    for name in options.regime:
        if name in offered_regimes(options) and name not in LAWS and name not in regimes:
            raise LinkproofError(
                f"--regime {name} turns a crank, but '{linkage.name}' is driven along a line: choose one of "
                f"{', '.join(LAWS)} with --from and --to"
            )
    if options.start_angle:
        raise LinkproofError(
            f"--start-angle turns a crank, but '{linkage.name}' is driven along a line: give --from and --to"
        )
    names = LAWS if EVERYTHING in options.regime else options.regime or (SWINGING,)
    unit = linkage.units.get("length", "m")
    (first, last), size = _ends(options, linkage), factor("length", unit)
    speed = abs(last - first) if options.speed is None else abs(options.speed) * size
    motions = tuple(swing(name, first, last, speed=speed) for name in dict.fromkeys(names) if name in LAWS)
    return motions, f"from {linkage.written(first)} to {linkage.written(last)}, at most {speed / size:.4g} {unit}/s"


def _ends(options: Asked, linkage: Linkage) -> tuple[float, float]:
    """Travels, m, at which a linear drive's motion begins and ends: those of --from and --to.

    By default those of its range, short of its limits, the last first if it moves backwards.
    """
    if options.from_angle is not None and options.to_angle is not None:
        size = factor("length", linkage.units.get("length", "m"))
        return options.from_angle * size, options.to_angle * size
    return inset_ends(Mechanism(linkage).crank_range(), backwards=options.turns_back)


def _own_regimes(options: Asked, linkages: Sequence[Linkage]) -> tuple[str, ...]:
    """Names of the requested regimes that linkages define themselves, sorted; "own" and "all" request all of them.

    Raises UnknownNameError for an unknown regime, LinkproofError for one together with a swing.
    """
    regimes = sorted({regime.name for linkage in linkages for regime in linkage.regimes})
    known = [*offered_regimes(options), *regimes, OWN, EVERYTHING]
    for name in options.regime:
        if name not in known:
            raise UnknownNameError("regime", name, known)
        if options.swings and name in (*regimes, OWN):
            raise LinkproofError(
                f"--regime {name} is defined in its file, and --from and --to define another motion: leave one out"
            )
    if {OWN, EVERYTHING} & set(options.regime):
        return tuple(regimes)
    return tuple(name for name in regimes if name in options.regime)
