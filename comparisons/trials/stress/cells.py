"""Cells of the stress maps: one value of one axis (``axes.toml``) in one row, engine and usage, its case and its scene.

A cell can be made again on its own, and is judged: is the motion right, and if not, did a check flag it?
``stress.campaign`` finds the borders.
"""

from __future__ import annotations

import math
import time
import tomllib
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from enum import StrEnum
from functools import cache, lru_cache
from pathlib import Path
from typing import Any

import numpy as np
from pydantic import ConfigDict, TypeAdapter

from analytic.description import changes
from analytic.description.crank_motion import REGIMES, RPM, CrankMotion, Segment, crank_motion
from analytic.description.linkage import Linkage, ReleasedRegime, Vector
from analytic.description.loading import catalogue, load
from analytic.dynamics.reduced import damping_coefficient, reduced_inertia
from analytic.errors import LinkproofError, UnknownNameError
from analytic.kinematics.mechanism import Mechanism
from comparisons.motion.case import Case, case_of_file_regime
from comparisons.trials.campaign.campaign import compared
from comparisons.trials.invariants.checks import HALF_TURN
from comparisons.trials.judging.limits import OWN, grouped
from comparisons.trials.judging.quantities import all_quantities
from comparisons.trials.judging.records import Error, RunRecord, Verdict, run_of
from comparisons.trials.judging.signal_errors import signal_errors
from comparisons.trials.observed_motion import ObservedMotion
from comparisons.trials.runs.plugins import engine
from comparisons.trials.runs.run_engine import Lost, blamed_on, run_engine
from engines.contract import Engine, Outcome, Setting, StudiedEngine
from engines.contract import Run as EngineRun
from engines.mechanics.joints import scene_size
from engines.registry import why_unavailable
from engines.scene import LEVELS, Channel, Scene

# A motion is *wrong* where a position or velocity of any body, the torque of a driven crank or the force in a joint is
# off by more than this share of its scale, or where so much of the motion has no samples.
WRONG = 1e-2
JUDGED = (Channel.POSITION, Channel.VELOCITY, Channel.TORQUE, Channel.JOINT_FORCE)
LARGEST = 1e300  # stands for nan and infinity, which JSON cannot hold
# A joint is as far open as it is: over its limit that is a deviation from the truth, no inference that may be false.
MEASURED = ("joint_gap",)


class StressVerdict(StrEnum):
    """The verdict of a cell.

    WITHIN, OVER and ALARM are right motions: with errors within limits, over one, or flagged by a check all the same;
    wrong ones are CAUGHT by a check or MISSED by all.
    """

    WITHIN = "within limit"
    OVER = "over limit"
    CAUGHT = "caught"
    MISSED = "missed"
    ALARM = "alarm"
    DIVERGED = "diverged"
    TIMED_OUT = "timed-out"
    CRASHED = "crashed"
    ADAPTER_ERROR = "adapter-error"
    SUITE_ERROR = "suite-error"
    UNSUPPORTED = "unsupported"
    UNAVAILABLE = "unavailable"


@dataclass(frozen=True, kw_only=True)
class Cell(RunRecord):
    """One run of a map, before it is made and after; its setting may be a method's name.

    ``row`` is a row's label, ``value`` that of the axis. Its errors are the quantity nearest to its limit, its
    invariants those that failed, or else the nearest. ``wrong`` and ``reason`` are in the words of a reader;
    ``differing`` is what differs from a plain run-up of the linkage. ``spent`` is everything: reference, set-up,
    stepping, judging, s.
    """

    axis: str
    row: str
    value: float
    verdict: StressVerdict = StressVerdict.UNAVAILABLE
    reason: str = ""
    wrong: str = ""
    differing: Mapping[str, Any] = field(default_factory=dict)
    spent: float = 0.0

    @property
    def line(self) -> tuple[str, str, str, str]:
        """Axis, row, engine and setting: the key that it shares with cells of other values on its line."""
        return (self.axis, self.row, self.engine, self.setting)

    @property
    def key(self) -> str:
        """The key of the cell as a command takes it: AXIS/ROW/VALUE/ENGINE/USAGE."""
        return f"{self.axis}/{self.row}/{self.value:.6g}/{self.engine}/{self.setting}"

    @property
    def command(self) -> str:
        """The command that runs the cell again."""
        return f"linkproof stress '{self.key}'"

    @property
    def data(self) -> dict[str, Any]:
        """The cell as JSON-ready data by column, its ``command`` added, without curves."""
        return {**super().data, "command": self.command}


