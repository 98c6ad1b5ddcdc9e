"""pymunk behind the contract: the scene as bodies, pins and grooves, stepped to second order.

With every joint's ``error_bias`` at 0 each step closes the joints to first order (a linearised SHAKE), which makes the
motion second order in the step with terms of every higher order behind it; any other bias leaves it at first order.
The motor is given the mean speed of the step to come, so that the crank is where its motion has it after every step
and a jump of its acceleration needs no fresh start. The naive setting leaves pymunk its defaults and takes every
read-out at face value.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Final

import numpy as np

from analytic.description.law import FULL_TURN
from analytic.description.linkage import GROUND, DriverKind
from engines.contract import Abilities, ReadOut, Setting
from engines.mechanics.joints import JointEquations
from engines.mechanics.states import Pose, body_masses, driven, start_coordinate, start_motion
from engines.pymunk_adapter.layout import PartLayout, exact_layout, plain_layout, reach
from engines.scene import GUIDES, LOADS, Channel, Free, Prescribed, Scene
from engines.stepping.intervals import UnsupportedError
from engines.stepping.stepped_engine import LoopEngine, Recipe, plain_law

# From a layout to what the loop makes a pymunk space of: bodies, constraints and loads, in plain data.
#
# Bodies are numbers, the ground is -1.


SHORTEST: Final = 0.01  # of the scene's reach: the lever of a linear drive
# Samples on either side, within which nothing is read: of a jump of the acceleration, and of its slope.
JUMP, KINK = 1.5, 0.5
BEHIND: Final = 4.0  # of the reach: how far behind a slider's line its far end begins


def space_data(scene: Scene, layout: PartLayout, *, centred: bool) -> dict[str, Any]:
    """The data, by name, of pymunk's space for a scene's layout, except what follows from the solver's iterations.

    ``centred`` is as in the recipe.
    """
    parts, size = layout.scene, reach(scene)
    numbers = {GROUND: -1, **{body.name: number for number, body in enumerate(parts.bodies)}}
    _, speed, gain = (float(value[0]) for value in driven(scene, *start_motion(scene)))
    pins = [
        ("PivotJoint", numbers[pin.first], numbers[pin.second], pin.first_anchor, pin.second_anchor)
        for pin in parts.pins
    ]
    grooves = []
    for groove in parts.guided:
        (x, y), (along_x, along_y), length = groove.through, groove.along, 2.0 * size / math.hypot(*groove.along)
        ends = (x - length * along_x, y - length * along_y), (x + length * along_x, y + length * along_y)
        grooves.append(("GrooveJoint", numbers[groove.host], numbers[groove.body], *ends, groove.anchor))
    angles = {GROUND: 0.0, **{body.name: body.angle for body in parts.bodies}}
    gears = [
        ("GearJoint", numbers[host], numbers[body], angles[body] - angles[host], 1.0) for body, host in layout.gears
    ]
    of_scene = {joint.name for joint in scene.joints}
    torques = [(numbers[load.body], (0.0, 0.0), plain_law(load.torque)) for load in parts.torques]
    return {
        "centred": centred,
        "gravity": parts.gravity,
        "bodies": [(body.mass, body.inertia, body.position, body.angle) for body in parts.bodies],
        "offsets": [complex(-part.offset[0], -part.offset[1]) for part in layout.parts[: layout.carried]],
        "tangent": layout.tangent(scene),
        "driver_rates": (speed, gain),
        "start": start_coordinate(scene),
        "crank": numbers.get(scene.crank),
        "constraints": [*pins, *grooves, *gears],
        "joints": {joint.name: number for number, joint in enumerate(parts.joints) if joint.name in of_scene},
        "springs": [
            (numbers[each.first], numbers[each.second], each.first_anchor, each.second_anchor, *rest)
            for each in parts.springs
            for rest in [(each.length, each.stiffness, each.damping)]
        ],
        "dampers": [(numbers[each.first], numbers[each.second], each.coefficient) for each in parts.dampers],
        "loads": torques + [(numbers[load.body], load.anchor, plain_law(load.force)) for load in parts.forces],
        "offset": torque_bound(scene, size) if centred else 0.0,
        **_drive(parts, numbers, size),
    }


def _drive(scene: Scene, numbers: dict[str, int], size: float) -> dict[str, Any]:
    """The drive's data by name: its motion, or its torque over time; ``line`` has the ends of a linear driver.

    ``scene`` has the parts; ``numbers`` are theirs, ``size`` is the scene's reach, m. A slider's far end is a point of
    the ground on its own line, behind all that it can reach: ``base`` farther than its travel.
    """
    drive, line, base = scene.drive, None, 0.0
    if scene.driver_kind is not DriverKind.CRANK:
        (first, here), (second, there) = scene.driver_ends
        if scene.cylinder is None:
            base, along = BEHIND * size, scene.driven_slider.along
            there = there[0] - base * along[0], there[1] - base * along[1]
        line = (numbers[first], here), (numbers[second], there)
    given: dict[str, Any] = {"line": line, "base": base, "motion": None, "kinks": (), "push": (0.0, None)}
    if isinstance(drive, Prescribed):
        segments, jumps = drive.motion.segments, drive.motion.jumps
        given["kinks"] = [(each.start, JUMP if each.start in jumps else KINK) for each in segments[1:]]
        given["motion"] = [(each.start, each.coefficients) for each in segments]
    else:
        given["push"] = drive.torque, drive.over_time and (drive.over_time.times, drive.over_time.torque)
    return given


def torque_bound(scene: Scene, size: float) -> float:
    """A torque, N m, well above any that a prescribed drive can need; 0 for a free one.

    It is that of all mass, at the largest speed and acceleration, and of all loads at an arm of ``size``, m. A motor
    works against it, which keeps the sign of what it exerts. Of a linear drive it is a force, N, at a lever of a
    hundredth of that size.
    """
    if not isinstance(scene.drive, Prescribed):
        return 0.0
    motion = scene.drive.motion
    times = np.linspace(0.0, motion.duration, 101)
    arm = 1.0 if scene.driver_kind is DriverKind.CRANK else SHORTEST * size
    speed = motion.peak_speed / arm
    rate = float(np.max(np.abs(motion.acceleration(times)))) / arm + speed**2
    weight = sum(body.mass for body in scene.bodies)
    bound = rate * (weight * size**2 + sum(body.inertia or 0.0 for body in scene.bodies))
    bound += weight * math.hypot(*scene.gravity) * size
    bound += sum(float(np.max(np.abs(load.force.values))) for load in scene.forces) * size
    bound += sum(float(np.max(np.abs(load.torque.values))) for load in scene.torques)
    bound += sum(damper.coefficient for damper in scene.dampers) * speed
    bound += sum(spring.stiffness + spring.damping * speed for spring in scene.springs) * size**2
    return bound / arm


# The engine.


# Number of iterations that pymunk's solver needs for a scene, from the scene itself.
#
# The impulses of a step start from those of the last one. What the iterations leave of their change is carried into
# the next step, where it opens the joints: where half of it is left, they are pushed open further from step to step,
# however short the steps are. How fast an iteration converges depends on masses and positions, from a handful of
# iterations to thousands.


# Driver positions of the motion at which convergence is looked at, and the corrections that close the joints there.
POSES, CORRECTIONS = 90, 8
CLOSED = 1e-9  # joints that open by less, as a share of the scene's size
# Bounds of the iteration count, the lower of them pymunk's default; beyond ENOUGH no more are spent than leave
# LARGEST_REMAINDER of a change wrong, which keeps the joints from being pushed open.
FEWEST, ENOUGH, MOST = 10, 1000, 10_000
LARGEST_REMAINDER = 0.3


def iterations_for(layout: PartLayout, remaining: float) -> list[int]:
    """Iterations a step, ``FEWEST`` to ``MOST``, that leave a share ``remaining`` of an impulse's change wrong.

    Above ``ENOUGH`` iterations only ``LARGEST_REMAINDER`` is aimed at. A crank that turns fully has them at ``POSES``
    even angles, each enough for its neighbours, too; any other driver has one number, that of the pose that converges
    slowest.
    """
    with np.errstate(all="ignore"):
        factors = np.array([contraction(layout, pose) for pose in poses_of(layout.equations)])
        enough, needed = np.log([[remaining], [LARGEST_REMAINDER]]) / np.log(np.minimum(factors, 1.0 - 1e-12))
    counts = np.clip(np.maximum(np.minimum(enough, ENOUGH), needed), FEWEST, MOST).astype(int)
    scene, (*turn, _) = layout.scene, counts
    if scene.driver_kind is not DriverKind.CRANK or abs(driver_travel(scene)) < FULL_TURN or len(turn) < POSES:
        return [int(counts.max())]
    return [int(count) for count in np.maximum.reduce([np.roll(turn, shift) for shift in (-1, 0, 1)])]


def driver_travel(scene: Scene) -> float:
    """Signed distance from the driver's start to the farther end of its motion, rad or m; of a crank a turn at most.

    A free driver, linear or not, has 2π.
    """
    if isinstance(scene.drive, Free):
        return FULL_TURN
    farthest = max((end - start_coordinate(scene) for end in scene.drive.motion.reach), key=abs)
    return max(-FULL_TURN, min(FULL_TURN, farthest)) if scene.driver_kind is DriverKind.CRANK else farthest


def poses_of(equations: JointEquations) -> list[Pose]:
    """The poses, one instant each, of the parts along the driver's travel, that of the start first.

    They are POSES + 1, or end before the first at which joints do not close.
    """
    pose = equations.start()
    start = equations.driver.value(pose)
    poses = [pose]
    for travel in driver_travel(equations.scene) / equations.driver.scale * np.arange(1, POSES + 1) / POSES:
        for _ in range(CORRECTIONS):
            residual, matrix = equations.violation(pose, start + travel)
            if np.abs(residual).max() < CLOSED:
                break
            try:
                change = np.linalg.solve(matrix, -residual[..., None])[..., 0]
            except np.linalg.LinAlgError:
                return poses
            pose = pose.moved(equations.spread(change))
        else:
            return poses
        poses.append(pose)
    return poses


def contraction(layout: PartLayout, pose: Pose) -> float:
    """Factor by which one iteration of pymunk's solver shrinks its error in the long run, at one pose.

    The solver is a block Gauss-Seidel iteration on A = G M⁻¹ Gᵀ, constraint by constraint: pins, grooves, gears, motor.
    This is the spectral radius of its iteration matrix; 1 where that cannot be had.
    """
    equations = layout.equations
    rows = equations.jacobian(equations.arms(pose))[0]
    masses = equations.gather((body_masses(layout.scene) / (1.0, 1.0, equations.unit**2))[None])[0]
    mobility = rows / masses @ rows.T
    pins = np.arange(equations.pins)
    visit = np.concatenate([pins, pins, np.arange(len(pins), equations.rows - len(pins))])
    lower = np.where(visit[:, None] >= visit[None, :], mobility, 0.0)
    try:
        return float(np.max(np.abs(np.linalg.eigvals(np.linalg.solve(lower, lower - mobility)))))
    except np.linalg.LinAlgError:
        return 1.0


# pymunk behind the contract: the scene as bodies, pins and grooves, stepped to second order.


# Steps after which a cold start has no effect on the forces any more, and samples without loads for it at most.
SETTLED, MOST_LEAD = 10, 3


@dataclass(frozen=True, kw_only=True)
class PymunkRecipe(Recipe):
    """``centred``: to second order, else as a newcomer would; ``effort`` are iterations in a step.

    Where none are given, a centred run has as many as leave the share ``remaining`` of an impulse's change wrong.
    """

    centred: bool = True
    remaining: float = 0.1
    restarted: bool = False
    orders: tuple[int, ...] = (2, 3, 4, 5, 6, 7, 8)  # the read-outs are centred, the closing of the joints is not


NAIVE: Final = PymunkRecipe(step=1e-4, least_steps=1, centred=False, in_own_units=False)
# Chosen from a sweep over the catalogue's five mechanisms, quintic run-up to 1000 rpm. Steps per turn and the share
# left by the solver; worst error of torque, reduced inertia and joint forces over their peaks:
#   2000, 5 %: 5.9e-5, 5.8e-5, 6.8e-5    6000, 20 %: 5.0e-4, 4.2e-6, 9.5e-4
#   6000, 5 %: 6.6e-6, 4.2e-6, 7.6e-6    6000, 1 %: 6.7e-6, 4.2e-6, 7.6e-6
#   8600, 5 %: 3.2e-6, 2.0e-6, 3.7e-6    10800, 5 %: 2.0e-6, 1.3e-6, 2.4e-6
# Some random linkages ask for more than 6000, and of the literature's the quick return of Whitworth: at 8600 the error
# of its reduced inertia, 8.5e-6, is just below the limit of 1e-5.
TUNED: Final = PymunkRecipe(steps_per_turn=200, ratios=(43,), least_steps=100, remaining=0.05)
BEST: Final = PymunkRecipe(steps_per_turn=240, ratios=(3, 5, 7, 9), least_steps=100, remaining=0.001)

# A free crank adds its error of phase up over all turns. The slotted take-up driven for 160 turns is the worst of the
# catalogue; errors of its crank's angle and acceleration over their peaks, limits 1e-5 and 1e-3:
#   2700 steps a turn: 3.7e-7, 1.4e-3    3300: 2.2e-7, 8.7e-4    5100: 8.5e-8, 3.3e-4    5300: 7.9e-8, 3.0e-4
# The runs of ``best`` leave 1.4e-11 of the angle. What the solver leaves does not show.
FREE_TUNED: Final = PymunkRecipe(steps_per_turn=100, ratios=(51,), least_steps=1000, remaining=0.2)
FREE_BEST: Final = PymunkRecipe(steps_per_turn=240, ratios=(7, 11, 15), least_steps=1000, remaining=0.2)

ABOUT: Final = "second order by unbiased joints, mean crank speeds and centred read-outs"
STUDIED: Final = {"centred": (1,), "centred x2": (1, 3), "centred x3": (1, 3, 5), "centred x4": (1, 3, 5, 7)}


class PymunkEngine(LoopEngine[PymunkRecipe]):
    """Adapter for pymunk (Chipmunk2D)."""

    name = "pymunk"
    package = "pymunk"
    loop = "engines.pymunk_adapter.loop"
    engine_calls = ("pymunk.Space.step",)
    oldest = "7.0"
    effort_unit = "iterations"
    abilities = Abilities(
        readouts={
            Channel.POSITION: ReadOut("Body.position, angle"),
            Channel.VELOCITY: ReadOut("Body.velocity, angular_velocity", instant="half a step after the positions"),
            Channel.ACCELERATION: ReadOut("difference of Body.velocity over the step"),
            Channel.TORQUE: ReadOut(
                "SimpleMotor.impulse (linear: PinJoint.impulse) over the step, less an applied torque or force that "
                "keeps its sign",
                drive="drive only",
            ),
            Channel.JOINT_FORCE: ReadOut(
                "size of PivotJoint.impulse or GrooveJoint.impulse over the step", drive="without drive"
            ),
        },
        drives=frozenset({Prescribed, Free}),
        joints=GUIDES,
        loads=LOADS,
        timed_torque=True,
        massless=False,
        drivers=frozenset(DriverKind),
    )
    settings: Mapping[type, Mapping[Setting, PymunkRecipe]] = {
        Prescribed: {Setting.NAIVE: NAIVE, Setting.TUNED: TUNED, Setting.BEST: BEST},
        Free: {Setting.NAIVE: NAIVE, Setting.TUNED: FREE_TUNED, Setting.BEST: FREE_BEST},
    }
    studied: Mapping[str, tuple[str, PymunkRecipe]] = {
        "defaults": ("pymunk's defaults at a fixed step, every read-out at face value", NAIVE),
        **{
            name: (
                ABOUT + (f", extrapolated from the step over {', '.join(map(str, ratios))}" if ratios[1:] else ""),
                PymunkRecipe(ratios=ratios),
            )
            for name, ratios in STUDIED.items()
        },
    }

    def model(self, scene: Scene, recipe: PymunkRecipe) -> Mapping[str, Any]:
        """The scene as plain data by name for pymunk's loop.

        Raises UnsupportedError where its joints, by count, do not leave one degree of freedom.
        """
        layout = exact_layout(scene) if recipe.centred else plain_layout(scene)
        if layout.freedom != 1:
            raise UnsupportedError(
                f"the joints leave {layout.freedom} degrees of freedom by count, where a linkage has one"
            )
        iterations = None  # pymunk's own
        if recipe.effort is not None:
            iterations = [max(1, round(recipe.effort))]
        elif recipe.centred:
            iterations = iterations_for(layout, recipe.remaining)
        lead = min(MOST_LEAD, math.ceil(SETTLED / min(recipe.ratios))) if recipe.centred else 1
        return space_data(scene, layout, centred=recipe.centred) | {
            "iterations": iterations,
            "apart": math.copysign(FULL_TURN / POSES, driver_travel(layout.scene)),
            "lead": lead,
        }
