"""What exudyn does not look at: scenes it would run to no end, and states that are no longer the scene's."""

from __future__ import annotations

import math

from engines.exudyn_adapter.drive import crank_angle
from engines.exudyn_adapter.model import ANGLE, Model
from engines.mechanics.joints import scene_size
from engines.mechanics.states import body_numbers
from engines.scene import Prescribed
from engines.start_check import misfits
from engines.stepping.driver import UnsupportedError

# A joint may be open by this share of the scene's size over the square of the division: the drift of a constraint on
# velocity level is second order in the step, and what does not shrink like that is not drift.
LARGEST_GAP = 5e-2
LARGEST_LAG = 0.05  # rad between the crank and its prescribed angle


def assemble(model: Model) -> None:
    """Assemble a model; raises UnsupportedError where exudyn refuses it or its joints do not fit the drive.

    Redundant joints would make it singular, which exudyn says only in the middle of a solve.
    """
    try:
        model.mbs.Assemble()
    except model.exudyn.ExudynError as error:
        raise UnsupportedError("exudyn refuses the scene: " + str(error).partition("\n")[0]) from error
    freedom = model.exudyn.ComputeSystemDegreeOfFreedom(model.mbs)
    redundant = freedom["redundantConstraints"]
    if redundant:
        raise UnsupportedError(f"the joints repeat {redundant} of their conditions, which makes exudyn singular")
    expected = 1 if model.driver is None else 0
    left = int(freedom["degreeOfFreedom"])
    if left != expected:
        raise UnsupportedError(f"the joints leave {left} degrees of freedom where the drive needs {expected}")


def not_finite(model: Model, now: float) -> str | None:
    """Whether the state exudyn ended with is made of numbers."""
    state = model.mbs.systemData
    values = (*state.GetODE2Coordinates(), *state.GetODE2Coordinates_t())
    return None if all(map(math.isfinite, values)) else f"the state is not finite at {now:.4g} s"


def broken(model: Model, now: float, division: int) -> str | None:
    """Whether the linkage is still closed, and the crank where its drive has it, in a pass of that division."""
    scene = model.scene
    position = model.position()
    size = scene_size(scene)
    for miss in misfits(scene, position):
        share = miss.size / size
        if not share <= LARGEST_GAP / division**2:
            return f"joint '{miss.joint}' is open by {share:.2%} of a link at {now:.4g} s"
    if isinstance(scene.drive, Prescribed):
        lag = position[0, body_numbers(scene)[scene.crank], ANGLE] - crank_angle(scene.drive.motion.segments, now)
        if not abs(lag) <= LARGEST_LAG:
            return f"the crank is {lag:.3g} rad away from its drive at {now:.4g} s"
    return None
