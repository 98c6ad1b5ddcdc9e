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
from typing import TYPE_CHECKING, Final

import numpy as np
from numpy.typing import NDArray

from analytic.description.linkage import DriverKind
from engines.contract import Abilities, History, ReadOut, Setting
from engines.mechanics.driver import driven
from engines.mechanics.states import start_motion
from engines.pymunk_adapter.layout import Gear, exact_layout, plain_layout
from engines.pymunk_adapter.loads import StepLoads
from engines.pymunk_adapter.recording import Clock, Recording
from engines.pymunk_adapter.solver import iterations_for, way
from engines.pymunk_adapter.space import PymunkWorld, build_world
from engines.pymunk_adapter.stepping import calls, march
from engines.scene import GUIDES, LOADS, Channel, Free, Prescribed, Scene
from engines.stepping.driver import UnsupportedError
from engines.stepping.histories import joined
from engines.stepping.stepped_engine import Course, Recipe, SteppedEngine

if TYPE_CHECKING:
    import pymunk

Array = NDArray[np.float64]

# Steps at a start or a jump that have no good impulses to begin with, and how many times as many iterations they get.
COLD_STEPS, COLD = 4, 10

# Steps after which that has no effect on the forces any more, and samples that are given up for it at most.
SETTLED, MOST_LEAD = 10, 3

WHOLE = 1.0 + 1e-9  # of the way that was looked at; a motion that goes on comes by the same angles again

MOTOR = "the motor"  # beside the names of joints


@dataclass(frozen=True, kw_only=True)
class PymunkRecipe(Recipe):
    """``centred``: to second order, else as a newcomer would; ``effort`` are iterations in a step.

    Where none are given, a centred run has as many as leave the share ``remaining`` of an impulse's change wrong.
    """

    centred: bool = True
    remaining: float = 0.1
    even: int = 1000
    orders: tuple[int, ...] = (2, 3, 4, 5, 6, 7, 8)  # the read-outs are centred, the closing of the joints is not


NAIVE: Final = PymunkRecipe(step=1e-4, least_steps=1, centred=False, in_own_units=False)
# Chosen from a sweep over the catalogue's five mechanisms, quintic run-up to 1000 rpm. Steps per turn and the share
# left by the solver; worst error of torque, reduced inertia and joint forces over their peaks; time of all five:
#   2000, 5 %: 5.9e-5, 5.8e-5, 6.8e-5, 0.9 s    6000, 20 %: 5.0e-4, 4.2e-6, 9.5e-4, 1.9 s
#   6000, 5 %: 6.6e-6, 4.2e-6, 7.6e-6, 2.5 s    6000, 1 %: 6.7e-6, 4.2e-6, 7.6e-6, 2.9 s
#  10800, 5 %: 2.0e-6, 1.3e-6, 2.4e-6, 8.3 s    Some random linkages ask for more than 6000.
TUNED: Final = PymunkRecipe(steps_per_turn=400, ratios=(21,), least_steps=100, remaining=0.05, even=100)
BEST: Final = PymunkRecipe(steps_per_turn=240, ratios=(3, 5, 7, 9), least_steps=100, remaining=0.001)

# A free crank adds its error of phase up over all turns. The slotted take-up driven for 160 turns, errors of angle and
# linkage speed over their peaks: 2700 steps a turn 3.7e-7, 5.0e-4 in 5 s; 6600 4.9e-8, 6.6e-5 in 9 s; the runs of
# ``best`` 1.4e-11, 1.2e-7 in 15 s. What the solver leaves does not show.
FREE_TUNED: Final = PymunkRecipe(steps_per_turn=200, ratios=(33,), least_steps=1000, remaining=0.2)
FREE_BEST: Final = PymunkRecipe(steps_per_turn=240, ratios=(7, 11, 15), least_steps=1000, remaining=0.2)

ABOUT: Final = "second order by unbiased joints, mean crank speeds and centred read-outs"
STUDIED: Final = {"centred": (1,), "centred x2": (1, 3), "centred x3": (1, 3, 5), "centred x4": (1, 3, 5, 7)}