@cache
def tables() -> dict[str, Any]:
    """The table of the maps' axes, "axis", and the words for each check that may fail, "alarms", read once."""
    return tomllib.loads(Path(__file__).with_name("axes.toml").read_text(encoding="utf-8"))


LINKAGES = Path(__file__).with_name("linkages")
RELEASED, REVERSAL = "released", "reversal"
# Of the time constant Jeq/b that a released motion lasts: each takes the closed form a window of its own.
MOST_RELAXATIONS = 1e4
GOLDEN_ANGLE = math.pi * (3.0 - math.sqrt(5.0))  # directions that no two bodies share


@dataclass(frozen=True)
class Conditions:
    """The conditions of a cell: scene and steps; the defaults are a smooth run-up of the unchanged linkage.

    A row of a map, its ``label``, is all conditions but the one that varies; ``most`` is the largest value of that one
    that makes sense, and ``quick`` rows are in a quick map too. What an engine alone is given tells no cases apart.

    ``linkage`` is a catalogue name, or a file's among the stress maps' own. ``speed`` is in rpm, ``start_angle`` in
    degrees; ``motion`` is a regime's name, ``reversal`` or ``released``. A ramp lasts twice ``ramp_turns``, the speed
    is held for ``hold_turns``, a reversal lasts ``reversal_turns``, all in turns at ``speed``, as is ``turns``, the
    duration of a constant speed or of a released crank; ``spinning`` says whether it is released at that speed or at
    rest, ``torque`` (N m) is then on it. ``point`` of ``link`` (or of the ground) is put at ``at + excess * slope``, m.
    ``mass_factor`` multiplies mass and inertia of ``link``, ``damper_factor`` what rotary dampers damp; 0 takes all
    dampers away. ``scaled`` names what is multiplied by ``scale``, ``load`` the kind of loads that remain (springs or
    dampers), times ``load_factor``. ``disturbed``, "position" or "velocity", says which of the start is off by
    ``disturbance``, "" neither. ``steps_per_turn`` and ``effort`` are a method's.
    """

    __pydantic_config__ = ConfigDict(extra="forbid")

    linkage: str
    label: str = field(default="", compare=False)
    quick: bool = field(default=False, compare=False)
    most: float = field(default=math.inf, compare=False)
    speed: float = 1000.0
    motion: str = "run-up-quintic"
    start_angle: float = 0.0
    ramp_turns: float = 2.0
    hold_turns: float = 1.0
    reversal_turns: float = 1.0
    turns: float = 1.0
    spinning: bool = True
    torque: float = 0.0
    link: str = ""
    mass_factor: float = 1.0
    point: str = ""
    at: Vector = (0.0, 0.0)
    slope: Vector = (0.0, 0.0)
    excess: float = 0.0
    scaled: str = ""
    scale: float = 1.0
    load: str = ""
    load_factor: float = 1.0
    damper_factor: float = 1.0
    disturbed: str = field(default="", compare=False)
    disturbance: float = field(default=0.0, compare=False)
    steps_per_turn: float = field(default=0.0, compare=False)
    effort: float = field(default=0.0, compare=False)

    @property
    def differing(self) -> dict[str, Any]:
        """The conditions that differ from the defaults, by name, JSON-ready; not ``label``, ``quick``, ``most``."""
        of_row = {"label", "quick", "most"}
        return dict(TypeAdapter(Conditions).dump_python(self, mode="json", exclude_defaults=True, exclude=of_row))

    @property
    def rate(self) -> float:
        """The speed, rad/s, in scaled time where times are scaled."""
        return self.speed * RPM / (self.scale if self.scaled == "time" else 1.0)

    @property
    def step(self) -> float:
        """The step, s, of a method at this speed, by ``steps_per_turn``, which must not be 0."""
        return 2.0 * math.pi / self.rate / self.steps_per_turn


