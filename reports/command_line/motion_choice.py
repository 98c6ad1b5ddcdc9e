"""The words of the command line that say how the crank moves, shared by every command that moves one."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from analytic.description.crank_motion import LARGEST, LAWS, RAMPS, REGIMES, RPM, CrankMotion, crank_motion, swing
from analytic.description.linkage import Linkage
from analytic.errors import LinkproofError, UnknownNameError

EVERYTHING = "all"
OWN = "own"  # every regime that a linkage defines for itself
TURNING, SWINGING = "run-up", "constant-speed"  # the regime where none is asked for
NUMBERS = {  # options with a number, and what they are called here
    "speed": "speed",
    "ramp-time": "ramp_time",
    "hold-time": "hold_time",
    "start-angle": "start_angle",
    "from": "from_angle",
    "to": "to_angle",
}


@dataclass(frozen=True, kw_only=True)
class MotionChoice:
    """How the crank is to move, in the user's words: names, rpm, seconds and degrees; no regime means the default.

    A negative ``speed`` turns clockwise. With ``from_angle`` and ``to_angle`` the crank swings from one to the other,
    and a regime is the law by which it does. ``gives_speed`` says that the default was asked for by its number.
    """

    variant: str | None = None
    regimes: tuple[str, ...] = ()
    speed: float = 1000.0
    gives_speed: bool = False
    ramp_time: float = 0.6
    hold_time: float = 0.1
    start_angle: float = 0.0
    clockwise: bool = False
    from_angle: float | None = None
    to_angle: float | None = None

    @property
    def swings(self) -> bool:
        """Whether the crank goes from one angle to another."""
        return self.from_angle is not None or self.to_angle is not None

    @property
    def offered(self) -> tuple[str, ...]:
        """Regimes that every linkage can be given under these words."""
        return tuple(LAWS) if self.swings else REGIMES

    @property
    def conditions(self) -> str:
        """Speed, direction, times and angles in words; gravity is the linkages'."""
        turns_back = self.speed < 0.0 or self.clockwise
        if self.from_angle is not None and self.to_angle is not None:
            turns_back = self.to_angle < self.from_angle
        turning = f"{abs(self.speed):g} rpm {'clockwise' if turns_back else 'counter-clockwise'}"
        if self.swings:
            return f"from {self.from_angle:g}° to {self.to_angle:g}°, at most {turning}"
        return f"{turning}, {self.ramp_time:g} s + {self.hold_time:g} s, from {self.start_angle:g}°"

    @property
    def words(self) -> dict[str, Sequence[str]]:
        """The options that ask for the same, with their values; ``--clockwise`` is a flag beside them."""
        return {"variant": [self.variant] if self.variant else [], "regime": self.regimes, **self.numbers}

    @property
    def numbers(self) -> dict[str, Sequence[str]]:
        """Those of the options that have a number, where it is not the default."""
        told: dict[str, Sequence[str]] = {}
        default = MotionChoice()
        for option, name in NUMBERS.items():
            value = getattr(self, name)
            if value != getattr(default, name) or (name == "speed" and self.gives_speed):
                told[option] = [repr(value).removesuffix(".0")]
        return told

    def check(self) -> None:
        """Raise LinkproofError for a motion that cannot be, in the words and the units it is asked for in."""
        if self.speed < 0.0 and self.clockwise:
            raise LinkproofError(
                f"--speed {self.speed:g} turns clockwise already: leave --clockwise out, or give a positive speed"
            )
        if not 1.0 / LARGEST <= abs(self.speed) <= LARGEST / RPM:
            bound = f" up to {LARGEST / RPM:.3g}" if LARGEST < abs(self.speed) < math.inf else ""
            raise LinkproofError(
                f"--speed: expected a finite number of rpm other than 0{bound}, got {self.speed:g}; correct it"
            )
        _check("--start-angle", self.start_angle, "degrees", -LARGEST)
        if self.swings:
            self._check_swing()
        else:
            self._check_turning()

    def _check_turning(self) -> None:
        for name in self.regimes:
            if name in LAWS and name not in REGIMES:
                raise LinkproofError(f"--regime {name} goes from one crank angle to another: add --from and --to")
        ramps = EVERYTHING in self.regimes or not self.regimes or {*self.regimes} & {*RAMPS}
        _check("--ramp-time", self.ramp_time, "s", 1.0 / LARGEST if ramps else 0.0)
        _check("--hold-time", self.hold_time, "s", 0.0)
        if not ramps and "constant-speed" in self.regimes and self.ramp_time + self.hold_time <= 0.0:
            raise LinkproofError("--hold-time: expected a positive number of s without a ramp time, got 0; correct it")

    def _check_swing(self) -> None:
        start, end = self.from_angle, self.to_angle
        if start is None or end is None:
            given, lacking = ("--to", "--from") if start is None else ("--from", "--to")
            raise LinkproofError(f"expected both ends of a swing, got only {given}: add {lacking}")
        _check("--from", start, "degrees", -LARGEST)
        _check("--to", end, "degrees", -LARGEST)
        if start == end:
            raise LinkproofError(f"expected a swing between two crank angles, got {start:g}° twice: correct --to")
        if (self.speed < 0.0 or self.clockwise) and end > start:
            option = "--clockwise" if self.clockwise else f"--speed {self.speed:g}"
            raise LinkproofError(
                f"from {start:g}° to {end:g}° is counter-clockwise, and {option} is not: leave it out, or exchange "
                "--from and --to"
            )
        default = MotionChoice()
        for name in ("start_angle", "ramp_time", "hold_time"):
            if getattr(self, name) != getattr(default, name):
                raise LinkproofError(
                    f"--{name.replace('_', '-')} does not apply to a swing, which --from and --to define: leave it out"
                )
        for name in self.regimes:
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
    offered = choice.offered
    usual = SWINGING if choice.swings else TURNING
    names = offered if EVERYTHING in choice.regimes else choice.regimes or (usual,)
    return tuple(_motion(choice, name) for name in dict.fromkeys(names) if name in offered)


def _motion(choice: MotionChoice, name: str) -> CrankMotion:
    speed = abs(choice.speed) * RPM
    if choice.from_angle is not None and choice.to_angle is not None:
        return swing(name, math.radians(choice.from_angle), math.radians(choice.to_angle), speed=speed)
    return crank_motion(
        name,
        speed=speed,
        ramp_time=choice.ramp_time,
        hold_time=choice.hold_time,
        clockwise=choice.clockwise or choice.speed < 0.0,
        start_angle=math.radians(choice.start_angle),
    )


def own_regimes(choice: MotionChoice, linkages: Sequence[Linkage]) -> tuple[str, ...]:
    """Regimes asked for that the linkages define for themselves; ``own`` and ``all`` ask for every one of them."""
    own = sorted({regime.name for linkage in linkages for regime in linkage.regimes})
    known = [*choice.offered, *own, OWN, EVERYTHING]
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
