"""A run of a case as a script in its engine's own API, which ends with the figures that are furthest from the truth."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import suppress
from dataclasses import replace
from typing import NamedTuple, cast

import numpy as np
from numpy.typing import NDArray

from analytic.description.linkage import DriverKind
from analytic.errors import LinkproofError
from comparisons.invariants.inspection import FAINT_FORCE
from comparisons.judging.deviations import near_jumps
from comparisons.reference.case import Case, channel_truth
from comparisons.runs.run_engine import blamed_on
from comparisons.stress.cell_result import Cell
from comparisons.stress.cells import SETTINGS, axes
from comparisons.stress.scenes import case as case_of
from comparisons.stress.scenes import scene as scene_of
from engines.contract import Engine, History, Setting
from engines.exported_script import ScriptFigure, script
from engines.registry import engine, why_unavailable
from engines.scene import Channel, Scene
from engines.stepping.intervals import UnsupportedError
from engines.stepping.loop_engine import LoopEngine
from engines.stepping.stepped_engine import Recipe

Array = NDArray[np.float64]

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


def exported_cell(cell: Cell, command: str) -> str:
    """The script of a cell of a stress map; raises LinkproofError for what cannot be exported."""
    adapter, conditions = _exportable_adapter(cell.engine), axes()[cell.axis].conditions(cell.row, cell.value)
    case = case_of(conditions)
    scene = scene_of(conditions, case)
    if cell.usage in SETTINGS:
        recipe, usage = _recipe_of_setting(adapter, scene, Setting(cell.usage)), f"setting {cell.usage}"
    else:
        method = next(method for method in adapter.methods(scene) if method.name == cell.usage)
        method = replace(method, effort=conditions.effort) if conditions.effort else method
        recipe, usage = adapter.studied_recipe(method, conditions.step), f"method '{cell.usage}'"
    return _script(adapter, scene, case, recipe, f"{usage}. Written by: {command}")


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
    figures = []
    for channel in Channel:
        with suppress(LinkproofError):
            figures += [_worst_figure(case, curves) for curves in _curves_sharing_a_peak(case, scene, history, channel)]
    return figures


class _Curve(NamedTuple):
    """A component of a channel over time, the engine's and the true one (n,), and the peak it is judged by."""

    figure: ScriptFigure
    time: Array
    values: Array
    true: Array
    peak: float

    def error(self, case: Case) -> Array:
        """The errors (n,) over the peak; zero at jumps, where accelerations and forces have two values."""
        error = np.abs(self.values - self.true) / (self.peak or 1.0)
        is_smooth = self.figure.signal[0] in (Channel.POSITION, Channel.VELOCITY)
        return error if is_smooth else np.where(near_jumps(self.time, case.motion), 0.0, error)


def _worst_figure(case: Case, curves: list[_Curve]) -> ScriptFigure:
    errors = [curve.error(case) for curve in curves]
    number = max(range(len(errors)), key=lambda number: float(errors[number].max()))
    curve, at = curves[number], int(np.argmax(errors[number]))
    values = {name: float(getattr(curve, name)[at]) for name in ("time", "values", "true")}
    return curve.figure._replace(time=values["time"], read=values["values"], true=values["true"])


def _curves_sharing_a_peak(case: Case, scene: Scene, history: History, channel: Channel) -> Iterator[list[_Curve]]:
    """Curves of a channel in lists that share a peak: x and y of all bodies, their angles, the torque, the forces."""
    signal = None if channel is Channel.JOINT_FORCE else getattr(history, channel.value)
    if channel is Channel.JOINT_FORCE and history.joint_force:
        yield list(_force_curves(case, history))
    if signal is None:
        return
    if channel is Channel.TORQUE:
        true, words = channel_truth(case, channel, "", signal.time), DRIVES[scene.driver_kind is DriverKind.CRANK]
        figure = ScriptFigure(*words, (channel.value,))
        yield [_Curve(figure, signal.time, signal.values, true, float(np.abs(true).max()))]
        return
    true = np.stack([channel_truth(case, channel, body.name, signal.time) for body in scene.bodies], axis=1)
    for columns, unit in zip(((0, 1), (2,)), UNITS[channel], strict=True):
        peak = float(np.abs(true[..., columns]).max())
        yield [
            _Curve(
                ScriptFigure(f"{channel} of {body.name}, {AXES[column]}", unit, (channel.value,), (number, column)),
                signal.time, signal.values[:, number, column], true[:, number, column], peak,
            )
            for number, body in enumerate(scene.bodies) for column in columns
            if column < 2 or body.inertia is not None  # a body that cannot turn has no angle of its own
        ]  # fmt: skip


def _force_curves(case: Case, history: History) -> Iterator[_Curve]:
    signals = history.joint_force
    true = {joint: channel_truth(case, Channel.JOINT_FORCE, joint, signal.time) for joint, signal in signals.items()}
    sizes = {joint: np.hypot(*values.T) for joint, values in true.items()}
    faint = FAINT_FORCE * max(float(size.max()) for size in sizes.values())
    for joint, signal in signals.items():
        peak, path = max(float(sizes[joint].max()), faint), (Channel.JOINT_FORCE.value, joint)
        if signal.values.ndim == 1:
            yield _Curve(
                ScriptFigure(f"force in {joint}, size", "N", path), signal.time, signal.values, sizes[joint], peak
            )
            continue
        for axis in range(2):
            figure = ScriptFigure(f"force in {joint}, {AXES[axis]}", "N", path, (axis,))
            yield _Curve(figure, signal.time, signal.values[:, axis], true[joint][:, axis], peak)
