"""Cells of the stress maps: one value of one axis (``axes.toml``) in one row, engine and usage, its case and its scene.

A cell can be made again on its own. Each is judged by ``stress.verdict``; ``stress.campaign`` finds the borders.
"""

from __future__ import annotations

import math
import time
import tomllib
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, fields, replace
from functools import cache, lru_cache
from pathlib import Path
from typing import Any

import numpy as np

from analytic.description import changes
from analytic.description.crank_motion import RPM, CrankMotion, Segment, crank_motion
from analytic.description.linkage import Linkage, ReleasedRegime, Vector
from analytic.description.loading import catalogue, load
from analytic.dynamics.reduced import damping_coefficient, reduced_inertia
from analytic.errors import LinkproofError, UnknownNameError
from analytic.kinematics.mechanism import Mechanism
from comparisons.case import Case, case_of_file_regime
from comparisons.runs.plugins import engine
from comparisons.runs.run_engine import Lost, blamed_on, run_engine
from comparisons.stress.verdict import Cell, CellResult, StressVerdict, blank_result, judged
from engines.contract import Engine, Run, Setting, StudiedEngine
from engines.mechanics.joints import scene_size
from engines.registry import why_unavailable
from engines.scene import Body, Channel, Scene

LINKAGES = Path(__file__).with_name("linkages")
RELEASED, REVERSAL = "released", "reversal"
# Of the time constant Jeq/b that a released motion lasts: each takes the closed form a window of its own.
MOST_RELAXATIONS = 1e4
GOLDEN_ANGLE = math.pi * (3.0 - math.sqrt(5.0))  # directions that no two bodies share

# The axes of the stress maps: a table that is read once and checked.


TABLE = Path(__file__).with_name("axes.toml")


@dataclass(frozen=True)
class Conditions:
    """The conditions of a cell: scene and steps; the defaults are a smooth run-up of the unchanged linkage.

    ``linkage`` is a catalogue name, or a file's among the stress maps' own. ``speed`` is in rpm, ``start_angle`` in
    degrees; ``motion`` is a regime's name, ``reversal`` or ``released``. ``turns`` is the duration of a constant speed
    or of a released crank, in turns at ``speed``; ``spinning`` says whether it is released at that speed or at rest,
    ``torque`` (N m) is then on it. ``point`` of ``link`` (or of the ground) is put at ``at + excess * slope``, m.
    ``scaled`` names what is multiplied by ``scale``, ``load`` the kind of loads that remain (springs or dampers), times
    ``load_factor``. ``disturbed`` says whether positions or velocities of the start are off by ``disturbance``.
    """

    linkage: str
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
    disturbed: str = ""
    disturbance: float = 0.0
    steps_per_turn: float = 0.0
    effort: float = 0.0

    @property
    def differing(self) -> dict[str, str | float | bool | list[float]]:
        """The conditions that differ from the defaults, by name."""
        differing = {}
        for field in fields(self):
            value = getattr(self, field.name)
            if field.name == "linkage" or value != field.default:
                differing[field.name] = list(value) if isinstance(value, tuple) else value
        return differing

    @property
    def time_factor(self) -> float:
        """The factor of every time."""
        return self.scale if self.scaled == "time" else 1.0

    @property
    def rate(self) -> float:
        """The speed, rad/s."""
        return self.speed * RPM / self.time_factor

    @property
    def step(self) -> float:
        """The step of a method, s."""
        return 2.0 * math.pi / self.rate / self.steps_per_turn