class PymunkEngine(SteppedEngine[PymunkWorld, PymunkRecipe]):
    """Adapter for pymunk (Chipmunk2D)."""

    name = "pymunk"
    package = "pymunk"
    oldest = "7.0"
    work_unit = "constraint visits"
    effort_unit = "iterations"
    abilities = Abilities(
        readouts={
            Channel.POSITION: ReadOut("Body.position, angle"),
            Channel.VELOCITY: ReadOut("Body.velocity, angular_velocity", instant="half a step after the positions"),
            Channel.ACCELERATION: ReadOut("difference of Body.velocity over the step"),
            Channel.TORQUE: ReadOut(
                "SimpleMotor.impulse (linear: PinJoint.impulse) over the step, less an applied torque or force that "
                "keeps its sign; of a driven crank, but in naive, less a share that is computed, its added flywheel's",
                drive="the drive's own",
            ),
            Channel.JOINT_FORCE: ReadOut(
                "size of PivotJoint.impulse or GrooveJoint.impulse over the step", drive="the drive exerts no force"
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

    def build(self, scene: Scene, recipe: PymunkRecipe) -> PymunkWorld:
        layout = exact_layout(scene) if recipe.centred else plain_layout(scene)
        if layout.freedom != 1:
            raise UnsupportedError(
                f"the joints leave {layout.freedom} degrees of freedom by count, where a linkage has one"
            )
        world = build_world(layout, plain=not recipe.centred)
        if recipe.effort is not None:
            world.iterations[:] = max(1, round(recipe.effort))
        elif recipe.centred:
            world.iterations[:] = iterations_for(scene, layout, recipe.remaining, recipe.even)
        return world

    def follow(self, world: PymunkWorld, course: Course[PymunkRecipe]) -> History:
        centred = course.recipe.centred
        clocks = clocks_of(course)
        read = joints_of(world) if Channel.JOINT_FORCE in course.channels else {}
        if world.motor is not None and Channel.TORQUE in course.channels:
            read[MOTOR] = world.motor
        on = calls(world, read.values())
        rates = crank_rates(clocks, centred)
        given_to_motor = -rates if world.line is None else world.line.base + travels(world, clocks, rates)
        set_off(world, clocks[0], float(rates[0]))
        fewest, most = (round(bound(world.iterations)) for bound in (min, max))
        course.cost.details["iterations"] = most if fewest == most else f"{fewest} to {most}"
        loads = StepLoads(world, ahead=centred)
        iterations = iterations_in(world, clocks, rates)
        recordings, start = [], 0
        for clock, later in zip(clocks, [*clocks[1:], clocks[-1]], strict=True):
            count = clock.steps
            coming = given_to_motor[start + centred : start + centred + count].tolist()
            first, *marks = clock.marks(course.channels).tolist()
            if first:
                on.look()
            given = iterations[start : start + count]
            *plan, last = zip(coming, given.tolist(), marks, strict=True)
            impulses = march(on, clock.fine, plan, loads)
            impulses += march(on, _change_of_step(world, clock, later), [last], loads)
            columns = np.array(impulses).reshape(-1, len(read) or 1).T / clock.fine
            forces = dict(zip(read, columns, strict=False))  # there are none where nothing is read
            torque = forces.pop(MOTOR, np.zeros(0))
            if MOTOR in read and centred:
                gained = np.diff(rates)[start + clock.loaded - 1] / clock.fine
                torque = world.offset - torque - world.layout.flywheel * gained
            seen = on.collected().copy()
            recordings.append(Recording(clock, world.layout, course.channels, seen, torque, forces))
            course.cost.solver_work += int(given.sum()) * len(world.space.constraints)
            start += count
        with np.errstate(all="ignore"):
            return joined([recording.history() for recording in recordings])


def clocks_of(course: Course[PymunkRecipe]) -> list[Clock]:
    """What is looked at in every part of a course."""
    recipe, parts = course.recipe, course.parts
    lead = min(MOST_LEAD, math.ceil(SETTLED / min(recipe.ratios)))
    return [Clock(part, course.ratio, part is parts[-1], recipe.centred, lead) for part in parts]


def joints_of(world: PymunkWorld) -> dict[str, pymunk.Constraint]:
    """The constraints that are the scene's joints, by name."""
    inner, pairs = world.layout.inner, zip(world.layout.holds, world.constraints, strict=True)
    return {hold.name: joint for hold, joint in pairs if not isinstance(hold, Gear) and hold.name not in inner}


def crank_rates(clocks: list[Clock], centred: bool) -> Array:
    """Speed of the crank in every step and one more, rad/s; zeros for a free crank.

    It is the mean over the step, exact by Gauss-Legendre quadrature, or a newcomer's: that at the step's start.
    """
    result = []
    for clock in clocks:
        segment, steps = clock.part.segment, np.arange(clock.steps + clock.last)
        if segment is None:
            result.append(np.zeros(len(steps)))
            continue
        order = (len(segment.coefficients) + 1) // 2
        nodes, shares = np.polynomial.legendre.leggauss(order) if centred else (-np.ones(1), np.full(1, 2.0))
        result.append(segment.value(clock.times(steps[:, None], 0.5 * (nodes + 1.0)), 1) @ (0.5 * shares))
    return np.concatenate(result)


def travels(world: PymunkWorld, clocks: list[Clock], rates: Array) -> Array:
    """φ of a linear drive after every step and one more, m, at these mean speeds."""
    steps = np.concatenate([np.full(clock.steps + clock.last, clock.fine) for clock in clocks])
    return np.asarray(world.layout.scene.crank_angle + np.cumsum(rates * steps))


def set_off(world: PymunkWorld, clock: Clock, rate: float) -> None:
    """Give the parts their velocities: those that bring them through the first step, or a newcomer's.

    The latter are those of the start. The former are the motion's tangent there, at the speed of the middle of the
    step: a step along it opens the joints as every later step does, and so the next one closes them as later ones do.
    """
    bodies = world.layout.scene.bodies
    motion = np.array(
        [[(*b.velocity, b.angular_velocity), (*b.acceleration, b.angular_acceleration)] for b in bodies], dtype=float
    )
    _, speed, gain = (float(value[0]) for value in driven(world.layout.scene, *start_motion(world.layout.scene)))
    velocity = motion[:, 0]
    if clock.centred:
        middle = speed + 0.5 * clock.fine * gain if world.motor is None else rate
        velocity = motion[:, 0] / speed * middle if speed else motion[:, 1] / (gain or 1.0) * middle
    for body, part, (x, y, turn) in zip(world.bodies, bodies, velocity.tolist(), strict=True):
        body.velocity, body.angular_velocity = (x, y), 0.0 if part.inertia is None else turn


def _change_of_step(world: PymunkWorld, clock: Clock, later: Clock) -> float:
    """The step with which to take the last one of a part: that of the part to follow, the way being that of its own.

    pymunk closes the joints by the step that it is given, while it is the next one that moves the bodies on.
    """
    if not clock.centred or math.isclose(clock.fine, later.fine):
        return clock.fine
    for body in world.bodies:
        body.velocity *= clock.fine / later.fine
        body.angular_velocity *= clock.fine / later.fine
    return later.fine


def iterations_in(world: PymunkWorld, clocks: list[Clock], rates: Array) -> NDArray[np.intp]:
    """Iterations in every step."""
    angles = np.cumsum(rates[:-1] * np.concatenate([np.full(clock.steps, clock.fine) for clock in clocks]))
    share = angles / (way(world.layout.scene) or 1.0)
    share = np.clip(share, 0.0, 1.0) if np.ptp(share) <= WHOLE else share % 1.0
    result = np.interp(share, np.linspace(0.0, 1.0, len(world.iterations)), world.iterations).astype(np.intp)
    start = 0
    for clock, former in zip(clocks, [None, *clocks], strict=False):
        unlike = former is None or clock.part.after_jump or not math.isclose(clock.fine, former.fine)
        if clock.centred and unlike:
            first = max(0, start - 1)
            result[first : first + COLD_STEPS] *= COLD
        start += clock.steps
    return result
