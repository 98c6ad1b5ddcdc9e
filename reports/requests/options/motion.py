"""The motion of the crank: options of every command that moves a linkage."""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import Annotated

from reports.requests.options.declaring import Option

USUAL_SPEED = 1000.0  # rpm
TIMED = ("ramp_time", "hold_time", "start_angle")  # of a crank that turns on: no swing has them

Variant = Annotated[str | None, Option("Variant of the file; default: its own values.", "NAME", names="variants")]


@dataclass(frozen=True, kw_only=True)
class MotionOptions:
    """The requested motion of the crank: names, rpm, seconds and degrees; without a regime the default.

    A negative ``speed`` turns clockwise; None is ``USUAL_SPEED``, of a drive along a line its mean. With ``from_angle``
    and ``to_angle`` the crank swings from one to the other, and the regime is the law of motion. Of a drive along
    a line ``speed``, ``from_angle`` and ``to_angle`` are in its file's unit of length.
    """

    variant: Variant = None
    regime: Annotated[
        tuple[str, ...],
        Option(
            "Motion of the crank: run-up, run-up-cubic, run-up-quintic, constant-speed, a regime of the file, own "
            "(all of these), or all; with --from and --to: constant-speed, cubic, polynomial, cycloidal, "
            "modified-sine, or all; repeatable; default: run-up (bench: run-up-quintic and run-up; results: one "
            "turn at constant speed), with --from and --to constant-speed.",
            "NAME",
            names="regimes",
        ),
    ] = ()
    speed: Annotated[
        float | None,
        Option("Final crank speed, or the largest of a swing; negative turns clockwise; default: 1000.", "RPM"),
    ] = None
    ramp_time: Annotated[float, Option("Time to reach this speed.", "SECONDS")] = 0.6
    hold_time: Annotated[float, Option("Time at this speed.", "SECONDS")] = 0.1
    start_angle: Annotated[float, Option("Crank angle at the start.", "DEGREES")] = 0.0
    from_angle: Annotated[float | None, Option("Crank angle at the start of a swing.", "DEGREES", ("--from",))] = None
    to_angle: Annotated[float | None, Option("Crank angle at the end of a swing.", "DEGREES", ("--to",))] = None
    clockwise: Annotated[bool, Option("Turn the crank clockwise.")] = False
    gravity: Annotated[bool, Option("Switch gravity off.", flags=("--no-gravity",))] = True

    @property
    def motion(self) -> MotionOptions:
        """The options of the motion alone."""
        return MotionOptions(**{field.name: getattr(self, field.name) for field in fields(MotionOptions)})

    @property
    def rpm(self) -> float:
        """The speed, rpm, negative if clockwise."""
        return USUAL_SPEED if self.speed is None else self.speed

    @property
    def turns_back(self) -> bool:
        """Whether the crank turns clockwise."""
        return self.clockwise or self.rpm < 0.0

    @property
    def swings(self) -> bool:
        """Whether the crank goes from one angle to another."""
        return self.from_angle is not None or self.to_angle is not None

    @property
    def conditions(self) -> str:
        """Speed, direction, times and angles in words, without gravity, which belongs to the linkages."""
        turns_back = self.turns_back
        if self.from_angle is not None and self.to_angle is not None:
            turns_back = self.to_angle < self.from_angle
        turning = f"{abs(self.rpm):g} rpm {'clockwise' if turns_back else 'counter-clockwise'}"
        if self.swings:
            return f"from {self.from_angle:g}° to {self.to_angle:g}°, at most {turning}"
        return f"{turning}, {self.ramp_time:g} s + {self.hold_time:g} s, from {self.start_angle:g}°"
