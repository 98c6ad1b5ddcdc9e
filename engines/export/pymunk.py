"""A pymunk run as the text of a script: every step in one loop, which looks at everything after each."""

from __future__ import annotations

import math
from itertools import groupby

from analytic.description.crank_motion import derivative
from analytic.description.linkage import GROUND
from engines.export.loads import law_told
from engines.export.script import FORCE, row
from engines.export.transcript import folded, literal
from engines.pymunk_adapter.adapter import PymunkRecipe, clocks_of, crank_rates, iterations_in, joints_of, set_off
from engines.pymunk_adapter.space import PymunkWorld
from engines.scene import Scene
from engines.stepping.stepped_engine import Course

TEXT = '''
# Of each part of the motion: begin and step (s), steps, step of the last of them; where positions, velocities and loads
# are read, as first and last step and their stride; the start of its piece of the crank's motion, and the crank's speed
# as a polynomial of the time since then, highest power first.
PARTS = [
{parts}
]
ITERATIONS = [{iterations}]  # steps in a row, and their iterations
BODIES = [{bodies}]
OFFSETS = np.array({offsets})  # of the scene's bodies' mass centres from these, in their frames
AHEAD = {ahead}  # of a step from positions to velocities
FORCES_ON = [  # of loads set before every step: body, anchor in its frame, law over the crank angle
{forces}
]
TORQUES_ON = [{torques}]
DAMPERS = [{dampers}]
DASHPOTS = [{dashpots}]  # a change of a spring's free length: speed times this
READ = {{{read}}}


def mean_speeds(begin, step, steps, zero, speed):
    nodes, shares = np.polynomial.legendre.leggauss((len(speed) + 2) // 2) if AHEAD else (-np.ones(1), np.full(1, 2.0))
    x = begin + step * (np.arange(steps)[:, None] + 0.5 * (nodes + 1.0)) - zero
    value = x * 0.0 + speed[0]
    for coefficient in speed[1:]:
        value = value * x + coefficient
    return value @ (0.5 * shares)


def look():
    return [((*body.position, body.angle), (*body.velocity, body.angular_velocity)) for body in BODIES]


def centres(seen, ahead, rates=None):
    """Positions of the scene's mass centres, or velocities a time ahead of the positions seen."""
    angle = seen[:, :, 2] if rates is None else seen[:, :, 2] + ahead * rates[:, :, 2]
    c, s = np.cos(angle), np.sin(angle)
    x, y = c * OFFSETS[:, 0] - s * OFFSETS[:, 1], s * OFFSETS[:, 0] + c * OFFSETS[:, 1]
    result = seen.copy() if rates is None else rates.copy()
    turned = (x, y) if rates is None else (-y * rates[:, :, 2], x * rates[:, :, 2])
    result[:, :, 0] += turned[0]
    result[:, :, 1] += turned[1]
    return result


def span(spring, ahead):
    places = []
    for body, (x, y) in ((spring.a, spring.anchor_a), (spring.b, spring.anchor_b)):
        turn, (vx, vy) = body.angle + ahead * body.angular_velocity, body.velocity
        c, s = math.cos(turn), math.sin(turn)
        places.append((body.position.x + ahead * vx + c * x - s * y, body.position.y + ahead * vy + s * x + c * y))
    return math.dist(*places)


def set_loads(ahead):
    """Those that change from step to step, for the positions to come."""
    angle = {crank}.angle + ahead * {crank}.angular_velocity
    for body, (x, y), law in FORCES_ON:
        turn, (fx, fy) = body.angle + ahead * body.angular_velocity, at_angle(law, angle)
        c, s = math.cos(turn), math.sin(turn)
        body.force += (fx, fy)
        body.torque += (c * x - s * y) * fy - (s * x + c * y) * fx
    for body, law in TORQUES_ON:
        body.torque += at_angle(law, angle)[0]
    for number, (first, second, coefficient) in enumerate(DAMPERS):
        rate = first.angular_velocity - second.angular_velocity
        torque = coefficient * (1.5 * rate - 0.5 * turning[number])
        turning[number] = rate
        first.torque -= torque
        second.torque += torque
    for number, (spring, stretch, free) in enumerate(DASHPOTS):
        last, second_last = spans.get(number) or (span(spring, 0.0), span(spring, -ahead))
        now = span(spring, ahead)
        speed = (3.0 * now - 4.0 * last + second_last) / (2.0 * ahead)
        spans[number] = now, last
        spring.rest_length = (now if free is None else free) - stretch * speed


spans = {{}}
iterations = [count for steps, count in ITERATIONS for _ in range(steps)]
speeds = [mean_speeds(part[0], part[1], part[2] + (part is PARTS[-1]), *part[-2:]) for part in PARTS if part[-1]]
speeds = np.concatenate(speeds) if speeds else np.zeros(len(iterations) + 1)
turning = [first.angular_velocity - second.angular_velocity for first, second, _ in DAMPERS]
start = 0
for begin, step, steps, last_step, *reads, zero, speed in PARTS:
    seen, impulses = [look()], []
    for number in range(steps):
        length = step
        if number == steps - 1 and last_step != step:  # joints are closed by this step, the next moves the bodies on
            length = last_step
            for body in {space}.bodies:
                body.velocity *= step / length
                body.angular_velocity *= step / length
        set_loads(length if AHEAD else 0.0)
        {space}.iterations = iterations[start + number]
        if speed:
            {motor}.rate = -float(speeds[start + number + {centred}])
        {space}.step(length)
        seen.append(look())
        impulses.append([joint.impulse for joint in READ.values()])
    places, rates = np.moveaxis(np.array(seen), 2, 0)
    positions, velocities, loaded = (np.arange(first, last + 1, stride) for first, last, stride in reads)
    keep("position", begin + step * positions, centres(places[positions], 0.0))
    keep("velocity", begin + step * (velocities + AHEAD), centres(places[velocities], AHEAD * step, rates[velocities]))
    change = centres(places[loaded], AHEAD * step, rates[loaded])
    change -= centres(places[loaded], -AHEAD * step, rates[loaded - 1])
    keep("acceleration", begin + step * loaded, change / step)
    for name, values in zip(READ, np.array(impulses)[loaded - 1].T / step):
        if name == "torque" and AHEAD:  # less the torque that keeps its sign, and a flywheel's
            values = {offset} - values - {flywheel} * np.diff(speeds)[start + loaded - 1] / step
        keep(name, begin + step * loaded, values)
    start += steps
'''


