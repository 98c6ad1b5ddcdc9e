"""The words of the commands about many designs that say how the driver moves: at constant speed, sampled."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from analytic.description.changes import without
from analytic.description.law import FULL_TURN
from analytic.description.linkage import Linkage
from analytic.errors import LinkproofError
from analytic.kinematics.mechanism import Mechanism
from comparisons.datasheet.building import STEADY, conditions
from comparisons.datasheet.figures import NEGLIGIBLE
from comparisons.designs.steady_motion import SAMPLES, SteadyMotion, steady_motion
from reports.command_line.commands.results import chosen_case
from reports.command_line.motion_choice import MotionChoice


@dataclass(frozen=True, kw_only=True)
class SteadyChoice(MotionChoice):
    """A motion at constant speed, in the user's words, and at how many crank ``angles`` it is looked at.

    With ``refine`` extremes are looked for between them, with ``scale_mass`` masses of designs go with lengths.
    """

    mechanism: str
    angles: int = SAMPLES
    refine: bool = False
    scale_mass: bool = False

    def check(self) -> None:
        """Raise LinkproofError for what cannot be, and for a motion that is not at constant speed."""
        if self.regimes not in ((), (STEADY,)):
            name = ", ".join(self.regimes)
            raise LinkproofError(
                f"--regime {name}: designs are compared at constant speed; leave it out, or see one design under that "
                f"motion by linkproof results --regime {name}"
            )
        super().check()

    @property
    def words(self) -> dict[str, Sequence[str]]:
        """The options that ask for the same, with their values."""
        return {**super().words, "angles": [] if self.angles == SAMPLES else [str(self.angles)]}

    @property
    def flags(self) -> dict[str, bool]:
        """Options without a value, and whether they are set."""
        return {**super().flags, "refine": self.refine, "scale-mass": self.scale_mass}


class SteadyCase(NamedTuple):
    """A mechanism under a motion at constant speed; ``conditions`` are both in words."""

    mechanism: Mechanism
    motion: SteadyMotion
    conditions: str


def steady_case(linkage: Linkage, choice: SteadyChoice) -> SteadyCase:
    """The requested motion, in the case of a linkage: a turn, the range of a driver that makes none, or --from to --to.

    Raises LinkproofError for what cannot be.
    """
    choice.check()
    linkage = replace(linkage, scales_mass=choice.scale_mass)
    mechanism = Mechanism(linkage if choice.gravity else without(linkage, "gravity"))
    case = chosen_case(mechanism, choice)
    case.check_motion()
    first, last = (float(case.motion.angle(np.array([time]))[0]) for time in (0.0, case.motion.duration))
    speed = float(case.motion.speed(np.array([0.0]))[0])
    turns = not (linkage.is_linear or choice.swings) and abs(last - first) >= FULL_TURN * (1.0 - NEGLIGIBLE)
    start, end = (None, None) if turns else (first, last)
    motion = steady_motion(mechanism, speed, samples=choice.angles, start=start, end=end)
    how = f"refined between {choice.angles}" if choice.refine else f"sampled at {choice.angles}"
    places = "places" if linkage.is_linear else "crank angles"
    newton = ", a numerical reference: Newton's method solves a group" if mechanism.is_numerical else ""
    return SteadyCase(mechanism, motion, f"{conditions(case)}, {how} {places}{newton}")
