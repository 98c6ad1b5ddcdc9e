"""An engine that takes time steps, behind the contract: its author writes how a world is built and one pass through it.

Everything else is done here, once: what the engine cannot hold is refused, the scene is put into units of its own, the
motion is cut into intervals and steps, passes are counted, timed, extrapolated and put back into SI.
"""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from contextlib import nullcontext
from dataclasses import dataclass, replace
from importlib import import_module
from typing import Any, ClassVar, Generic, TypeVar

import numpy as np

from analytic.description.law import Law
from analytic.description.linkage import DriverKind
from analytic.errors import LinkproofError, UnknownNameError
from engines.contract import Abilities, History, Method, Outcome, Run, Setting, Signal
from engines.mechanics.joints import scene_size, turn_of_driver
from engines.mechanics.start_check import ability_obstacle, data_obstacle
from engines.mechanics.states import driven, start_motion
from engines.registry import installed_version, silenced, why_unusable
from engines.scene import Channel, Free, Prescribed, Scene
from engines.stepping.intervals import (
    MANY,
    Cost,
    DivergedError,
    Interval,
    Pace,
    UnsupportedError,
    check_step,
    even_intervals,
    intervals,
    run_stepping,
)
from engines.stepping.own_units import OwnUnits, own_units, restored, scaled
from engines.stepping.richardson import Pass, extrapolate, weights

LARGEST_EFFORT = 2.0**31  # of an iteration count


@dataclass(frozen=True, kw_only=True)
class Recipe(Pace):
    """Instructions for stepping a scene: the samples' pace, and the runs at fractions of their step.

    ``ratios`` are the steps between two samples, of one run each; several are extrapolated, the error's terms
    having the ``orders`` as powers of the step. ``effort`` is the constraint solver's, None for the engine's own.
    ``graded`` lets slow parts have longer steps, ``restarted`` begins every segment of a prescribed motion anew:
    without it the whole motion is one interval. ``at_kinks`` ends a step at every kink of a released crank's torque
    over time, for an integrator of high order that begins anew at no cost. ``in_own_units`` counts lengths and
    masses in units of the scene, its size being ``size``: where an engine's tolerance is a length, a larger one
    makes it tighter.
    """

    ratios: tuple[int, ...] = (1,)
    orders: tuple[int, ...] = (2, 4, 6, 8)
    effort: float | None = None
    graded: bool = False
    restarted: bool = True
    at_kinks: bool = False
    in_own_units: bool = True
    size: float = 1.0

    def parts(self, scene: Scene) -> list[Interval]:
        """The scene's motion as intervals in order, each in basic steps.

        Of a linear drive a travel of the scene's size counts as a turn. A free drive has one interval, cut at the kinks
        of its torque if ``at_kinks``.
        """
        drive, pace = scene.drive, replace(self, turn=turn_of_driver(scene))
        if isinstance(drive, Free):
            longest = pace._longest_step(drive.pace or _start_pace(scene))
            if drive.over_time is not None and self.at_kinks:
                return even_intervals(drive.duration, longest, 1, drive.over_time.times)
            return even_intervals(drive.duration, longest, self.least_steps)
        motion = drive.motion
        longest = pace._longest_step(motion.peak_speed)
        if not self.restarted:
            return even_intervals(motion.duration, longest, self.least_steps * min(len(motion.segments), MANY))
        return intervals(motion, pace if self.graded else replace(pace, step=longest, steps_per_turn=0.0))

    def _longest_step(self, speed: float) -> float:
        """The longest step, s, at a driver ``speed``, rad/s or m/s, by ``step`` and ``steps_per_turn``.

        At the speed 0, or without steps per turn, ``step`` alone counts, which may be infinite.
        """
        turn = self.turn / (self.steps_per_turn * speed) if self.steps_per_turn and speed else math.inf
        return min(self.step, turn)


def _start_pace(scene: Scene) -> float:
    """Pace of a free driver for the choice of steps, rad/s or m/s, from its start: |speed| + √(|acceleration| · size).

    The size is 1 for a crank, the scene's for a linear driver.
    """
    _, speed, acceleration = (float(value[0]) for value in driven(scene, *start_motion(scene)))
    size = 1.0 if scene.driver_kind is DriverKind.CRANK else scene_size(scene)
    return abs(speed) + math.sqrt(abs(acceleration) * size)


World = TypeVar("World")
R = TypeVar("R", bound=Recipe)


