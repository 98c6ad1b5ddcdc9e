"""The motion of the crank: options of every command that moves a linkage."""

from __future__ import annotations

from dataclasses import dataclass, fields
from pathlib import Path
from typing import Annotated

from reports.requests.options import Argument, Option

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


# The options of the commands about one linkage under one motion: results and judge.

DEFAULT_LIMIT = 0.01  # of the peak


@dataclass(frozen=True, kw_only=True)
class ResultsOptions(MotionOptions):
    """The motion and the instants of ``linkproof results``."""

    mechanism: Annotated[str, Argument("MECHANISM", "mechanisms", is_required=True)] = ""
    at: Annotated[tuple[float, ...] | None, Option("Every signal at these crank angles: 0,30,60.", "DEGREES")] = None
    time: Annotated[tuple[float, ...] | None, Option("Every signal at these times: 0.1,0.2.", "SECONDS")] = None


@dataclass(frozen=True, kw_only=True)
class WatchOptions(ResultsOptions):
    """The motion of ``linkproof watch``, and whether it ``opens`` a browser."""

    opens: Annotated[bool, Option("Open no browser, only print the address.", flags=("--no-open",))] = True


@dataclass(frozen=True, kw_only=True)
class ResultsFiles:
    """The form of the files of ``linkproof results``.

    ``decimal`` is the point or comma in the numbers of a CSV file, ``figure`` the single picture to draw instead of
    all.
    """

    decimal: Annotated[str, Option("Decimal mark of a .csv; with a comma, semicolons between columns.", ".|,")] = "."
    figure: Annotated[
        str | None,
        Option(
            "Draw one figure alone, as wide as a paper's column: scheme, curves, torque, power, energy, inertia, "
            "output, forces, transmission.",
            "NAME",
        ),
    ] = None


@dataclass(frozen=True, kw_only=True)
class JudgeOptions(MotionOptions):
    """The results for ``linkproof judge``; ``limit`` is a share of the peak."""

    mechanism: Annotated[str, Argument("MECHANISM", "mechanisms", is_required=True)] = ""
    results: Annotated[tuple[Path, ...], Argument("RESULTS", is_required=True)] = ()
    mapping: Annotated[Path | None, Option("The meaning of each column, and accepted corrections.", "FILE")] = None
    limit: Annotated[float, Option("Largest error allowed, as a share of the closed form's peak.", "SHARE")] = (
        DEFAULT_LIMIT
    )