def text(scene: Scene, world: PymunkWorld, course: Course[PymunkRecipe], followed: PymunkWorld) -> str:
    """The text of a pass."""
    centred, layout = course.recipe.centred, world.layout
    clocks = clocks_of(course)
    rates = crank_rates(clocks, centred)
    set_off(world, clocks[0], float(rates[0]))
    rows = []
    for clock, later in zip(clocks, [*clocks[1:], clocks[-1]], strict=True):
        last = clock.fine if not centred or math.isclose(clock.fine, later.fine) else later.fine
        reads = [(int(each[0]), int(each[-1]), clock.ratio) for each in (clock.samples, clock.middles, clock.loaded)]
        segment = clock.part.segment
        speed = (segment.start, list(derivative(segment.coefficients, 1))) if segment else (0.0, [])
        rows.append(row((clock.part.start, clock.fine, clock.steps, last, *reads, *speed)))
    runs = [(len(list(same)), count) for count, same in groupby(iterations_in(followed, clocks, rates).tolist())]
    read = {FORCE + name: joint for name, joint in joints_of(world).items()}
    if world.motor is not None:
        read["torque"] = world.motor
    carried = len(scene.bodies)
    dampers = [(world.ends[d.first], world.ends[d.second], d.coefficient) for d in scene.dampers if centred]
    dashpots = [
        (engine, spring.damping / engine.stiffness, spring.length if spring.stiffness else None)
        for spring, engine in zip(scene.springs, world.springs, strict=True)
        if centred and spring.damping
    ]
    turned = [load for load in scene.forces if not load.force.is_constant]
    twisted = [load for load in scene.torques if not load.torque.is_constant and load.body != GROUND]
    return TEXT.format(
        crank=world.crank,
        forces="\n".join(row((world.ends[load.body], load.anchor, law_told(load.force))) for load in turned),
        torques=literal([(world.ends[load.body], law_told(load.torque)) for load in twisted])[1:-1],
        dashpots=literal(dashpots)[1:-1],
        parts="\n".join(rows),
        iterations=folded(literal(runs)[1:-1]),
        bodies=literal(list(world.bodies[:carried]))[1:-1],
        offsets=[[-float(place) for place in part.offset] for part in layout.parts[:carried]],
        ahead=0.5 if centred else 0.0,
        dampers=literal(dampers)[1:-1],
        read=literal(read)[1:-1],
        space=world.space,
        motor=world.motor,
        centred=int(centred),
        offset=repr(world.offset),
        flywheel=repr(layout.flywheel),
    )