@dataclass(frozen=True)
class Course(Generic[R]):
    """One requested pass: the ``parts`` of the motion in ``ratio`` steps to a sample, recording ``channels``.

    ``cost`` takes steps beside the regular ones and ``details`` of what the solver did.
    """

    recipe: R
    parts: Sequence[Interval]
    ratio: int
    channels: frozenset[Channel]
    cost: Cost


class SteppedEngine(ABC, Generic[World, R]):
    """An adapter that needs only ``build`` and ``follow``.

    ``package`` is imported; it is installed as ``distribution``, if that has another name. ``oldest`` is the first
    version that will do; ``settings`` are the recipes by drive, ``studied`` what each method is in one sentence and its
    recipe, the newcomer's first. ``engine_calls`` are the functions in which the engine works while it steps, by dotted
    name, ``callback_calls`` those that give it functions of the adapter's to call back: from them a benchmark has the
    adapter's own share of the time. ``weights`` are those of an extrapolation's runs, unless a test plants an error in
    them.
    """

    name: ClassVar[str]
    is_control: ClassVar[bool] = False
    package: ClassVar[str]
    distribution: ClassVar[str] = ""
    oldest: ClassVar[str] = ""
    effort_unit: ClassVar[str] = ""
    abilities: ClassVar[Abilities]
    settings: Mapping[type, Mapping[Setting, R]]
    studied: Mapping[str, tuple[str, R]]
    engine_calls: ClassVar[tuple[str, ...]] = ()
    callback_calls: ClassVar[tuple[str, ...]] = ()
    chatters: ClassVar[bool] = False  # whether the engine writes to the terminal
    weights = staticmethod(weights)

    @abstractmethod
    def build(self, scene: Scene, recipe: R) -> World:
        """The engine's own model of a scene in its start state; raises UnsupportedError for what it cannot hold.

        The scene is in SI or, as the recipe says, in units of its own.
        """

    @abstractmethod
    def follow(self, world: World, course: Course[R]) -> History:
        """One pass through a world just built, which may be used up by it, in the units it was built in.

        Passes of different ``ratio`` have the same sample times. Raises DivergedError where there is no history to hand
        back.
        """

    def refusal(self, scene: Scene) -> str | None:
        """The sentence why a scene is refused for reasons beyond the abilities, else None; by default None."""
        return None

    def obstacle(self, scene: Scene) -> str | None:
        """The reason, in one sentence, why a scene is not built; None if it is built.

        Tried in turn are the abilities, the scene's data and start, and ``refusal``.
        """
        return (
            ability_obstacle(scene, self.abilities)
            or data_obstacle(scene, massless=self.abilities.massless)
            or self.refusal(scene)
        )

    def altered(self, scene: Scene) -> Scene:
        """The scene to build a world from: the given one, unless a test overrides this to plant an error."""
        return scene

    def version(self) -> str | None:
        """Version of the installed engine, or None where it is not installed."""
        return installed_version(self.distribution or self.package)

    def why_unavailable(self) -> str | None:
        """The reason, with the cure, why the engine cannot be used here; None where it can. Nothing is imported."""
        return why_unusable(self.distribution or self.package, self.name, self.oldest)

    def run(self, scene: Scene, setting: Setting) -> Run:
        """Make one pass, or several that are extrapolated, by the setting's recipe for the scene's drive.

        A drive without this setting, an absent engine, a scene that is refused and a run that diverges are outcomes of
        the Run with their reasons; errors of the code pass.
        """
        recipes = self.settings.get(type(scene.drive), {})
        if setting not in recipes:
            obstacle = ability_obstacle(scene, self.abilities)
            return Run(Outcome.UNSUPPORTED, obstacle or f"{self.name} offers no setting '{setting}' for such a drive")
        return self._run(scene, recipes[setting], {})

    def methods(self, scene: Scene) -> tuple[Method, ...]:
        """The methods in ``studied``, in its order, whatever the scene."""
        return tuple(
            Method(name, about, len(recipe.ratios), recipe.effort, self.effort_unit)
            for name, (about, recipe) in self.studied.items()
        )

    def run_method(self, scene: Scene, method: Method, step: float) -> Run:
        """Run a scene by a method, with its effort, at a longest step, s; what prevents it is an outcome.

        Raises UnknownNameError for another engine's method, LinkproofError for a step or an effort out of bounds.
        """
        check_step(step)
        if method.name not in self.studied:
            raise UnknownNameError(f"method of {self.name}", method.name, list(self.studied))
        if method.effort is not None and not 0.0 < method.effort < LARGEST_EFFORT:
            raise LinkproofError(
                f"effort of method '{method.name}': expected a positive {self.effort_unit}, got {method.effort:g}"
            )
        return self._run(scene, self.studied_recipe(method, step), {"method": method.name})

    def studied_recipe(self, method: Method, step: float) -> R:
        """The recipe of a method at a longest step, s, whatever the speed, and with the method's effort.

        Raises KeyError for another engine's method.
        """
        _, recipe = self.studied[method.name]
        return replace(recipe, step=step, steps_per_turn=0.0, effort=method.effort)

    def _run(self, scene: Scene, recipe: R, details: dict[str, str | int | float]) -> Run:
        """The run of a scene by a recipe, with ``details`` to report; what prevents it becomes its outcome.

        An engine that chatters is silenced. The engine is imported; errors of that, and of code, pass.
        """
        with silenced() if self.chatters else nullcontext():  # some write when they are imported
            absent = self.why_unavailable()
            if absent is not None:
                return Run(Outcome.UNAVAILABLE, absent)
            import_module(self.package)  # whose time is not that of a model
            reason = self.obstacle(scene)
            if reason is not None:
                return Run(Outcome.UNSUPPORTED, reason)
            cost = Cost(details=details)
            return run_stepping(cost, lambda: self._history(scene, recipe, cost))

    def _history(self, scene: Scene, recipe: R, cost: Cost) -> History:
        """The history of a scene, in SI, extrapolated from all passes of the recipe; fills in ``cost``.

        Raises DivergedError or UnsupportedError, as ``follow`` and ``build`` do.
        """
        given, units, courses = self.planned(scene, recipe, cost)
        passes = [self._pass(given, course) for course in courses]
        parts = courses[0].parts
        longest = max(part.step for part in parts)
        cost.passes = tuple(longest * each.step for each in passes)
        cost.details["steps"] = " ".join(str(ratio * sum(part.samples for part in parts)) for ratio in recipe.ratios)
        cost.details["longest_step"] = longest / max(recipe.ratios)
        if len(parts) > 1:
            cost.details["parts"] = len(parts)
        history = extrapolate(passes, recipe.orders, self.weights)
        return restored(history, units, scene.driver_kind) if units else history

    def planned(self, scene: Scene, recipe: R, cost: Cost) -> tuple[Scene, OwnUnits | None, list[Course[R]]]:
        """The scene in the units it is stepped in, its own units or None for SI, and the passes to take.

        There is one pass for each of the recipe's ratios. They share ``cost`` and record those channels of the scene
        that the engine offers, a free drive's no torque.
        """
        offered = scene.channels & frozenset(self.abilities.readouts)
        channels = offered if isinstance(scene.drive, Prescribed) else offered - {Channel.TORQUE}
        scene = self.altered(scene)
        units = own_units(scene, recipe.size) if recipe.in_own_units else None
        given = scaled(scene, units) if units else scene
        parts = recipe.parts(given)
        return given, units, [Course(recipe, parts, ratio, channels, cost) for ratio in recipe.ratios]

    def _pass(self, scene: Scene, course: Course[R]) -> Pass:
        """Build a world, take one pass through it, and add the time and steps of both to the course's cost.

        The Pass has the step 1 / ratio. Errors of ``build`` and ``follow`` pass.
        """
        with course.cost.timing("setup_seconds"):
            world = self.build(scene, course.recipe)
        with course.cost.timing("seconds"):
            history = self.follow(world, course)
        course.cost.steps += course.ratio * sum(part.samples for part in course.parts)
        return Pass(1.0 / course.ratio, history)


