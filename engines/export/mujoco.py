"""A MuJoCo run as the text of a script: the drive by a callback, samples between steps."""

from __future__ import annotations

import numpy as np

from analytic.description.crank_motion import Segment, derivative
from engines.export.loads import law_told
from engines.export.script import FORCE, row
from engines.export.transcript import literal
from engines.mechanics.loads import instant_pushes
from engines.mechanics.states import body_numbers
from engines.mujoco_adapter import MujocoRecipe, MujocoWorld
from engines.scene import Scene
from engines.stepping.stepped_engine import Course

PUSHES = """
# Of the loads: the body's place among these bodies, the anchor in its frame as a complex number, and the law of the
# force or torque over the crank angle; of springs two of both, stiffness, free length and damping.
NUMBERS = {numbers}
FORCES_ON = [
{forces}
]
TORQUES_ON = [
{torques}
]
SPRINGS = [
{springs}
]
PLANE = np.array([1.0, 1j, 0.0])


def push():
    roots = {model}.body_rootid[NUMBERS]
    centre, direction = {data}.xipos[NUMBERS] @ PLANE, {data}.xmat[NUMBERS][:, [0, 3, 6]] @ PLANE
    spin = {data}.cvel[NUMBERS, 2]
    velocity = {data}.cvel[NUMBERS, 3:] @ PLANE + 1j * spin * (centre - {data}.subtree_com[roots] @ PLANE)
    loads, angle = [], {start} + {data}.qpos[{crank}]
    rows = np.zeros((len(NUMBERS), 3))
    for body, anchor, law in FORCES_ON:
        loads.append((body, anchor * direction[body], complex(*at_angle(law, angle))))
    for body, law in TORQUES_ON:
        rows[body, 2] += at_angle(law, angle)[0]
    for first, anchor, second, other, stiffness, free_length, damping in SPRINGS:
        arm, other = anchor * direction[first], other * direction[second]
        span = centre[first] + arm - centre[second] - other
        rate = velocity[first] + 1j * spin[first] * arm - velocity[second] - 1j * spin[second] * other
        along = span / (abs(span) or 1.0)
        tension = stiffness * (abs(span) - free_length) + damping * (along.conjugate() * rate).real
        loads += [(first, arm, -tension * along), (second, other, tension * along)]
    for body, arm, force in loads:
        rows[body] += force.real, force.imag, (arm.conjugate() * force).imag
    {data}.xfrc_applied[np.ix_(NUMBERS, (0, 1, 5))] = rows


"""
TEXT = """
# Of each part of the motion: begin, end (s), samples, steps to a sample, time constant of the constraints; the start of
# its piece of the crank's motion; the drive's reference acceleration as a polynomial of the time since then, highest
# power first: epsilon + 2 omega / constant + phi / constant**2.
PARTS = [
{parts}
]
BODIES = [  # angle at the start, and which hinges add up to what it changes by
{bodies}
]
ANGLES, TURNS = np.array([angle for angle, _ in BODIES]), np.array([turns for _, turns in BODIES])
TREE = {{  # joints by which a body hangs on another: the body's number, sign of its force
{tree}
}}
CUTS = {{{cuts}}}  # the other joints: numbers of equalities
warnings = []
mujoco.set_mju_user_warning(warnings.append)
for begin, end, count, ratio, constant, zero, reference in PARTS:
    {model}.opt.timestep = (end - begin) / count / ratio
    {model}.eq_solref[:, 0] = constant
    rate = 1.0 / constant

    def control(_, stage):  # called at every stage of the integrator
        if reference:
            value, x = reference[0], stage.time - zero
            for coefficient in reference[1:]:
                value = value * x + coefficient
            stage.efc_aref[0] = value - 2.0 * rate * {data}.qvel[{crank}] - rate**2 * {data}.qpos[{crank}]
        if {loaded}:
            push()

    mujoco.set_mjcb_control(control if reference or {loaded} else None)
    for sample, instant in enumerate(np.linspace(begin, end, count + 1).tolist()):
        if sample:
            mujoco.mj_step({model}, {data}, nstep=ratio)
        {data}.time = instant
        if {settled}:
            mujoco.mj_forward({model}, {data})  # or forces and accelerations are those of the last step's last stage
        mujoco.mj_rnePostConstraint({model}, {data})
        if warnings:
            raise SystemExit(f"MuJoCo warns at {{instant:.4g}} s: {{warnings[0]}}")
        if sample == count and end < PARTS[-1][1]:
            continue  # the later part's sample counts
        frames = {data}.sensordata.reshape(len(BODIES), 3, 3)[:, :, :2]
        keep("position", [instant], [np.column_stack([frames[:, 0], TURNS @ {data}.qpos + ANGLES])])
        keep("velocity", [instant], [np.column_stack([frames[:, 1], TURNS @ {data}.qvel])])
        keep("acceleration", [instant], [np.column_stack([frames[:, 2] + {gravity}, TURNS @ {data}.qacc])])
        if reference:
            keep("torque", [instant], [float({data}.efc_force[0])])
        for name, (body, sign) in TREE.items():
            keep(name, [instant], [sign * {data}.cfrc_int[body, 3:5]])
        for name, equality in CUTS.items():
            first = np.flatnonzero({data}.efc_id == equality)[0]
            keep(name, [instant], [1.0 * {data}.efc_force[first : first + 2]])
mujoco.set_mjcb_control(None)
"""


