"""A Simbody run, through OpenSim, as the text of a script: each part of the motion from where the one before ended."""

from __future__ import annotations

import numpy as np

from analytic.description.law import Law
from engines.export.loads import law_told
from engines.export.script import FORCE, row
from engines.export.transcript import literal
from engines.mechanics.spanning_tree import spanning_tree
from engines.scene import PinJoint, Scene
from engines.simbody_adapter import RAPID, SimbodyRecipe, SimbodyWorld
from engines.stepping.stepped_engine import Course

TEXT = """
# Of each part of the motion: begin, end (s), samples, steps to a sample, tolerance; when Simbody's clock is 0; the
# crank's coordinate as a polynomial of that clock, lowest power first.
PARTS = [
{parts}
]


def plane(vector, factor=1.0):
    return factor * vector.get(0), factor * vector.get(1)


def reaction(number, sign):
    return lambda state: plane(JOINTS.get(number).calcReactionOnParentExpressedInGround(state).get(1), sign)


def taken_up(number, carrier, first):
    def force(state):
        values = CONSTRAINTS.get(number).getRecordValues(state)
        vector = {opensim}.Vec3(values.get(first), values.get(first + 1), 0.0)
        return plane(carrier.expressVectorInGround(state, vector), -1.0)

    return force


JOINTS, CONSTRAINTS = {model}.getJointSet(), {model}.getConstraintSet()
BODIES = [  # frame, coordinates that turn it, its angle where these are 0
{bodies}
]
FORCES = {{  # the tree's joints; the constraints that close its loops, the body in whose axes they tell it, their row
{forces}
}}
KINEMATICS = (
    ("position", "getPositionInGround", "getValue"),
    ("velocity", "getLinearVelocityInGround", "getSpeedValue"),
    ("acceleration", "getLinearAccelerationInGround", "getAccelerationValue"),
)
LOADS = [  # what takes its components, the first of these, its law over the crank angle
{loads}
]
for begin, end, count, ratio, tolerance, zero, crank in PARTS:
    time = np.linspace(begin, end, count + 1)
    clock = (time - zero).tolist()
    if crank:
        coordinate = {model}.updCoordinateSet().get(0)
        coefficients = {opensim}.Vector.createFromMat(np.array(crank[::-1]))
        coordinate.setPrescribedFunction({opensim}.PolynomialFunction(coefficients))
        coordinate.setDefaultIsPrescribed(True)
    angles = np.polynomial.polynomial.polyval(clock, crank or [0.0])
    for apply, first, law in LOADS:
        functions = [{opensim}.Constant(0.0) for _ in range(3)]
        for axis, values in enumerate(np.array([at_angle(law, angle) for angle in angles]).T.tolist(), first):
            functions[axis] = {opensim}.Constant(values[0]) if len(law) == 1 else {opensim}.SimmSpline()
            for point in zip(clock, values) if len(law) > 1 else ():
                functions[axis].addPoint(*point)
        apply(*functions)
    state = {model}.initSystem()
    state.setTime(clock[0])
    manager = {opensim}.Manager({model})
    manager.setWriteToStorage(False)
    if tolerance is not None:
        manager.setIntegratorConstraintTolerance(tolerance)
    manager.{set_step}((end - begin) / count / ratio)
    manager.initialize(state)
    for sample, instant in enumerate(clock):
        manager.setIntegratorFinalTime(instant)  # or it steps beyond and interpolates
        state = manager.integrate(instant) if sample else manager.getState()
        {model}.realizeAcceleration(state)
        if sample == count and end < PARTS[-1][1]:
            continue  # the later part's sample counts
        for name, place, rate in KINEMATICS:
            values = []
            for body, turns, angle in BODIES:
                turn = sum((getattr(each, rate)(state) for each in turns), angle if name == "position" else 0.0)
                values.append((*plane(getattr(body, place)(state)), turn))
            keep(name, [time[sample]], [values])
        for name, force in FORCES.items():
            keep(name, [time[sample]], [force(state)])
        if crank:
            moment = JOINTS.get(0).calcReactionOnParentExpressedInGround(state).get(0)
            keep("torque", [time[sample]], [-moment.get(2)])
    {model}.setPropertiesFromState(state)
"""


def text(scene: Scene, world: SimbodyWorld, course: Course[SimbodyRecipe], followed: SimbodyWorld) -> str:
    """The text of a pass."""
    import opensim

    recipe, tree, parts = course.recipe, spanning_tree(scene), []
    for part in course.parts:
        zero, crank = (part.segment.start, list(part.segment.coefficients)) if part.segment else (0.0, [])
        time = np.linspace(part.start, part.end, part.samples + 1)
        speed = float(np.abs(part.segment.value(time, 1)).max()) if part.segment else 0.0
        effort = None if recipe.effort is None else recipe.effort * max(1.0, speed / RAPID)
        parts.append(row((part.start, part.end, part.samples, course.ratio, effort, zero, crank)))
    bodies = []
    for body in scene.bodies:
        turns = world.turning[body.name] if body.inertia is not None else []
        bodies.append(row((world.frames[body.name], turns, body.angle - sum(turn.getDefaultValue() for turn in turns))))
    forces = []
    for number, branch in enumerate(tree.branches):
        forces.append((branch.name, f"reaction({number}, {1.0 if branch.reverse else -1.0})"))
    for number, cut in enumerate(tree.cuts):
        forces.append(
            (
                cut.name,
                f"taken_up({number}, {world.frames[tree.carrier(cut)]}, {0 if isinstance(cut, PinJoint) else 6})",
            )
        )
    return TEXT.format(
        parts="\n".join(parts),
        bodies="\n".join(bodies),
        forces="\n".join(f"    {literal(FORCE + name)}: {force}," for name, force in forces),
        loads="\n".join(
            row((apply, 0 if len(law.values.T) > 1 else 2, law_told(law)))
            for apply, law in world.loads
            if isinstance(law, Law)
        ),
        model=world.model,
        opensim=opensim,
        set_step="setIntegratorFixedStepSize" if recipe.fixed else "setIntegratorMaximumStepSize",
    )