# An engine whose build and steps are a module of their own, which ``compare --script`` can write down as it is.


# A law over φ in plain data: its components, or its knots, the cubics from each on, and its period, rad, 0 of a travel.
PlainLaw = list[float] | tuple[list[float], list[Any], float]


class LoopEngine(SteppedEngine[Any, R]):
    """An adapter that describes a scene in plain data; ``loop`` names the module that runs it.

    The module imports NumPy and its engine alone and takes plain data: numbers, text, None, and lists, tuples and
    dictionaries of these. It has two functions, both of which raise ArithmeticError, with the reason, for what the
    engine refuses or gives up:

    * ``build(model)``: the engine's own model in its start state, from what the adapter's ``model`` describes;
    * ``follow(world, course)``: one pass through it; returns times and values by channel, forces by joint under
      ``"joint_force"``, as :class:`engines.contract.History` has them.

    A course has ``parts``, the steps ``ratio`` to a sample, the ``channels`` to record, and ``details`` for what a loop
    reports. A part has ``start``, ``end``, ``samples``, ``after_jump`` and its ``segment`` of the motion: when that
    starts and the polynomial of the driver's coordinate from then on, lowest power first; None for a free driver.
    """

    loop: ClassVar[str]

    @abstractmethod
    def model(self, scene: Scene, recipe: R) -> Mapping[str, Any]:
        """The scene as plain data by name, NumPy's arrays among them, for the loop's ``build``, in its units."""

    def build(self, scene: Scene, recipe: R) -> Any:  # noqa: ANN401 - the loop's
        """The loop's world, built from the plain data of the scene.

        An ArithmeticError of the loop is raised as UnsupportedError, one of a subclass, as ZeroDivisionError, as it is.
        Raises TypeError for a model of other data.
        """
        model = plain(self.model(scene, recipe))
        try:
            return import_module(self.loop).build(model)
        except ArithmeticError as error:
            raise _run_error(error, UnsupportedError) from error

    def follow(self, world: Any, course: Course[R]) -> History:  # noqa: ANN401
        """The history of a pass, from the loop's samples, in the world's units.

        The course's cost takes the ``details`` that the loop reports. An ArithmeticError of the loop is raised as
        DivergedError, one of a subclass, as ZeroDivisionError, as it is.
        """
        given = plain_course(course)
        try:
            samples = import_module(self.loop).follow(world, given)
        except ArithmeticError as error:
            raise _run_error(error, DivergedError) from error
        finally:
            course.cost.details.update(given["details"])
        forces = {name: _read_signal(pair) for name, pair in samples.pop(Channel.JOINT_FORCE.value, {}).items()}
        return History(**{name: _read_signal(pair) for name, pair in samples.items()}, joint_force=forces)


