"""exudyn behind the contract: constrained planar bodies, one generalised-α run or trapezoidal runs extrapolated.

J. Gerstmayr, "Exudyn - a C++-based Python package for flexible multibody systems", Multibody System Dynamics 60 (2024).

- ``naive``: a Python function for the drive, exudyn's defaults at 1 ms.
- ``tuned``: one run of generalised α with its constraints on position level: joints stay closed over any number of
  turns, and a linkage passes its change points.
- ``best``: the trapezoidal rule with its constraints on velocity level, extrapolated to eighth order: its multipliers
  are free of the rounding that the square of the step magnifies on position level.

The parts of a prescribed motion start anew (``engines.exudyn_adapter.loop``). The recipes below have the settings'
numbers and the methods that can be studied.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any, ClassVar

from analytic.description.linkage import DriverKind
from engines.contract import Abilities, History, ReadOut, Setting
from engines.exudyn_adapter.model import COORDINATES, ExudynModel
from engines.scene import GUIDES, LOADS, Channel, Free, Prescribed, Scene
from engines.stepping import stepped_engine
from engines.stepping.loop_engine import LoopEngine
from engines.stepping.stepped_engine import Course

# Recipes for exudyn: its rules for a time step, the settings, and the methods that can be studied.


EFFORT_UNIT = "relative tolerance"
ODD_RATIOS = (1, 3, 5, 7)  # steps to a sample that keep the sign of what alternates from step to step


@dataclass(frozen=True, kw_only=True)
class ExudynRecipe(stepped_engine.Recipe):
    """One of exudyn's rules for a time step.

    ``damping`` is the spectral radius at infinite frequency of the generalised α rule, whose constraints are on
    position level. None is the trapezoidal rule on velocity level: on position level nothing damps its multipliers;
    a rule ``as_shipped`` leaves every setting of exudyn's alone. ``effort`` is the tolerance of Newton's corrections,
    absolute and relative. ``adaptive`` lets exudyn halve a step in which they do not die out.
    """

    damping: float | None = None
    as_shipped: bool = False
    adaptive: bool = False

    def details(self) -> dict[str, str | int | float]:
        """The rule in words, for the record of a run."""
        rule = f"generalised α, spectral radius {self.damping:g}" if self.damping else "implicit trapezoidal rule"
        table: dict[str, str | int | float] = {
            "integrator": rule,
            "constraints": f"on {'position' if self.damping else 'velocity'} level",
            "newton": "as shipped" if self.as_shipped else "modified, Jacobian updated every step",
        }
        if self.effort is not None:
            table["tolerance"] = self.effort
        return table

    def solver_settings(self) -> dict[str, Any]:
        """The rule as exudyn's settings, by their dotted names."""
        newton, alpha = "timeIntegration.newton", "timeIntegration.generalizedAlpha"
        table: dict[str, Any] = {"solution.file.write": False}
        if self.effort is not None:
            table |= {f"{newton}.{kind}Tolerance": self.effort for kind in ("relative", "absolute")}
        if self.as_shipped:
            return table
        if self.damping is not None:
            table[f"{alpha}.spectralRadius"] = self.damping
        return table | {
            "linearSolver.solverType": "EigenDense",
            "timeIntegration.adaptiveStep": self.adaptive,
            f"{alpha}.useNewmark": self.damping is None,
            f"{alpha}.useIndex2Constraints": self.damping is None,
            f"{alpha}.computeInitialAccelerations": False,  # exudyn leaves out the drive's own
            # Residuals hold the multipliers, which nothing fixes at a change point; the motion's corrections die out.
            f"{newton}.residualMode": 1,
            f"{newton}.useModifiedNewton": True,
            f"{newton}.modifiedNewtonJacUpdatePerStep": True,
        }


# The static solver's, which finds the start of a part: corrections are judged, not loads. The square of a correction,
# which is the next one, is rounding.
STATIC_SETTINGS = {
    "solution.file.write": False,
    "solution.sensors.active": False,
    "linearSolver.solverType": "EigenDense",
    "staticSolver.useLoadFactor": False,
    "staticSolver.newton.residualMode": 1,
    "staticSolver.newton.relativeTolerance": 1e-9,
    "staticSolver.newton.absoluteTolerance": 1e-9,
}

# Generalised α (J. Chung, G. M. Hulbert, ASME Journal of Applied Mechanics 60, 1993); exudyn has it on position level
# only. Its auxiliary accelerations start as the true ones, which leaves the multipliers first order behind every start;
# a spectral radius of 0.6, not exudyn's 0.9, forgets it within 20 steps.
ALPHA = ExudynRecipe(damping=0.6, effort=1e-10)
# Second order in the multipliers too. But these and the accelerations carry an undamped part that changes sign from
# step to step, as large as whatever does not fit at the start: 9.5 % of the peak torque for ever after a linear ramp's
# kink if nothing is done. What fresh starts leave of it goes in the extrapolation, all steps being odd fractions of the
# longest. Positions drift off the joints, by a hundred-thousandth of a link in every turn of 500 steps: 1.7 turns keep
# that below the rule's own error, and being no whole or half number bring the starts upon ever other positions.
TRAPEZOIDAL = ExudynRecipe(effort=1e-10, turns=1.7)
NAIVE = replace(ALPHA, damping=0.9, effort=None, as_shipped=True, step=1e-3, restarted=False, in_own_units=False)