def text(scene: Scene, world: MujocoWorld, course: Course[MujocoRecipe], followed: MujocoWorld) -> str:
    """The text of a pass."""
    loaded = instant_pushes(scene) is not None
    parts = []
    for part in course.parts:
        constant, segment = float(course.recipe.settle * part.step or 0.02), part.segment
        zero, drive = (segment.start, _reference(scene, segment, 1.0 / constant)) if segment else (0.0, [])
        parts.append(row((part.start, part.end, part.samples, course.ratio, constant, zero, drive)))
    bodies = zip(scene.bodies, world.turns.tolist(), strict=True)
    branches = [branch for branch in world.tree.branches if branch.name in world.joints]
    cuts = {FORCE + cut.name: world.model.equality(cut.name).id for cut in world.tree.cuts}
    pushes = _pushes(scene, world) if loaded else ""
    return pushes + TEXT.format(
        loaded=loaded,
        parts="\n".join(parts),
        bodies="\n".join(f"{row((body.angle, turns))}  # {body.name!r}" for body, turns in bodies),
        tree="\n".join(
            row((world.model.body(branch.body.name).id, 1 - 2 * branch.reverse), FORCE + branch.name)
            for branch in branches
        ),
        cuts=literal(cuts)[1:-1],
        model=world.model,
        data=world.data,
        crank=world.crank,
        settled=bool(course.recipe.settle),
        gravity=literal(tuple(map(float, scene.gravity))),
    )


def _pushes(scene: Scene, world: MujocoWorld) -> str:
    numbers = body_numbers(scene)
    springs = [
        (
            numbers[spring.first], complex(*spring.first_anchor), numbers[spring.second],
            complex(*spring.second_anchor), spring.stiffness, spring.length, spring.damping,
        )
        for spring in scene.springs
    ]  # fmt: skip
    forces = [(numbers[load.body], complex(*load.anchor), law_told(load.force)) for load in scene.forces]
    torques = [(numbers[load.body], law_told(load.torque)) for load in scene.torques]
    return PUSHES.format(
        numbers=world.numbers,
        forces="\n".join(map(row, forces)),
        torques="\n".join(map(row, torques)),
        springs="\n".join(map(row, springs)),
        model=world.model,
        data=world.data,
        start=repr(float(scene.crank_angle)),
        crank=world.crank,
    )


def _reference(scene: Scene, segment: Segment, rate: float) -> list[float]:
    terms = [np.poly1d(derivative(segment.coefficients, order)) for order in range(3)]
    total = terms[2] + 2.0 * rate * terms[1] + rate**2 * (terms[0] - scene.crank_angle)
    return [float(coefficient) for coefficient in total.coeffs]