def linkage(conditions: Conditions) -> Linkage:
    """The linkage of a cell, under its original name."""
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
    """The crank motion of a cell whose crank is driven."""
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
    """Speed to the other direction and back within ``change`` each, constant for ``hold`` before, between and after, s.

    The change follows a quintic, so that the acceleration is continuous.
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


def case(conditions: Conditions) -> Case:
    """The case of a cell. Raises AssemblyError, or LinkproofError, where there is no motion to hold an engine to."""
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
    """The scene of a cell, with every channel and, on request, a disturbed start."""
    undisturbed = case.scene(frozenset(Channel))
    if not conditions.disturbed:
        return undisturbed
    size = conditions.disturbance * scene_size(undisturbed)
    if conditions.disturbed == "velocity":
        size *= abs(conditions.rate)
    bodies = (_displaced(body, number, conditions.disturbed, size) for number, body in enumerate(undisturbed.bodies))
    return replace(undisturbed, bodies=tuple(bodies))


def _displaced(body: Body, number: int, level: str, size: float) -> Body:
    """A body with its place or its velocity off by ``size``, m or m/s."""
    direction = np.array([math.cos(number * GOLDEN_ANGLE), math.sin(number * GOLDEN_ANGLE)])
    x, y = np.array(getattr(body, level)) + size * direction
    place = (float(x), float(y))
    return replace(body, velocity=place) if level == "velocity" else replace(body, position=place)


@dataclass(frozen=True)
class AxisRow:
    """One line of a map: all conditions but the one that varies. ``most`` is the largest value that makes sense."""

    label: str
    conditions: Conditions
    quick: bool = False
    most: float = float("inf")


@dataclass(frozen=True)
class Axis:
    """One map: ``vary`` names the field of ``Conditions`` that takes the ``values``, ``label`` what they are.

    ``unit`` is that of a solver's effort, where this varies: methods whose effort has another one are left out.
    ``good`` is the value at which the problem is easy; ``seconds`` is what one cell may take. Borders are narrowed down
    where ``narrow`` says so: runs of ever more turns cost more than their exact number is worth.
    """

    name: str
    title: str
    about: str
    vary: str
    label: str
    values: tuple[float, ...]
    good: float
    rows: tuple[AxisRow, ...]
    quick: tuple[float, ...] = ()
    settings: tuple[str, ...] = ()
    methods: tuple[str, ...] = ()
    unit: str = ""
    seconds: float = 20.0
    narrow: bool = True

    def row(self, label: str) -> AxisRow:
        """A row by its label."""
        rows = {row.label: row for row in self.rows}
        if label not in rows:
            raise UnknownNameError(f"row of axis '{self.name}'", label, rows)
        return rows[label]

    def conditions(self, label: str, value: float) -> Conditions:
        """All conditions of a cell."""
        varied: dict[str, Any] = {self.vary: value}
        return replace(self.row(label).conditions, **varied)

    def chosen_rows(self, *, quick: bool) -> tuple[AxisRow, ...]:
        """The rows of a full map, or of a quick one."""
        return tuple(row for row in self.rows if row.quick or not quick)

    def chosen_values(self, row: AxisRow, *, quick: bool) -> tuple[float, ...]:
        """The values of a row in a full map, or in a quick one."""
        return tuple(value for value in (self.quick if quick else self.values) if value <= row.most)


@cache
def axes() -> Mapping[str, Axis]:
    """Every axis by its name, in the table's order."""
    tables = tomllib.loads(TABLE.read_text(encoding="utf-8"))["axis"]
    return {table["name"]: _axis_of_table(table) for table in tables}


def chosen_axes(names: Iterable[str]) -> list[Axis]:
    """The axes of these names, by default all; raises UnknownNameError."""
    known, chosen = axes(), list(names)
    for name in chosen:
        if name not in known:
            raise UnknownNameError("axis", name, known)
    return [axis for axis in known.values() if not chosen or axis.name in chosen]


def _axis_of_table(table: dict[str, Any]) -> Axis:
    common, rows = table.pop("common", {}), table.pop("rows")
    lists = {key: tuple(value) for key, value in table.items() if isinstance(value, list)}
    return Axis(**{**table, **lists}, rows=tuple(_row_of_table(common, row) for row in rows))


def _row_of_table(common: Mapping[str, Any], table: Mapping[str, Any]) -> AxisRow:
    of_row = {field.name for field in fields(AxisRow)} - {"conditions"}
    conditions: dict[str, Any] = {
        key: _tuple_for_list(value) for key, value in {**common, **table}.items() if key not in of_row
    }
    return AxisRow(conditions=Conditions(**conditions), **{key: table[key] for key in of_row & table.keys()})


def _tuple_for_list(value: object) -> object:
    return tuple(value) if isinstance(value, list) else value


def nearest(values: Sequence[float], target: float) -> int:
    """Index of the value nearest to ``target``, by ratio."""
    return min(range(len(values)), key=lambda n: _factor_between(values[n], target))


def _factor_between(first: float, second: float) -> float:
    low, high = sorted((first, second))
    return float("inf") if low <= 0.0 < high else (high / low if low > 0.0 else 1.0)


SETTINGS = tuple(setting.value for setting in Setting)