# Largest errors of one run over the quintic run-up of the catalogue's five mechanisms, by steps a turn:
#     steps    Mkr     Jeq     v       a       joint force   s a run
#     1000     1.7e-3  3.4e-5  1.9e-5  6.2e-4  1.5e-3        0.1-0.2
#     2000     3.0e-5  8.6e-6  4.8e-6  2.2e-5  2.7e-5        0.2-0.4
#     4000     7.4e-6  2.1e-6  1.2e-6  5.5e-6  6.8e-6        0.3-0.7
#     8000     4.4e-6  5.4e-7  3.0e-7  1.4e-6  1.7e-6        0.5-1.3
# Made-up linkages are up to seven times sharper.
TUNED = replace(
    ALPHA,
    effort=1e-8,
    adaptive=True,
    steps_per_turn=100,
    ratios=(40,),
    graded=True,
    turns=10,
    least_steps=100,
)
BEST = replace(TRAPEZOIDAL, effort=1e-12, steps_per_turn=150, ratios=ODD_RATIOS, least_steps=100)
SETTINGS: Mapping[type, Mapping[Setting, ExudynRecipe]] = {
    Prescribed: {Setting.NAIVE: NAIVE, Setting.TUNED: TUNED, Setting.BEST: BEST},
    # A free crank adds its phase error up over all turns: 160 in 10 s of the slotted take-up, where 1600 steps a turn
    # leave 2e-7 of the angle and 7e-4 of the acceleration.
    Free: {
        Setting.NAIVE: NAIVE,
        Setting.TUNED: replace(TUNED, ratios=(16,)),
        Setting.BEST: replace(BEST, steps_per_turn=100),
    },
}


def _extrapolated_method(count: int) -> tuple[str, ExudynRecipe]:
    """What a method of ``count`` extrapolated runs is, in a sentence, and its recipe."""
    parts = ", 1/".join(map(str, ODD_RATIOS[:count]))
    about = f"the same at 1/{parts} of the step, extrapolated to order {2 * count}"
    return about, replace(TRAPEZOIDAL, ratios=ODD_RATIOS[:count], effort=1e-12)


STUDIED: Mapping[str, tuple[str, ExudynRecipe]] = {
    "defaults": ("the drive a Python function, exudyn's settings as shipped", NAIVE),
    "generalised alpha": (
        "generalised α (index 3) with a spectral radius of 0.6, from consistent accelerations, restarted at jumps",
        ALPHA,
    ),
    "trapezoidal": (
        "the implicit trapezoidal rule, constraints on velocity level, started anew at jumps and every 1.7 turns",
        TRAPEZOIDAL,
    ),
    **{f"trapezoidal x{count}": _extrapolated_method(count) for count in (2, 3, 4)},
}


# exudyn behind the contract: constrained planar bodies, one generalised-α run or trapezoidal runs extrapolated.

END = "of the state at the end of the step"
READOUTS: Mapping[Channel, ReadOut] = {
    **{channel: ReadOut(f"SensorNode, {name}", instant=END) for channel, name in COORDINATES.items()},
    Channel.ACCELERATION: ReadOut(
        "SensorNode, Coordinates_tt; without that of the start, which is given to exudyn but in naive", instant=END
    ),
    Channel.TORQUE: ReadOut(
        "SensorObject of the drive's ObjectConnectorCoordinate (linear: CoordinateVector), Force, with its sign turned",
        instant=END,
        drive="alone",
    ),
    Channel.JOINT_FORCE: ReadOut(
        "SensorObject of the joint, Force; of ObjectJointPrismatic2D ForceLocal, turned by its body's angle",
        frame="ground; ForceLocal the body's",
        instant=END,
        drive="not included",
    ),
}


class ExudynEngine(LoopEngine[ExudynRecipe]):
    """Adapter for exudyn."""

    name = "exudyn"
    package = "exudyn"
    loop = "engines.exudyn_adapter.loop"
    oldest = "1.13.6"  # has newton.residualMode
    work_unit = "Newton iterations"
    effort_unit = EFFORT_UNIT
    abilities: ClassVar[Abilities] = Abilities(
        readouts=READOUTS,
        drives=frozenset({Prescribed, Free}),
        timed_torque=True,
        joints=GUIDES,
        loads=LOADS,
        drivers=frozenset(DriverKind),
    )
    settings = SETTINGS
    studied = STUDIED

    def model(self, scene: Scene, recipe: ExudynRecipe) -> Mapping[str, Any]:
        settings = {"settings": recipe.solver_settings(), "static_settings": STATIC_SETTINGS}
        return ExudynModel(scene).as_data() | settings | {"as_shipped": recipe.as_shipped}

    def follow(self, world: Any, course: Course[ExudynRecipe]) -> History:  # noqa: ANN401 - the loop's
        course.cost.details.update(course.recipe.details())
        return super().follow(world, course)
