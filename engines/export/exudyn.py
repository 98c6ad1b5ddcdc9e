"""An exudyn run of one pass as the text of a script: each part of the motion from literal coordinates."""

from __future__ import annotations

from analytic.description.linkage import GROUND
from engines.export.script import FORCE, row
from engines.exudyn_adapter.adapter import solver_settings
from engines.exudyn_adapter.readout import Recorder
from engines.exudyn_adapter.recipes import ExudynRecipe
from engines.scene import Scene
from engines.stepping.stepped_engine import Course

TEXT = """
exudyn.config.printToConsole = False  # True shows its solver at work
# Of each part of the motion: begin and duration (s), samples, steps to a sample, whether the acceleration jumps at its
# end; the crank's coordinate as a polynomial of the time since the begin, lowest power first; the coordinates that it
# starts from and their derivatives (none: the model's own); whole turns taken off the angles (rad).
PARTS = [
{parts}
]
START = np.array([  # x, y and angle of the bodies at coordinates 0
{start}
])
MOTION = {{  # sensors of the bodies
{motion}
}}
FORCES = {{  # sensor, what makes two components of its output, sensor and start of the angle they are turned by
{forces}
}}


def polynomial(coefficients):
    def value(system, t, item, offset):
        result = coefficients[-1] + 0.0 * t
        for coefficient in coefficients[-2::-1]:
            result = result * t + coefficient
        return result

    return value


for begin, duration, count, ratio, jumps, crank, states, turns in PARTS:
    functions = []  # exudyn does not keep them alive
    for name in ("offsetUserFunction", "offsetUserFunction_t") if crank else ():
        functions.append({symbolic}({mbs}, polynomial(crank), name, {driver}))
        {mbs}.SetObjectParameter({driver}, name, functions[-1])
        crank = [power * coefficient for power, coefficient in enumerate(crank)][1:] or [0.0]
    state, initial = {mbs}.systemData, exudyn.ConfigurationType.Initial
    for put, values in zip((state.SetODE2Coordinates, state.SetODE2Coordinates_t, state.SetODE2Coordinates_tt), states):
        put(values, configuration=initial)
    {settings}.timeIntegration.endTime = duration
    {settings}.timeIntegration.numberOfSteps = count * ratio
    {settings}.solution.sensors.writePeriod = duration / count
    solver = exudyn.MainSolverImplicitSecondOrder()
    finished = solver.SolveSystem({mbs}, {settings})
    data = [{mbs}.GetSensorStoredData(sensor) for sensor in range({sensors})]
    time = begin + data[{first}][:, 0]
    for name, numbers in MOTION.items():
        values = np.zeros((len(time), len(numbers), 3))
        for body, sensor in enumerate(numbers):
            values[:, body, : data[sensor].shape[1] - 1] = data[sensor][:, 1:]
        values += START + turns if name == "position" else 0.0
        given = begin > 0.0 or (name == "acceleration" and len(states) > 0)  # those at the start are not exudyn's own
        kept = slice(1 if given else 0, -1 if jumps and name == "acceleration" else None)
        keep(name, time[kept], values[kept])
    kept = slice(1, -1 if jumps else None)  # forces belong to a step
{torque}
    for name, (sensor, matrix, angle, zero) in FORCES.items():
        x, y = np.array(matrix) @ data[sensor][kept, 1:].T
        turn = zero + data[angle][kept, 3] if angle is not None else np.zeros(len(x))
        keep(name, time[kept], np.stack([np.cos(turn) * x - np.sin(turn) * y, np.sin(turn) * x + np.cos(turn) * y], 1))
    if not finished:
        raise SystemExit(f"exudyn stopped at {{begin + state.GetTime():.4g}} s: {{solver.GetErrorString()}}")
"""


def text(scene: Scene, world: Recorder, course: Course[ExudynRecipe], followed: Recorder) -> str:
    """The text of a pass, each part of it from the state that the run ``followed`` has started it from."""
    from exudyn.advancedUtilities import CreateSymbolicUserFunction as Symbolic

    model, parts = world.model, course.parts
    starts = followed.model.starts or [([], (), followed.model.unwound)]
    told = [
        row((
            part.start, part.end - part.start, part.samples, course.ratio, later is not None and later.after_jump,
            drive, [state.tolist() for state in states], turns.tolist(),
        ))
        for part, later, (drive, states, turns) in zip(parts, [*parts[1:], None], starts, strict=False)
    ]  # fmt: skip
    forces = []
    for name, sensor in world.forces.items():
        output = model.joints[name]
        turned = (None, 0.0) if output.frame == GROUND else (world.angles[output.frame], model.angles[output.frame])
        forces.append(row((sensor, output.matrix.tolist(), *turned), FORCE + name))
    return TEXT.format(
        parts="\n".join(told),
        start="\n".join(f"{row([*body.position, body.angle])}  # {body.name!r}" for body in scene.bodies),
        motion="\n".join(f'    "{channel}": {list(sensors)},' for channel, sensors in world.motion.items()),
        forces="\n".join(forces),
        sensors=1 + max(world.sensors),
        first=world.sensors[0],
        torque="" if world.torque is None else f'    keep("torque", time[kept], -data[{world.torque}][kept, 1])',
        mbs=model.mbs,
        driver=model.driver,
        settings=solver_settings(model.exudyn, parts[0], course),
        symbolic=Symbolic,
    )