def linkage(conditions: Conditions) -> Linkage:
    """The linkage of a cell, changed as its conditions say, under its original name.

    Raises LinkproofError for a linkage that cannot be loaded or changed so, KeyError for a link that it lacks.
    """
    name = conditions.linkage
    changed = load(name if name in catalogue() else str(LINKAGES / f"{name}.toml"))
    if conditions.mass_factor != 1.0:
        changed = changes.multiplied(changed, conditions.mass_factor, "mass", "inertia", under=f"{conditions.link}.")
    if conditions.point:
        x, y = (at + conditions.excess * slope for at, slope in zip(conditions.at, conditions.slope, strict=True))
        changed = changes.with_point(changed, conditions.link, conditions.point, (x, y))
    if conditions.damper_factor:
        changed = changes.multiplied(changed, conditions.damper_factor, "turn_damping")
    else:
        changed = changes.without(changed, "dampers")
    if conditions.load:
        changed = changes.without(changed, *({"springs", "dampers"} - {conditions.load}))
        changed = changes.multiplied(changed, conditions.load_factor, "stiffness", "damping", "turn_damping")
    factors = {conditions.scaled: conditions.scale} if conditions.scaled else {}
    return changes.scaled(changed, **factors) if factors else changed


def motion(conditions: Conditions) -> CrankMotion:
    """The crank motion of a cell whose crank is driven, at a speed that is not 0.

    Raises LinkproofError for a wrong regime or number; those of a reversal are not checked.
    """
    turn, start = 2.0 * math.pi / conditions.rate, math.radians(conditions.start_angle)
    if conditions.motion == REVERSAL:
        return reversal(conditions.rate, start, conditions.hold_turns * turn, conditions.reversal_turns * turn)
    constant = conditions.motion == "constant-speed"
    return crank_motion(
        conditions.motion,
        speed=conditions.rate,
        ramp_time=turn * (conditions.turns if constant else 2.0 * conditions.ramp_turns),
        hold_time=0.0 if constant else turn * conditions.hold_turns,
        start_angle=start,
    )


def reversal(speed: float, start_angle: float, hold: float, change: float) -> CrankMotion:
    """A motion that turns to the other direction and back, at constant speed before, between and after.

    ``speed`` is in rad/s, ``start_angle`` in rad. Each change takes ``change``, each constant part ``hold``, s. The
    change follows a quintic, so that the acceleration is continuous.
    """
    segments: list[Segment] = []
    time, angle = 0.0, start_angle
    for sense, span, turning in ((1, hold, False), (1, change, True), (-1, hold, False), (-1, change, True),
                                 (1, hold, False)):  # fmt: skip
        rates = [sense * speed]
        if turning:  # ω (1 − 2 (10 x³ − 15 x⁴ + 6 x⁵)) with x = t / span
            rates += [0.0, 0.0] + [-2.0 * sense * speed * c / span**k for k, c in ((3, 10.0), (4, -15.0), (5, 6.0))]
        coefficients = (angle, *(rate / (k + 1) for k, rate in enumerate(rates)))
        segments.append(Segment(time, time + span, coefficients))
        time, angle = time + span, float(segments[-1].value(time + span))
    return CrankMotion(REVERSAL, tuple(segments))


