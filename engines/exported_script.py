"""A run of one pass as a script: the source of the engine's loop, its model and course as data, and their figures.

Names of a linkage are data in it: every text is written by ``repr``.
"""

from __future__ import annotations

import ast
import inspect
import re
from collections.abc import Callable, Sequence
from contextlib import nullcontext
from dataclasses import replace
from importlib import import_module
from pprint import pformat
from typing import Any, NamedTuple

import numpy as np

from analytic.description.linkage import DriverKind
from analytic.description.units import Kind
from engines.contract import History
from engines.registry import silenced
from engines.scene import Scene
from engines.stepping.intervals import Cost, DivergedError, UnsupportedError
from engines.stepping.own_units import OwnUnits, restored
from engines.stepping.stepped_engine import LoopEngine, plain, plain_course

WIDTH = 130  # a docstring's line of 120 characters stays one
OWN_PACKAGES = {"linkproof", "analytic", "engines", "comparisons", "reports"}
ANGLE = 2  # number of the angle among a body's coordinates
CLOSING_IMPORTS = """
from math import inf, nan
from typing import Any

import numpy as np


"""
RUN = """
try:
    samples = follow(build(MODEL), COURSE)
except ArithmeticError as error:
    raise SystemExit(str(error)) from error
show_figures(ENGINE, samples, FIGURES)
"""


class ScriptFigure(NamedTuple):
    """A figure of a run, SI: what it is, its unit, its channel and joint, and which element of a sample.

    ``time`` is the sample's, s; ``read`` the engine's value then, ``true`` the closed form's.
    """

    what: str
    unit: str
    signal: tuple[str, ...]
    element: tuple[int, ...] = ()
    time: float = 0.0
    read: float = 0.0
    true: float = 0.0

    def factor(self, units: OwnUnits | None, driver: DriverKind) -> float:
        """The size, SI, of the unit in which the script counts its samples of this figure; 1 in SI and for an angle.

        ``units`` is None for SI; ``driver`` tells a drive's torque from a force.
        """
        kind, *joint = self.signal
        if units is None or (kind not in ("torque", "joint_force") and self.element[-1] == ANGLE):
            return 1.0
        return units.unit(Kind.FORCE if joint else Kind.DRIVE if kind == "torque" else Kind.LENGTH, driver)


def script(
    engine: LoopEngine[Any],
    scene: Scene,
    recipe: Any,  # noqa: ANN401 - the engine's
    about: str,
    figures: Callable[[History], Sequence[ScriptFigure]],
) -> str:
    """Python source that repeats one run of a scene by a recipe, without linkproof.

    The run is made here once: ``figures`` takes, from its history in SI, those that the script shows at its end.
    ``about`` describes the run; it heads the source, with the reason of a run that diverges, which shows no figures.

    Raises UnsupportedError, with the reason in a sentence, for a scene that the engine does not take, several runs that
    are extrapolated, or a loop that imports a part of linkproof; ImportError where the engine is not installed.
    """
    reason = engine.obstacle(scene)
    if reason is not None:
        raise UnsupportedError(reason)
    given, units, (course, *more) = engine.planned(scene, recipe, Cost())
    if more:
        raise UnsupportedError(f"it is {1 + len(more)} runs extrapolated, and a script holds one: export 'tuned'")
    docstring, source = _standalone_source(engine.loop)
    closing = CLOSING_IMPORTS + _without_remarks(inspect.getsource(show_figures)).rstrip()
    shown: Sequence[ScriptFigure] = ()
    with silenced() if engine.chatters else nullcontext():
        world = engine.build(given, recipe)
        try:
            history = engine.follow(world, replace(course, cost=Cost()))
            shown = figures(restored(history, units, scene.driver_kind) if units else history)
        except DivergedError as error:
            about += f"\nIt does not get to its end: {error}"
    data = {
        "ENGINE": engine.name,
        "MODEL": engine.model(given, recipe),
        "COURSE": plain_course(course),
        "FIGURES": [(*figure, figure.factor(units, scene.driver_kind)) for figure in shown],
    }
    head = written(f"{about}\n\n{_units_in_words(units)}\n\n{docstring}")
    rows = [f"{name} = {written(value)}" for name, value in data.items()]
    return "\n".join([head, source, closing, "", "", *rows, RUN])


def written(value: object) -> str:
    """Python source of plain data, such that text in it cannot become code; raises TypeError for other data."""
    return pformat(plain(value), width=WIDTH, compact=True, sort_dicts=False)


def show_figures(engine: str, samples: dict[str, Any], figures: list[tuple[Any, ...]]) -> None:
    """Print, at the end of an exported script, where the engine is furthest from the closed form, in SI units.

    ``samples`` are as ``follow`` returns them: times and values by channel. A figure has what it is, its unit, channel
    and joint, the element of a sample, the time, s, the engine's value when exported, the closed form's, and the size
    of the samples' unit. It is read at the sample nearest to its time.
    """
    print(f"{'':44}{'time, s':>9}{engine:>20}{'when exported':>20}{'closed form':>20}{'difference':>12}")  # noqa: T201
    for what, unit, (channel, *joint), element, at, exported, true, factor in figures:
        time, values = map(np.asarray, samples[channel][joint[0]] if joint else samples[channel])
        read = float(values[(np.argmin(np.abs(time - at)), *element)]) * factor
        row = f"{what + ', ' + unit:44}{at:9.6f}{read:20.12g}{exported:20.12g}{true:20.12g}{read - true:12.1e}"
        print(row)  # noqa: T201


def _standalone_source(loop: str) -> tuple[str, str]:
    """Docstring and source of a loop's module, without remarks for linters, to run without linkproof.

    ``loop`` is the module's name. The source of another loop that it imports from stands before it. Raises
    UnsupportedError where it imports more of linkproof, or by a relative import.
    """
    source = inspect.getsource(import_module(loop))
    module, lines, before = ast.parse(source), source.splitlines(), list[str]()
    for node in ast.walk(module):
        if not isinstance(node, (ast.Import, ast.ImportFrom)):
            continue
        if isinstance(node, ast.ImportFrom) and re.fullmatch(r"engines\..*_loop", node.module or ""):
            before.append(_standalone_source(node.module or "")[1])
            lines[node.lineno - 1 : node.end_lineno] = [""] * ((node.end_lineno or 0) - node.lineno + 1)
            continue
        names = [alias.name for alias in node.names] if isinstance(node, ast.Import) else [node.module or ""]
        if getattr(node, "level", 0) or OWN_PACKAGES & {name.partition(".")[0] for name in names}:
            raise UnsupportedError(
                f"line {node.lineno} of its loop '{loop}' imports a part of linkproof or of its own package, "
                "which a script does not have"
            )
    docstring = ast.get_docstring(module)
    rest = lines[module.body[0].end_lineno or 0 :] if docstring else lines
    return docstring or "", _without_remarks("\n".join([*before, *rest]))


def _without_remarks(source: str) -> str:
    """A source without the remarks, from "# noqa" to the line's end, that address linters."""
    return re.sub(r"  # noqa.*", "", source)


def _units_in_words(units: OwnUnits | None) -> str:
    """A sentence or two, as text, on the units of the script's numbers; SI without own units."""
    if units is None:
        return "Units: m, kg, s, rad and what follows from them."
    return (
        f"Units: the length is {units.length!r} m, the mass {units.mass!r} kg; s and rad. So a force is "
        f"{units.unit(Kind.FORCE)!r} N, a torque or a moment of inertia {units.unit(Kind.TORQUE)!r} N m or kg m2."
    )