def usages(axis: Axis, adapter: Engine) -> list[str]:
    """The settings and methods in which an engine is put on an axis."""
    if not axis.methods:
        return list(axis.settings)
    plain = axis.rows[0].conditions
    given = scene(plain, _case(plain))
    try:
        methods = adapter.methods(given) if isinstance(adapter, StudiedEngine) else ()
        offered = {method.name: method.effort_unit for method in methods}
    except Exception:  # a cell of every method tells what the adapter raises
        return [*axis.settings, *axis.methods]
    fitting = [name for name in axis.methods if name in offered and axis.unit in ("", offered[name])]
    return [*axis.settings, *fitting]


def cells(chosen: Iterable[Axis], engines: Sequence[str], only: Sequence[str] = (), *, quick: bool) -> list[Cell]:
    """Every cell of these axes; ``only`` keeps the usages of these names."""
    result = []
    for axis in chosen:
        known = [(name, usage) for name in engines for usage in usages(axis, engine(name))]
        result += [
            Cell(axis.name, row.label, value, name, usage)
            for row in axis.chosen_rows(quick=quick)
            for value in axis.chosen_values(row, quick=quick)
            for name, usage in known
            if not only or usage in only
        ]
    return result


def find_cell(key: str) -> Cell:
    """The cell of a key; its value may be any number. Raises UnknownNameError, or LinkproofError for another text."""
    parts = key.split("/")
    if len(parts) != 5:
        raise LinkproofError(
            f"expected a cell as AXIS/ROW/VALUE/ENGINE/USAGE, got '{key}'; copy one from a list of cells"
        )
    name, row, value, engine_name, usage = parts
    if name not in axes():
        raise UnknownNameError("axis", name, axes())
    axis = axes()[name]
    axis.row(row)
    known = usages(axis, engine(engine_name))
    if usage not in known:
        raise UnknownNameError(f"usage of '{engine_name}' on axis '{name}'", usage, known)
    try:
        return Cell(name, row, float(value), engine_name, usage)
    except ValueError:
        raise LinkproofError(f"cell '{key}': expected a number as its value, got '{value}'; correct it") from None


def run_cell(cell: Cell) -> CellResult:
    """Make a cell's run here and now, and judge it."""
    begun = time.perf_counter()
    conditions = axes()[cell.axis].conditions(cell.row, cell.value)
    blank = _blank_result(cell)
    adapter = engine(cell.engine)
    with blamed_on(adapter):
        absent = why_unavailable(adapter)
    if absent is not None:
        return replace(blank, verdict=StressVerdict.UNAVAILABLE, reason=absent)
    try:
        true = _case(conditions)
    except LinkproofError as error:
        reason = f"the closed form has no motion to hold an engine to: {error}"
        return replace(blank, verdict=StressVerdict.UNSUPPORTED, reason=reason)
    given = scene(conditions, true)
    run = _run_usage(adapter, given, cell.usage, conditions)
    # Those of naive would hide a wrong motion.
    limits_of = Setting.BEST if cell.usage == Setting.BEST else Setting.TUNED
    blank = replace(
        blank, seconds=run.seconds, setup_seconds=run.setup_seconds, steps=run.steps, solver_work=run.solver_work
    )
    return replace(judged(blank, true, given, run, limits_of.value), spent=time.perf_counter() - begun)


def lost(loss: Lost, cell: Cell) -> CellResult:
    """A cell whose worker gave no result."""
    return replace(_blank_result(cell), verdict=StressVerdict(loss.outcome.value), reason=loss.reason)


def _blank_result(cell: Cell) -> CellResult:
    conditions = axes()[cell.axis].conditions(cell.row, cell.value)
    blank = blank_result(cell, conditions.linkage, conditions.motion)
    return replace(blank, differing=conditions.differing)


def _case(conditions: Conditions) -> Case:
    """The case of conditions, which those share that differ in what an engine alone is given."""
    return _shared_case(replace(conditions, disturbed="", disturbance=0.0, steps_per_turn=0.0, effort=0.0))


@lru_cache(maxsize=4)
def _shared_case(conditions: Conditions) -> Case:
    """A case, cached: neighbouring cells share it, and a long released motion takes seconds to integrate."""
    return case(conditions)


def _run_usage(adapter: Engine, given: Scene, usage: str, conditions: Conditions) -> Run:
    """The engine's run of a scene in a setting, or by a method at the conditions' step."""
    if usage in SETTINGS:
        return run_engine(adapter, given, Setting(usage))
    assert isinstance(adapter, StudiedEngine)
    with blamed_on(adapter):
        method = next(method for method in adapter.methods(given) if method.name == usage)
    if conditions.effort:
        method = replace(method, effort=conditions.effort)
    return run_engine(adapter, given, method, conditions.step)