@lru_cache(maxsize=4)
def case(conditions: Conditions) -> Case:
    """The case of a cell's ``conditions``; the last few are kept for its neighbours.

    A long released motion takes seconds to integrate. Raises AssemblyError, or LinkproofError, where there is no motion
    to hold an engine to, KeyError for a link that the linkage lacks.
    """
    mechanism = Mechanism(linkage(conditions))
    if conditions.motion != RELEASED:
        return Case(mechanism, motion(conditions))
    turn = 2.0 * math.pi / conditions.rate
    released = ReleasedRegime(
        name="driven" if conditions.torque else "free",
        torque=conditions.torque,
        start_angle=math.radians(conditions.start_angle),
        start_speed=conditions.rate if conditions.spinning else 0.0,
        duration=conditions.turns * turn,
    )
    lasts = released.duration * float(np.max(damping_coefficient(mechanism.turn) / reduced_inertia(mechanism.turn)))
    if lasts > MOST_RELAXATIONS:
        raise LinkproofError(
            f"'{mechanism.linkage.name}': expected a released crank for {MOST_RELAXATIONS:.0e} times its time constant "
            f"Jeq/b or less, got {lasts:.0e}; damp less"
        )
    return case_of_file_regime(mechanism, released)


def scene(conditions: Conditions, case: Case) -> Scene:
    """The scene of a cell, with every channel and, if its conditions say so, a disturbed start.

    ``case`` is the conditions' own. Positions or velocities of all mass centres are off by as much, each in a direction
    of its own: ``disturbance`` is a share of the scene's size, of velocities of the size times the speed.
    """
    undisturbed, level = case.scene(frozenset(Channel)), conditions.disturbed
    if not level:
        return undisturbed
    size = conditions.disturbance * scene_size(undisturbed) * (abs(conditions.rate) if level == "velocity" else 1.0)
    bodies = []
    for number, body in enumerate(undisturbed.bodies):
        x, y = getattr(body, level)
        off = (size * math.cos(number * GOLDEN_ANGLE), size * math.sin(number * GOLDEN_ANGLE))
        place: dict[str, Any] = {level: (x + off[0], y + off[1])}
        bodies.append(replace(body, **place))
    return replace(undisturbed, bodies=tuple(bodies))


@dataclass(frozen=True)
class Axis:
    """One map: ``vary`` names the field of ``Conditions`` that takes the ``values``, ``label`` what they are.

    ``quick`` are the values of a quick map, ``settings`` and ``methods`` the names of both in which engines are run.
    ``unit`` is that of a solver's effort, where this varies: methods whose effort has another one are left out.
    ``good`` is the value at which the problem is easy; ``seconds`` is what one cell may take. Borders are narrowed down
    where ``narrow`` says so: runs of ever more turns cost more than their exact number is worth.
    """

    __pydantic_config__ = ConfigDict(extra="forbid")

    name: str
    title: str
    about: str
    vary: str
    label: str
    values: tuple[float, ...]
    good: float
    rows: tuple[Conditions, ...]
    quick: tuple[float, ...] = ()
    settings: tuple[str, ...] = ()
    methods: tuple[str, ...] = ()
    unit: str = ""
    seconds: float = 20.0
    narrow: bool = True
    common: Mapping[str, Any] = field(default_factory=dict)  # to all rows

    def row(self, label: str) -> Conditions:
        """The row with this label; raises UnknownNameError for another."""
        rows = {row.label: row for row in self.rows}
        if label not in rows:
            raise UnknownNameError(f"row of axis '{self.name}'", label, rows)
        return rows[label]

    def conditions(self, label: str, value: float) -> Conditions:
        """The conditions of a cell: those of the row with this label, with the axis' value set.

        Raises UnknownNameError for another label.
        """
        varied: dict[str, Any] = {self.vary: value}
        return replace(self.row(label), **varied)

    def chosen_rows(self, *, quick: bool) -> tuple[Conditions, ...]:
        """The rows of the axis: all in a full map, those marked ``quick`` in a quick one."""
        return tuple(row for row in self.rows if row.quick or not quick)

    def chosen_values(self, row: Conditions, *, quick: bool) -> tuple[float, ...]:
        """The values of a row in a full map, or in a quick one, up to the largest that makes sense for it."""
        return tuple(value for value in (self.quick if quick else self.values) if value <= row.most)


