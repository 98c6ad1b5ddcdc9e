"""exudyn behind the contract: constrained planar bodies, one generalised-α run or trapezoidal runs extrapolated.

J. Gerstmayr, "Exudyn - a C++-based Python package for flexible multibody systems", Multibody System Dynamics 60 (2024).

- ``naive``: a Python function for the drive, exudyn's defaults at 1 ms.
- ``tuned``: one run of generalised α with its constraints on position level: joints stay closed over any number of
  turns, and a linkage passes its change points.
- ``best``: the trapezoidal rule with its constraints on velocity level, extrapolated to eighth order: its multipliers
  are free of the rounding that the square of the step magnifies on position level.

The parts of a prescribed motion start anew (``engines.exudyn_adapter.loop``);
``engines.exudyn_adapter.recipes`` has the settings' numbers and the methods that can be studied.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, ClassVar

from analytic.description.linkage import DriverKind
from engines.contract import Abilities, History, ReadOut
from engines.exudyn_adapter.model import COORDINATES, ExudynModel
from engines.exudyn_adapter.recipes import EFFORT_UNIT, SETTINGS, STUDIED, ExudynRecipe
from engines.scene import GUIDES, LOADS, Channel, Free, Prescribed, Scene
from engines.stepping.loop_engine import LoopEngine
from engines.stepping.stepped_engine import Course

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
        rule = {name: getattr(recipe, name) for name in ("as_shipped", "effort", "adaptive", "damping")}
        return ExudynModel(scene).described() | rule

    def follow(self, world: Any, course: Course[ExudynRecipe]) -> History:  # noqa: ANN401 - the loop's
        course.cost.details.update(course.recipe.details())
        return super().follow(world, course)
