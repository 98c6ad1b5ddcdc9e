"""Bounds and constraints as typed: ``rod.B.x=170:180``, ``rod.B.x=±10%``, ``stroke=29.9:30.1``."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Sequence
from typing import Final

from analytic.description.changes import SPEED
from analytic.description.linkage import Linkage
from analytic.errors import LinkproofError
from analytic.kinematics.mechanism import Mechanism
from comparisons.designs.named_figures import NamedFigure, named_figures
from comparisons.designs.optimum.problem import Constraint, Variable
from comparisons.designs.parameters import Parameter, parameter

SHARE: Final = re.compile(r"\s*(?:±|\+-|\+/-)\s*(?P<percent>\d+\.?\d*|\.\d+)\s*%\s*")
NOT_NEGATIVE: Final = ("mass", "inertia")


def variables(linkage: Linkage, texts: Sequence[str], speed: float) -> tuple[Variable, ...]:
    """The numbers to be varied, the driver's ``speed``, SI, among them.

    Raises LinkproofError for malformed bounds, UnknownNameError for a name.
    """
    if not texts:
        raise LinkproofError("expected numbers to vary, got none: name them with their bounds, --over rod.B.x=170:180")
    result: dict[str, Variable] = {}
    for text in texts:
        name, mark, bounds = text.rpartition("=")
        if not mark:
            raise LinkproofError(f"--over: expected NAME=LOW:HIGH or NAME=±10%, got '{text}'; correct it")
        number = parameter(linkage, name.strip(), speed)
        if number.name in result:
            raise LinkproofError(f"--over: expected each number once, got {number.name} twice; leave one out")
        result[number.name] = Variable(number, *_bounds(number, bounds))
    return tuple(result.values())


def _bounds(number: Parameter, text: str) -> tuple[float, float]:
    """Bounds, SI, checked."""
    share = SHARE.fullmatch(text)
    if share is not None:
        part = 0.01 * float(share["percent"])
        low, high = sorted((number.value * (1.0 - part), number.value * (1.0 + part)))
    else:
        ends = text.split(":")
        if len(ends) != 2:
            raise LinkproofError(f"--over {number.name}: expected LOW:HIGH or ±10%, got '{text}'; correct it")
        low, high = map(number.si, ends)
    if not low < high:
        about = f"; {number.name} is {number.value / number.unit.size:g}" if share else ""
        raise LinkproofError(f"--over {number.name}: expected LOW below HIGH, got '{text}'{about}; correct it")
    if number.kind in NOT_NEGATIVE and low < 0.0:
        raise LinkproofError(f"--over {number.name}: expected bounds that are not negative, got '{text}'; correct it")
    if number.kind == SPEED and low <= 0.0:
        raise LinkproofError(f"--over speed: expected bounds above 0, got '{text}'; --clockwise turns the other way")
    return low, high


def split(text: str) -> tuple[str, str | None]:
    """The figure of a constraint and the text of its values, None if the file's value is to stay."""
    name, mark, values = text.rpartition("=")
    return (name.strip(), values) if mark else (text.strip(), None)


def constraint_texts(mechanism: Mechanism, texts: Iterable[str]) -> dict[NamedFigure, str | None]:
    """The constrained figures, each with the text of its values."""
    return {figure: values for name, values in map(split, texts) for figure in named_figures(mechanism, [name])}


def constraint(figure: NamedFigure, text: str | None, own: float) -> Constraint:
    """A constraint to a value or a range, either end of which may be left out; without a text to ``own``, SI."""
    if text is None:
        return Constraint(figure, own, own)
    ends = text.split(":")
    numbers = [_number(figure, end, open_end) for end, open_end in zip(ends, (-math.inf, math.inf), strict=False)]
    low, high = numbers * 2 if len(ends) == 1 else numbers[:2] if len(ends) == 2 else (math.nan, math.nan)
    if len(ends) == 1 and not text.strip():
        low = math.nan
    if not low <= high or low == -high == -math.inf:
        raise LinkproofError(
            f"--keep {figure.name}: expected LOW:HIGH, LOW:, :HIGH or a value, got '{text}'; correct it, "
            "or give the name alone to keep what the file has"
        )
    return Constraint(figure, low * figure.unit.size, high * figure.unit.size)


def _number(figure: NamedFigure, text: str, open_end: float) -> float:
    if not text.strip():
        return open_end
    try:
        number = float(text)
    except ValueError:
        number = math.nan
    if not math.isfinite(number):
        unit = f" of {figure.unit.name}" if figure.unit.name else ""
        raise LinkproofError(f"--keep {figure.name}: expected finite numbers{unit}, got '{text}'; correct it")
    return number