@cache
def axes() -> Mapping[str, Axis]:
    """Every axis by its name, in the table's order, read once; raises ValueError for a wrong table."""
    found = [{**axis, "rows": [axis.get("common", {}) | row for row in axis["rows"]]} for axis in tables()["axis"]]
    return {axis.name: axis for axis in TypeAdapter(tuple[Axis, ...]).validate_python(found)}


def chosen_axes(names: Iterable[str]) -> list[Axis]:
    """The axes of these names, by default all, each once, in the table's order; raises UnknownNameError."""
    known, chosen = axes(), list(names)
    for name in chosen:
        if name not in known:
            raise UnknownNameError("axis", name, known)
    return [axis for axis in known.values() if not chosen or axis.name in chosen]


def usages(axis: Axis, adapter: Engine) -> list[str]:
    """Names of the settings and methods in which an engine is run on an axis; ``adapter`` is the engine's.

    Methods that it does not offer, or whose effort has another unit than the axis, are left out; if it raises when
    asked, none is. It is asked with the axis' first row; raises LinkproofError where that has no case.
    """
    if not axis.methods:
        return list(axis.settings)
    given = scene(axis.rows[0], case(axis.rows[0]))
    try:
        methods = adapter.methods(given) if isinstance(adapter, StudiedEngine) else ()
        offered = {method.name: method.effort_unit for method in methods}
    except Exception:  # a cell of every method tells what the adapter raises
        return [*axis.settings, *axis.methods]
    return [*axis.settings, *(n for n in axis.methods if n in offered and axis.unit in ("", offered[n]))]


def cell_at(axis: Axis, row: str, value: float, engine: str, usage: str) -> Cell:
    """A cell before it is run; ``usage`` is a setting or the name of a method, ``row`` a label.

    Raises UnknownNameError for a row that the axis lacks.
    """
    conditions = axis.conditions(row, value)
    names = (conditions.linkage, "", conditions.motion, f"{axis.name}, {row}: {value:.6g}", engine, "", usage)
    return Cell(*names, axis=axis.name, row=row, value=value, differing=conditions.differing)


def cells(chosen: Iterable[Axis], engines: Sequence[str], only: Sequence[str] = (), *, quick: bool) -> list[Cell]:
    """Every cell of these axes in these engines, not yet run; ``only`` keeps the usages of these names, () all.

    A ``quick`` map has fewer rows and values. Raises LinkproofError where there is none, UnknownNameError for an
    engine.
    """
    found = []
    for axis in chosen:
        known = [(name, usage) for name in engines for usage in usages(axis, engine(name)) if usage in only or not only]
        for row in axis.chosen_rows(quick=quick):
            values = axis.chosen_values(row, quick=quick)
            found += [cell_at(axis, row.label, value, *each) for value in values for each in known]
    if not found:
        usage = ", ".join(only) or "any setting"
        raise LinkproofError(f"no stability run matches {usage}: choose other axes or settings")
    return found


def find_cell(key: str) -> Cell:
    """The cell of a key, ``Cell.key``, not yet run; its value may be any number.

    Raises UnknownNameError for an axis, row, engine or usage, or LinkproofError for a text that is no key.
    """
    try:
        name, row, value, engine_name, usage = key.split("/")
    except ValueError:
        form = "AXIS/ROW/VALUE/ENGINE/USAGE"
        raise LinkproofError(f"expected a cell as {form}, got '{key}'; copy one from a list of cells") from None
    (axis,) = chosen_axes([name])
    axis.row(row)
    known = usages(axis, engine(engine_name))
    if usage not in known:
        raise UnknownNameError(f"usage of '{engine_name}' on axis '{name}'", usage, known)
    try:
        return cell_at(axis, row, float(value), engine_name, usage)
    except ValueError:
        raise LinkproofError(f"cell '{key}': expected a number as its value, got '{value}'; correct it") from None