def _run_error(error: ArithmeticError, kind: type[Exception]) -> Exception:
    """A plain ArithmeticError as a ``kind``, which ends the run, with its text; one of a subclass unchanged."""
    return kind(str(error)) if type(error) is ArithmeticError else error  # a division by zero is an error of the loop


def _read_signal(pair: tuple[Any, Any]) -> Signal:
    """A pair of times, s, and values, as a loop returns them, as a signal."""
    time, values = pair
    return Signal(np.asarray(time), np.asarray(values))


def plain_course(course: Course[Any]) -> dict[str, Any]:
    """A course as the dictionary that loops take: ``ratio``, ``channels``, ``parts``, and ``details`` to fill in.

    A part has ``start`` and ``end``, s, ``samples``, ``after_jump`` and ``segment``: that one's start, s, and
    coefficients of φ, lowest power first; None for a free driver.
    """
    parts = [
        {
            "start": part.start,
            "end": part.end,
            "samples": part.samples,
            "after_jump": part.after_jump,
            "segment": part.segment and (part.segment.start, [*map(float, part.segment.coefficients)]),
        }
        for part in course.parts
    ]
    channels = [channel for channel in Channel if channel in course.channels]
    given = {"ratio": course.ratio, "channels": channels, "parts": parts, "details": {}}
    return dict(plain(given))


def plain_law(law: Law) -> PlainLaw:
    """A law as plain data for loops: a list of its components, N or N m, or a tuple of knots, cubics and period.

    It is as ``law_values`` of ``engines.shared_loop`` takes it; the period is 0 if it does not repeat.
    """
    return law.values.tolist() if law.angles is None else (*law.pieces(), law.period or 0.0)


def plain(value: Any) -> Any:  # noqa: ANN401 - one line for each type
    """A copy as Python literals, arrays as lists, whose ``repr`` is its source; raises TypeError for other data."""
    if isinstance(value, (np.ndarray, np.generic)):
        return plain(value.tolist())
    if isinstance(value, Mapping):
        return {plain(key): plain(each) for key, each in value.items()}
    if isinstance(value, (list, tuple)):
        return (list if isinstance(value, list) else tuple)(map(plain, value))
    if isinstance(value, str):
        return str.__str__(value)  # not what a subclass shows of itself
    if value is None or type(value) in (bool, int, float, complex):
        return value
    raise TypeError(f"expected plain data for a loop, got {type(value).__name__}")
