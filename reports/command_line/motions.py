"""The motions that a user asks for, made of the words of ``MotionChoice``, and what cannot be among them."""

from __future__ import annotations

import math
from collections.abc import Sequence

from analytic.description.crank_motion import LARGEST, LAWS, RAMPS, REGIMES, RPM, CrankMotion, crank_motion, swing
from analytic.description.linkage import Linkage
from analytic.errors import LinkproofError, UnknownNameError
from reports.command_line.motion_choice import TIMED, MotionChoice

EVERYTHING = "all"
OWN = "own"  # every regime that a linkage defines for itself
TURNING, SWINGING = "run-up", "constant-speed"  # the regime where none is asked for


def offered(choice: MotionChoice) -> tuple[str, ...]:
    """Regimes that every linkage can be given under these words."""
    return tuple(LAWS) if choice.swings else REGIMES


def check_motion(choice: MotionChoice) -> None:
    """Raise LinkproofError for a motion that cannot be, in the words and the units it is asked for in."""
    if choice.rpm < 0.0 and choice.clockwise:
        raise LinkproofError(
            f"--speed {choice.rpm:g} turns clockwise already: leave --clockwise out, or give a positive speed"
        )
    if not 1.0 / LARGEST <= abs(choice.rpm) <= LARGEST / RPM:
        bound = f" up to {LARGEST / RPM:.3g}" if LARGEST < abs(choice.rpm) < math.inf else ""
        raise LinkproofError(
            f"--speed: expected a finite number of rpm other than 0{bound}, got {choice.rpm:g}; correct it"
        )
    _check("--start-angle", choice.start_angle, "degrees", -LARGEST)
    if choice.swings:
        _check_swing(choice)
    else:
        _check_turning(choice)


def _check_turning(choice: MotionChoice) -> None:
    for name in choice.regimes:
        if name in LAWS and name not in REGIMES:
            raise LinkproofError(f"--regime {name} goes from one crank angle to another: add --from and --to")
    ramps = EVERYTHING in choice.regimes or not choice.regimes or {*choice.regimes} & {*RAMPS}
    _check("--ramp-time", choice.ramp_time, "s", 1.0 / LARGEST if ramps else 0.0)
    _check("--hold-time", choice.hold_time, "s", 0.0)
    if not ramps and "constant-speed" in choice.regimes and choice.ramp_time + choice.hold_time <= 0.0:
        raise LinkproofError("--hold-time: expected a positive number of s without a ramp time, got 0; correct it")


def _check_swing(choice: MotionChoice) -> None:
    start, end = choice.from_angle, choice.to_angle
    if start is None or end is None:
        given, lacking = ("--to", "--from") if start is None else ("--from", "--to")
        raise LinkproofError(f"expected both ends of a swing, got only {given}: add {lacking}")
    _check("--from", start, "degrees", -LARGEST)
    _check("--to", end, "degrees", -LARGEST)
    if start == end:
        raise LinkproofError(f"expected a swing between two crank angles, got {start:g}° twice: correct --to")
    if choice.turns_back and end > start:
        option = "--clockwise" if choice.clockwise else f"--speed {choice.rpm:g}"
        raise LinkproofError(
            f"from {start:g}° to {end:g}° is counter-clockwise, and {option} is not: leave it out, or exchange "
            "--from and --to"
        )
    default = MotionChoice()
    for name in TIMED[::-1]:
        if getattr(choice, name) != getattr(default, name):
            raise LinkproofError(
                f"--{name.replace('_', '-')} does not apply to a swing, which --from and --to define: leave it out"
            )
    for name in choice.regimes:
        if name in RAMPS:
            raise LinkproofError(
                f"--regime {name} does not end at an angle, so it cannot take --to: choose "
                f"{', '.join(LAWS)}, or leave --from and --to out"
            )


def _check(option: str, value: float, unit: str, least: float) -> None:
    if not least <= value <= LARGEST:  # written so that nan fails too
        kind = "positive finite" if least > 0.0 else "finite" if least else "finite, not negative"
        raise LinkproofError(f"{option}: expected a {kind} number of {unit}, got {value:g}; correct it")


def motions(choice: MotionChoice) -> tuple[CrankMotion, ...]:
    """The prescribed crank motions asked for, without those of the linkages' own."""
    known = offered(choice)
    usual = SWINGING if choice.swings else TURNING
    names = known if EVERYTHING in choice.regimes else choice.regimes or (usual,)
    return tuple(_motion(choice, name) for name in dict.fromkeys(names) if name in known)


def _motion(choice: MotionChoice, name: str) -> CrankMotion:
    speed = abs(choice.rpm) * RPM
    if choice.from_angle is not None and choice.to_angle is not None:
        return swing(name, math.radians(choice.from_angle), math.radians(choice.to_angle), speed=speed)
    return crank_motion(
        name,
        speed=speed,
        ramp_time=choice.ramp_time,
        hold_time=choice.hold_time,
        clockwise=choice.turns_back,
        start_angle=math.radians(choice.start_angle),
    )


def own_regimes(choice: MotionChoice, linkages: Sequence[Linkage]) -> tuple[str, ...]:
    """Regimes asked for that the linkages define for themselves; ``own`` and ``all`` ask for every one of them."""
    own = sorted({regime.name for linkage in linkages for regime in linkage.regimes})
    known = [*offered(choice), *own, OWN, EVERYTHING]
    for name in choice.regimes:
        if name not in known:
            raise UnknownNameError("regime", name, known)
        if choice.swings and name in (*own, OWN):
            raise LinkproofError(
                f"--regime {name} is defined in its file, and --from and --to define another motion: leave one out"
            )
    if {OWN, EVERYTHING} & set(choice.regimes):
        return tuple(own)
    return tuple(name for name in own if name in choice.regimes)