def run_cell(cell: Cell) -> Cell:
    """Make a cell's run in this process and judge it: a copy of the cell with its result.

    One whose engine is absent, or whose case has no motion, is not run and says why. Raises AdapterError where the
    adapter raises or violates the contract.
    """
    begun, adapter = time.perf_counter(), engine(cell.engine)
    conditions = axes()[cell.axis].conditions(cell.row, cell.value)
    with blamed_on(adapter):
        absent = why_unavailable(adapter)
    if absent is not None:
        return replace(cell, verdict=StressVerdict.UNAVAILABLE, reason=absent)
    try:
        true = case(conditions)
    except LinkproofError as error:
        reason = f"the closed form has no motion to hold an engine to: {error}"
        return replace(cell, verdict=StressVerdict.UNSUPPORTED, reason=reason)
    given = scene(conditions, true)
    made = _run_usage(adapter, given, cell.setting, conditions)
    cost = {name: getattr(made, name) for name in ("seconds", "setup_seconds", "steps")}
    result = judged(replace(cell, **cost), true, given, made, adapter)
    return replace(result, spent=time.perf_counter() - begun)


def lost(loss: Lost, cell: Cell) -> Cell:
    """A copy of the cell with the verdict and the reason of a worker that gave no result."""
    return replace(cell, verdict=StressVerdict(loss.outcome.value), reason=loss.reason)


def _run_usage(adapter: Engine, given: Scene, usage: str, conditions: Conditions) -> EngineRun:
    """The engine's run of a scene in a setting, or by a method at the conditions' step and effort.

    An effort of 0 leaves the method its own. Raises AdapterError where the adapter raises or lacks the method,
    AssertionError for an engine without methods.
    """
    if usage in [*Setting]:
        return run_engine(adapter, given, Setting(usage))
    assert isinstance(adapter, StudiedEngine)
    with blamed_on(adapter):
        method = next(method for method in adapter.methods(given) if method.name == usage)
    if conditions.effort:
        method = replace(method, effort=conditions.effort)
    return run_engine(adapter, given, method, conditions.step)


# The verdict of a cell.


def wrong_signals(case: Case, motion: ObservedMotion) -> list[str]:
    """A sentence for each kind of signal farther from the closed form than ``WRONG``; [] if there is none.

    Of all positions, and of all velocities, the worst one is named, and so is the torque and each joint's force. A
    motion with too much time without samples has a sentence, too. Raises LinkproofError where the closed form has no
    value.
    """
    errors = signal_errors(case, motion.scene, motion.history, JUDGED)
    kinds = grouped(((e.read.channel, "" if e.read.channel in LEVELS else e.read.name), e) for e in errors).values()
    worst = [max(kind, key=lambda error: error.largest) for kind in kinds]
    words = [
        f"{error.read.words} off by {error.largest:.2g} {error.scale_words} at {error.worst_time:.3g} s"
        for error in worst
        if error.largest > WRONG
    ]
    missing = _unsampled_share(case, motion)
    return [*words, f"{missing:.2g} of the duration has no samples"] if missing > WRONG else words


def _unsampled_share(case: Case, motion: ObservedMotion) -> float:
    """Share of the duration, of 1, between samples that lie more than half a turn of the true crank apart."""
    time = motion.signal(Channel.POSITION).time
    blind = np.abs(np.diff(case.motion.angle(time))) > HALF_TURN
    return float(np.sum(np.diff(time)[blind])) / case.motion.duration


