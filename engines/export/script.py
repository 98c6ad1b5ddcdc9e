"""A run of one pass as a script that needs the engine alone and ends with its figures beside the closed form's."""

from __future__ import annotations

import sys
import textwrap
from collections.abc import Callable, Sequence
from contextlib import nullcontext
from dataclasses import replace
from importlib import import_module
from importlib.util import find_spec
from typing import Any

from analytic.description.linkage import DriverKind
from engines.contract import History
from engines.export.loads import AT_ANGLE
from engines.export.loop_script import ScriptFigure
from engines.export.transcript import Transcript, folded, literal
from engines.installed import silenced, why_absent
from engines.mechanics.start_check import ability_obstacle, data_obstacle
from engines.scene import Scene
from engines.stepping.cost import Cost
from engines.stepping.driver import DivergedError, UnsupportedError
from engines.stepping.own_units import OwnUnits, restored
from engines.stepping.stepped_engine import Recipe, SteppedEngine

FORCE = "force in "  # before the name of a joint: what a script calls its samples
KEEP = """samples = {}  # times and values, by channel or joint


def keep(name, time, values):
    for kept, new in zip(samples.setdefault(name, ([], [])), (time, values)):
        kept.extend(new)

"""

CLOSING = """
# What {engine} says where it is furthest from the closed form, in SI units.
FIGURES = [
    # what, unit, samples and element of them, their unit in SI, time in s, {engine} when exported, closed form
{rows}
]
print(f"{{'':44}}{{'time, s':>9}}{{'{engine}':>20}}{{'when exported':>20}}{{'closed form':>20}}{{'difference':>12}}")
for what, unit, name, element, factor, at, exported, true in FIGURES:
    time, values = map(np.asarray, samples[name])
    read = float(values[(np.argmin(np.abs(time - at)), *element)]) * factor
    print(f"{{what + ', ' + unit:44}}{{at:9.6f}}{{read:20.12g}}{{exported:20.12g}}{{true:20.12g}}{{read - true:12.1e}}")
"""


def told(figure: ScriptFigure, units: OwnUnits | None) -> str:
    """The figure as a line of a script whose samples are in these units."""
    channel, *joint = figure.signal
    name = FORCE + joint[0] if joint else channel
    factor = figure.factor(units, DriverKind.CRANK)
    return row((figure.what, figure.unit, name, figure.element, factor, figure.time, figure.read, figure.true))


def row(values: object, key: str = "") -> str:
    """A line of a table in a script, in several where it is long; ``key`` is that of a dictionary."""
    return folded("    " + (f"{literal(key)}: " if key else "") + f"{literal(values)},")


def script(
    engine: SteppedEngine[Any, Any],
    scene: Scene,
    recipe: Recipe,
    about: str,
    figures: Callable[[History], Sequence[ScriptFigure]],
) -> str:
    """The script of one run; ``about`` says what it is, ``figures`` what of its history it shows at its end.

    Raises UnsupportedError in a sentence for what cannot be exported.
    """
    reason = (
        why_absent(engine.package, engine.name, engine.oldest)
        or ability_obstacle(scene, engine.abilities)
        or data_obstacle(scene, massless=engine.abilities.massless)
        or engine.refusal(scene)
    )
    if reason is not None:
        raise UnsupportedError(reason)
    given, units, (course, *more) = engine.planned(scene, recipe, Cost())
    if more:
        raise UnsupportedError(f"it is {1 + len(more)} runs extrapolated, and a script holds one: export 'tuned'")
    transcript, ending = Transcript(engine.package), ""
    shown: Sequence[ScriptFigure] = ()
    with silenced() if engine.chatters else nullcontext():
        followed = engine.build(given, recipe)
        try:
            history = engine.follow(followed, replace(course, cost=Cost()))
            shown = figures(restored(history, units) if units else history)
        except DivergedError as error:
            ending = f"\n# It does not get to its end: {str(error)!r}\n"
        writer = _writer(engine)
        _forget_imports(engine)
        with transcript.on():
            world = engine.build(given, recipe)
            text = writer.text(given, world, course, followed)
        _forget_imports(engine)
    if shown:
        ending = CLOSING.format(engine=engine.name, rows="\n".join(told(figure, units) for figure in shown))
    imports, lines, rest = transcript.source(world, text)
    return "\n".join(
        [
            literal(f"{_filled(about)}\n\n{_filled(_units_told(units))}\n"),
            "",
            "import math",
            "",
            "import numpy as np",
            *imports,
            "",
            *([AT_ANGLE] if "at_angle(" in "".join([*lines, rest]) else []),
            "# The model in its start state.",
            *lines,
            "",
            "# The run.",
            KEEP,
            rest.strip("\n"),
            ending,
        ]
    )


def _writer(engine: SteppedEngine[Any, Any]) -> Any:  # noqa: ANN401 - a module
    """The module here that has the engine's name.

    Its ``text(scene, world, course, followed)`` is that of a pass through a world in the engine's own API. In ``world``
    stand-ins are in the place of the engine's objects: their text is what the script calls them, and what is done to
    them becomes lines of the script that come before this text. ``followed`` is such a world without stand-ins that
    the course has been taken through. The text lets ``keep`` keep times and values by channel or joint, as in
    ``History``; it raises UnsupportedError for what it cannot hold.
    """
    module = f"engines.export.{engine.name}"
    if find_spec(module) is None:
        raise UnsupportedError(f"how its steps are written is not known, as there is no {module}")
    return import_module(module)


def _forget_imports(engine: SteppedEngine[Any, Any]) -> None:
    """Let an adapter import its engine again that has kept it."""
    for each in vars(sys.modules[type(engine).__module__]).values():
        if hasattr(each, "cache_clear"):
            each.cache_clear()


def _filled(text: str) -> str:
    return textwrap.fill(text, 118, break_on_hyphens=False, break_long_words=False)


def _units_told(units: OwnUnits | None) -> str:
    if units is None:
        return "Units: m, kg, s, rad and what follows from them."
    return (
        f"Units: the length is {units.length!r} m, the mass {units.mass!r} kg; s and rad. So a force is "
        f"{units.unit('force')!r} N, a torque or a moment of inertia {units.unit('torque')!r} N m or kg m2."
    )
