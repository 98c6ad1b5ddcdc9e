"""The words of the command line that say how the crank moves, defined once for every command that moves one.

Only typer is imported here, so that help comes at once.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields
from typing import Annotated, Any

from reports.command_line import completion
from reports.command_line.options import Variant, flag, stated, valued

USUAL_SPEED = 1000.0  # rpm
TIMED = ("ramp_time", "hold_time", "start_angle")  # of a crank that turns on: no swing has them


@dataclass(frozen=True, kw_only=True)
class MotionChoice:
    """How the crank is to move, in the user's words: names, rpm, seconds and degrees; no regime means the default.

    A negative ``speed`` turns clockwise; None is ``USUAL_SPEED``, of a drive along a line its mean. With ``from_angle``
    and ``to_angle`` the crank swings from one to the other, and a regime is the law by which it does.
    """

    variant: Variant = None
    regimes: Annotated[
        tuple[str, ...],
        valued(
            "NAME",
            "Motion of the crank: run-up, run-up-cubic, run-up-quintic, constant-speed, a regime of the file, own "
            "(all of these), or all; with --from and --to: constant-speed, cubic, polynomial, cycloidal, "
            "modified-sine, or all; repeatable; default: run-up (bench: run-up-quintic and run-up; results: one "
            "turn at constant speed), with --from and --to constant-speed.",
            "--regime",
            names=completion.regimes,
        ),
    ] = ()
    speed: Annotated[
        float | None,
        valued(
            "RPM", "Final crank speed, or the largest of a swing; negative turns clockwise; default: 1000.", "--speed"
        ),
    ] = None
    ramp_time: Annotated[float, valued("SECONDS", "Time to reach this speed.")] = 0.6
    hold_time: Annotated[float, valued("SECONDS", "Time at this speed.")] = 0.1
    start_angle: Annotated[float, valued("DEGREES", "Crank angle at the start.")] = 0.0
    from_angle: Annotated[float | None, valued("DEGREES", "Crank angle at the start of a swing.", "--from")] = None
    to_angle: Annotated[float | None, valued("DEGREES", "Crank angle at the end of a swing.", "--to")] = None
    clockwise: Annotated[bool, flag("Turn the crank clockwise.", "--clockwise")] = False
    gravity: Annotated[bool, flag("Switch gravity off.", "--no-gravity")] = True

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
        """Speed, direction, times and angles in words; gravity is the linkages'."""
        turns_back = self.turns_back
        if self.from_angle is not None and self.to_angle is not None:
            turns_back = self.to_angle < self.from_angle
        turning = f"{abs(self.rpm):g} rpm {'clockwise' if turns_back else 'counter-clockwise'}"
        if self.swings:
            return f"from {self.from_angle:g}° to {self.to_angle:g}°, at most {turning}"
        return f"{turning}, {self.ramp_time:g} s + {self.hold_time:g} s, from {self.start_angle:g}°"

    @property
    def motion_options(self) -> dict[str, Any]:
        """The fields of the motion by name, to pass on."""
        return {one.name: getattr(self, one.name) for one in fields(MotionChoice)}

    @property
    def of_written_file(self) -> dict[str, Any]:
        """The same for a file that a command has written, which has one variant."""
        return {**self.motion_options, "variant": None}

    @property
    def words(self) -> dict[str, Sequence[str]]:
        """The options that ask for the same, with their values; ``flags`` stand beside them."""
        return {option: given for option, given in stated(self).items() if given}

    @property
    def flags(self) -> dict[str, bool]:
        """Options without a value, and whether they are set."""
        return {option: True for option, given in stated(self).items() if not given}

    def check(self) -> None:
        """Raise LinkproofError for a motion that cannot be, in the words and the units it is asked for in."""
        from reports.command_line.motions import check_motion

        check_motion(self)