def judged(cell: Cell, case: Case, scene: Scene, made: EngineRun, adapter: Engine) -> Cell:
    """A copy of the cell with a verdict on its run, by the limits of ``tuned``, or of ``best`` where that was run.

    ``made`` is the run of the scene; one that has not finished gives its outcome. The limits of ``naive`` would hide a
    wrong motion. Where the closed form itself has no motion, no motion is right, and the invariants have to flag it.
    """
    if made.outcome is not Outcome.FINISHED or made.history is None:
        return replace(cell, verdict=StressVerdict(made.outcome.value), reason=made.reason)
    motion, run = ObservedMotion(scene, made.history), _run_to_judge(case, cell.setting)
    with np.errstate(all="ignore"):  # a wrong motion can be any numbers
        try:
            if case.is_prescribed:
                case.check_motion()
            wrong = wrong_signals(case, motion)
            run = compared(case, motion, all_quantities(case).values(), run, adapter)
        except LinkproofError as error:
            wrong = [f"there is no one motion to find ({error})"]
            run = compared(case, motion, (), run, adapter)
        errors, checks = _worst_first(run.errors), _worst_first(run.invariants)
        failed = [check for check in checks if check.outcome != Verdict.PASSED]
        alarms = "; ".join(_alarm_words(check, motion) for check in failed)
    verdict, reason = StressVerdict.WITHIN, ""
    if wrong:
        verdict = StressVerdict.CAUGHT if failed else StressVerdict.MISSED
        reason = f"{'; '.join(wrong)}. {'Flagged: ' + alarms if failed else 'No check flagged it'}"
    elif errors and errors[0].outcome != Verdict.PASSED:
        verdict, reason = StressVerdict.OVER, f"{errors[0].quantity} off by {errors[0].error_max:.2g} of its peak"
    elif any(check.quantity not in MEASURED for check in failed):
        verdict, reason = StressVerdict.ALARM, f"right, yet {alarms}"
    elif failed:
        verdict, reason = StressVerdict.OVER, alarms
    cell = replace(cell, errors=cell.own(errors[:1]), invariants=cell.own(failed or checks[:1]))
    return replace(cell, verdict=verdict, reason=reason, wrong="; ".join(wrong))


def _run_to_judge(case: Case, setting: str) -> RunRecord:
    """A record, of no engine, whose setting and regime select the limits by which the cell is judged.

    The setting is ``best`` or ``tuned``, the regime a run-up for any other prescribed motion.
    """
    regime = case.motion.regime if case.is_prescribed else OWN
    if case.is_prescribed and regime not in REGIMES:
        regime = "run-up" if case.motion.jumps else "run-up-quintic"
    return replace(run_of(case, Setting.BEST if setting == Setting.BEST else Setting.TUNED), regime=regime)


def _worst_first(errors: Iterable[Error]) -> list[Error]:
    """Copies of the judged errors with finite numbers, the one that uses most of its limit first; others are left out.

    ``error_max`` takes the error at jumps where this is larger and over the limit; LARGEST stands for nan and infinity.
    """
    rows = []
    for error in errors:
        if Verdict(error.outcome).judged and error.error_max is not None and error.limit is not None:
            at_jumps = error.error_at_jumps if error.error_at_jumps > error.limit else 0.0
            worst = float(np.nan_to_num(max(error.error_max, at_jumps), nan=LARGEST, posinf=LARGEST))
            rows.append((worst / error.limit, error._replace(error_max=worst, error_rms=None, error_at_jumps=0.0)))
    return [row for _, row in sorted(rows, key=lambda pair: pair[0], reverse=True)]


def _alarm_words(check: Error, motion: ObservedMotion) -> str:
    """The sentence of a check about a motion, with the instant, if known, and, for an open joint, the joint.

    Raises KeyError for a check without words in ``tables``.
    """
    at = check.worst_time
    gaps = motion.joint_gaps(np.array([at or 0.0]))
    joint = max(gaps, key=lambda name: float(gaps[name][0]))
    words = tables()["alarms"][check.quantity].format(error=f"{check.error_max:.2g}", joint=joint)
    return words if at is None else f"{words} at {at:.3g} s"
