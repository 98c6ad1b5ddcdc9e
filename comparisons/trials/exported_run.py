"""A run of a case as a script in its engine's own API, which ends with the figures that are furthest from the truth."""

from __future__ import annotations

from contextlib import suppress

import numpy as np

from analytic.description.linkage import DriverKind
from analytic.errors import LinkproofError
from comparisons.motion.case import Case
from comparisons.trials.judging.limits import grouped
from comparisons.trials.judging.signal_errors import ANGLE, NUMBER, SignalError, signal_errors
from comparisons.trials.runs.run_engine import blamed_on
from engines.contract import History, Setting
from engines.exported_script import ScriptFigure, script
from engines.registry import engine, why_unavailable
from engines.scene import Channel, Scene
from engines.stepping.intervals import UnsupportedError
from engines.stepping.stepped_engine import LoopEngine

UNITS = {
    Channel.POSITION: ("m", "rad"),
    Channel.VELOCITY: ("m/s", "rad/s"),
    Channel.ACCELERATION: ("m/s2", "rad/s2"),
}
AXES = ("x", "y", "angle")
DRIVES = (("drive force", "N"), ("drive torque", "N m"))  # of a linear drive, of a crank


def exported(case: Case, engine_name: str, setting: Setting, command: str) -> str:
    """The source text of a Python script that repeats a case's run in an engine and setting by the engine's own API.

    ``engine_name`` is one of the registry's, ``command`` the command line to name in the script's head. The run is made
    here once, for the ``worst_figures`` that the script shows at its end. Raises UnknownNameError for the engine's
    name, LinkproofError for an engine that cannot be used or is no LoopEngine, a setting that it lacks for this drive,
    or a run that cannot be exported, AdapterError for any other exception of the adapter.
    """
    adapter, scene, linkage = engine(engine_name), case.scene(frozenset(Channel)), case.mechanism.linkage
    reason = why_unavailable(adapter)
    if reason is not None or not isinstance(adapter, LoopEngine):
        words = "expected an engine whose loop is a module of its own (a LoopEngine)"
        raise LinkproofError(reason or f"{words}, got '{engine_name}': export another")
    recipes = adapter.settings.get(type(scene.drive), {})
    if setting not in recipes:
        offered = ", ".join(recipes) or "none"
        raise LinkproofError(f"expected a setting that {engine_name} has for this drive ({offered}), got '{setting}'")
    run = f"{linkage.name} ({linkage.variant}), {case.motion.regime}, in {engine_name} {adapter.version()}"
    about = f"{run}, setting {setting}. Written by: {command}"
    with blamed_on(adapter):
        try:
            return script(adapter, scene, recipes[setting], about, lambda history: worst_figures(case, scene, history))
        except UnsupportedError as error:
            fault = str(error)
    raise LinkproofError(f"this run of {engine_name} cannot be exported: {fault}")


def worst_figures(case: Case, scene: Scene, history: History) -> list[ScriptFigure]:
    """Largest errors of a ``history`` from the closed form, one a channel; of places and of angles one each.

    Channels that it lacks, or that have no true value at some instant, as in a dead position, are left out.
    """
    figures: list[ScriptFigure] = []
    for channel in Channel:
        with suppress(LinkproofError):
            errors = signal_errors(case, scene, history, [channel])
            groups = grouped((error.read.columns.start, error) for error in errors).values()
            figures += [_figure(max(group, key=lambda error: error.largest)) for group in groups]
    return figures


def _figure(worst: SignalError) -> ScriptFigure:
    """The component of a signal with the largest error, at its instant, as a ScriptFigure with the true value, SI."""
    read, true = worst.read, worst.true
    row, column = divmod(int(np.argmax(worst.components)), worst.components.shape[1])
    values = (float(read.time[row]), float(read.values[row, column]), float(true.values[row, column]))
    path: tuple[str, ...] = (read.channel.value,)
    if read.channel is Channel.TORQUE:
        return ScriptFigure(*DRIVES[read.scene.driver_kind is DriverKind.CRANK], path, (), *values)
    if read.channel is Channel.JOINT_FORCE:
        component, element = ("size", ()) if read.columns == NUMBER else (AXES[column], (column,))
        return ScriptFigure(f"force in {read.name}, {component}", "N", (*path, read.name), element, *values)
    column += read.columns.start
    unit = UNITS[read.channel][read.columns == ANGLE]
    words = f"{read.channel} of {read.name}, {AXES[column]}"
    return ScriptFigure(words, unit, path, (read.body_number(read.name), column), *values)
