"""A run of a case as a script in its engine's own API, which ends with the figures that are furthest from the truth."""

from __future__ import annotations

from contextlib import suppress
from typing import Any, cast

import numpy as np

from analytic.description.linkage import DriverKind
from analytic.errors import LinkproofError
from comparisons.case import Case
from comparisons.faults.misreadings import ANGLE, LEVELS, NUMBER, Reading, readings, true_history
from comparisons.invariants.inspection import FAINT_FORCE
from comparisons.judging.limits import grouped
from comparisons.judging.quantities import near_jumps
from comparisons.runs.run_engine import blamed_on
from engines.contract import Engine, History, Setting
from engines.exported_script import ScriptFigure, script
from engines.registry import engine, why_unavailable
from engines.scene import Channel, Scene
from engines.stepping.intervals import UnsupportedError
from engines.stepping.stepped_engine import LoopEngine, Recipe

UNITS = {
    Channel.POSITION: ("m", "rad"),
    Channel.VELOCITY: ("m/s", "rad/s"),
    Channel.ACCELERATION: ("m/s2", "rad/s2"),
}
AXES = ("x", "y", "angle")
DRIVES = (("drive force", "N"), ("drive torque", "N m"))  # of a linear drive, of a crank


def exported(case: Case, engine_name: str, setting: Setting, command: str) -> str:
    """The script of a case in an engine's setting, written by a ``command``.

    Raises UnknownNameError for the engine's name, LinkproofError for what cannot be exported.
    """
    adapter, scene = _exportable_adapter(engine_name), case.scene(frozenset(Channel))
    return _script(
        adapter, scene, case, _recipe_of_setting(adapter, scene, setting), f"setting {setting}. Written by: {command}"
    )


def _exportable_adapter(engine_name: str) -> LoopEngine[Recipe]:
    adapter = engine(engine_name)
    reason = why_unavailable(adapter)
    if reason is None and isinstance(adapter, LoopEngine):
        return adapter
    raise LinkproofError(
        reason
        or f"expected an engine whose loop is a module of its own (a LoopEngine), got '{engine_name}': export another"
    )


def _recipe_of_setting(adapter: LoopEngine[Recipe], scene: Scene, setting: Setting) -> Recipe:
    """The engine's recipe for a setting under the scene's drive; raises LinkproofError if the engine lacks it."""
    recipes = adapter.settings.get(type(scene.drive), {})
    if setting not in recipes:
        offered = ", ".join(recipes) or "none"
        raise LinkproofError(f"expected a setting that {adapter.name} has for this drive ({offered}), got '{setting}'")
    return recipes[setting]


def _script(adapter: LoopEngine[Recipe], scene: Scene, case: Case, recipe: Recipe, origin: str) -> str:
    linkage = case.mechanism.linkage
    about = f"{linkage.name} ({linkage.variant}), {case.motion.regime}, in {adapter.name} {adapter.version()}, {origin}"
    with blamed_on(cast(Engine, adapter)):
        try:
            return script(adapter, scene, recipe, about, lambda history: worst_figures(case, scene, history))
        except UnsupportedError as error:
            reason = str(error)
    raise LinkproofError(f"this run of {adapter.name} cannot be exported: {reason}")


def worst_figures(case: Case, scene: Scene, history: History) -> list[ScriptFigure]:
    """The figure of every channel that is furthest from the truth, over its peak, away from jumps of the acceleration.

    A channel without a truth at some instant, as in a dead position, has none.
    """
    figures: list[ScriptFigure] = []
    for channel in Channel:
        recorded: dict[str, Any] = {channel.value: getattr(history, channel.value)}
        with suppress(LinkproofError):
            figures += _worst_of_channel(case, scene, History(**recorded))
    return figures


def _worst_of_channel(case: Case, scene: Scene, history: History) -> list[ScriptFigure]:
    """The worst place of all bodies, the worst angle, the worst torque or force in the one channel of a history.

    All share the largest peak, and forces have each its own.
    """
    truths = readings(scene, true_history(case, scene, history))
    pairs = [pair for pair in zip(readings(scene, history), truths, strict=True) if _can_be_wrong(pair[0])]
    least = FAINT_FORCE if history.joint_force else 1.0
    figures = []
    for group in grouped((read.columns.start, (read, true)) for read, true in pairs).values():
        sizes = [_peak(true) for _, true in group]
        peaks = [max(size, least * max(sizes)) or 1.0 for size in sizes]
        samples = [_worst_sample(case, *pair, peak) for pair, peak in zip(group, peaks, strict=True)]
        figures.append(max(samples, key=lambda sample: sample[0])[1])
    return figures


def _can_be_wrong(reading: Reading) -> bool:
    """Whether a signal means anything: the angle of a body that cannot turn is not its own."""
    is_angle = reading.channel in LEVELS and reading.columns == ANGLE
    return not is_angle or reading.scene.bodies[reading.body_number(reading.name)].inertia is not None


def _peak(true: Reading) -> float:
    """The largest component, or magnitude of a force."""
    is_force = true.channel is Channel.JOINT_FORCE
    return float(np.max(np.hypot.reduce(true.values, axis=1) if is_force else np.abs(true.values)))


def _worst_sample(case: Case, read: Reading, true: Reading, peak: float) -> tuple[float, ScriptFigure]:
    """The largest error of a signal over a peak, zero at jumps, where accelerations and forces have two values."""
    values, right = read.values, true.values
    error = np.abs(values - right) / peak
    if read.channel not in (Channel.POSITION, Channel.VELOCITY):
        error[near_jumps(read.time, case.motion)] = 0.0
    row, column = divmod(int(np.argmax(error)), error.shape[1])
    figure = _figure(read, column)._replace(
        time=float(read.time[row]), read=float(values[row, column]), true=float(right[row, column])
    )
    return float(error[row, column]), figure


def _figure(read: Reading, column: int) -> ScriptFigure:
    """A column of a signal as a script names it."""
    path = (read.channel.value,)
    if read.channel is Channel.TORQUE:
        return ScriptFigure(*DRIVES[read.scene.driver_kind is DriverKind.CRANK], path)
    if read.channel is Channel.JOINT_FORCE:
        component, element = ("size", ()) if read.columns == NUMBER else (AXES[column], (column,))
        return ScriptFigure(f"force in {read.name}, {component}", "N", (*path, read.name), element)
    column += read.columns.start
    unit = UNITS[read.channel][read.columns == ANGLE]
    words = f"{read.channel} of {read.name}, {AXES[column]}"
    return ScriptFigure(words, unit, path, (read.body_number(read.name), column))
