"""The options of the commands as arguments of functions: which linkage, and how its crank moves."""

from __future__ import annotations

from collections.abc import Iterable
from numbers import Real
from pathlib import Path
from typing import Any, Final, TypedDict

import numpy as np

from analytic.description.changes import without
from analytic.description.linkage import Linkage
from analytic.description.loading import in_variant, load
from analytic.errors import LinkproofError, UnknownNameError, shortened

Words = str | Iterable[str]  # a name, or several


class MotionOptions(TypedDict, total=False):
    """The motion of the crank by the options of the commands: rpm, seconds and degrees; what is not said has a default.

    Of a drive along a line ``speed``, ``from_angle`` and ``to_angle`` are in its file's unit of length.
    """

    variant: str | None
    regime: Words
    speed: float | None
    ramp_time: float
    hold_time: float
    start_angle: float
    from_angle: float | None
    to_angle: float | None
    clockwise: bool
    gravity: bool


UNITS: Final = {"speed": "rpm", "ramp_time": "s", "hold_time": "s"} | dict.fromkeys(
    ("start_angle", "from_angle", "to_angle"), "degrees"
)


def check_number(name: str, value: object, unit: str) -> None:
    """Raise LinkproofError for an argument that is no number; None is left to its default."""
    if value is not None and (isinstance(value, bool | np.bool_) or not isinstance(value, Real)):
        raise LinkproofError(f"{name}: expected a number of {unit}, got {shortened(repr(value))}; pass a number")


def words(given: Words) -> tuple[str, ...]:
    """A name, or several, as the command line has them."""
    return (given,) if isinstance(given, str) else tuple(given)


def choice(options: MotionOptions) -> dict[str, Any]:
    """The options as a ``MotionChoice`` takes them; raises TypeError for others."""
    for name in options:
        if name not in MotionOptions.__annotations__:
            raise TypeError(str(UnknownNameError("argument", name, MotionOptions.__annotations__)))
    for name in {*options} & {*UNITS}:
        check_number(name, options.get(name), UNITS[name])
    chosen: dict[str, Any] = dict(options)
    chosen["regimes"] = words(chosen.pop("regime", None) or ())
    return chosen


def chosen_linkage(linkage: Linkage | str | Path, variant: str | None = None, *, gravity: bool = True) -> Linkage:
    """A linkage by its name, its file or as it is, in another variant if one is named."""
    if not isinstance(linkage, Linkage):
        found = load(linkage, variant)
    else:
        found = linkage if variant is None else in_variant(linkage, variant)
    return found if gravity else without(found, "gravity")
