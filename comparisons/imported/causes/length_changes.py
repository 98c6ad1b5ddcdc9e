"""What may be wrong with the shape of the linkage in the tool: a length, a ground point, a guide, an assembly mode."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from analytic.description.changes import multiplied, with_point
from analytic.description.linkage import GROUND, Linkage, Slider, Vector
from comparisons.imported.causes.fitting import FaultModel, said
from comparisons.imported.causes.model_changes import UNITS, Change, positive, times
from comparisons.imported.judging.judgement import SignalVerdict
from comparisons.imported.judging.samples import JudgedModel

Array = NDArray[np.float64]

MOST_POINTS: Final = 60  # of a linkage whose places are tried one by one
MOST_MODES: Final = 8  # of a linkage whose other assembly modes are tried


def length_changes(model: JudgedModel) -> Iterator[FaultModel]:
    """Every length at once, each point of a link along the line to its first point, each place of the ground."""
    linkage, size = model.linkage, model.linkage.shortest_length()
    yield _of(
        model, "every length", lambda found, k: multiplied(found, positive(k), "length"), times("every length"),
        start=(1.0,), sizes=(1.0,), guesses=((1.0,), *UNITS), special=(*UNITS, (0.1,), (10.0,), (0.0254,)),
    )  # fmt: skip
    yield from _modes(model)
    if sum(len(link.points) for link in linkage.links.values()) > MOST_POINTS:
        return
    for name, link in linkage.links.items():
        first, *others = link.points
        for point in others:
            yield _length(model, name, first, point)
    for point, at in linkage.ground.items():
        for axis in (0, 1):
            yield _place(model, point, at, axis)
    for slider in linkage.sliders:
        if slider.guide.host == GROUND:
            yield from _guide(model, slider.link, size)


def _of(model: JudgedModel, kind: str, change: Change, words: Callable[[Array], str], **rest: Any) -> FaultModel:  # noqa: ANN401
    """A cause that changes the linkage; ``rest`` are fields of ``FaultModel``."""

    def predict(numbers: Array, verdicts: Sequence[SignalVerdict]) -> list[Array]:
        other = replace(model, linkage=change(model.linkage, numbers))
        return other.predicted([verdict.samples for verdict in verdicts])

    return FaultModel(kind, predict, words, **rest)


def _length(model: JudgedModel, name: str, first: str, point: str) -> FaultModel:
    points, written = model.linkage.links[name].points, model.linkage.written
    origin, at = points[first], points[point]
    length = math.dist(origin, at)

    def change(linkage: Linkage, k: Array) -> Linkage:
        factor = positive(k)
        place = (origin[0] + (at[0] - origin[0]) * factor, origin[1] + (at[1] - origin[1]) * factor)
        return with_point(linkage, name, point, place)

    def words(k: Array) -> str:
        lengths = f"{written(k[0] * length)} in place of {written(length)}"
        return f"the distance of '{first}' and '{point}' on '{name}' is {lengths}"

    return _of(model, f"length:{name}:{point}", change, words, start=(1.0,), sizes=(1.0,))


def _place(model: JudgedModel, point: str, at: Vector, axis: int) -> FaultModel:
    written = model.linkage.written

    def change(linkage: Linkage, c: Array) -> Linkage:
        return with_point(linkage, GROUND, point, (float(c[0]), at[1]) if axis == 0 else (at[0], float(c[0])))

    def words(c: Array) -> str:
        return f"{'xy'[axis]} of '{point}' on the ground is {written(c[0])} in place of {written(at[axis])}"

    size = model.linkage.shortest_length()
    return _of(model, f"ground:{point}.{'xy'[axis]}", change, words, start=(at[axis],), sizes=(size,))


def _guide(model: JudgedModel, link: str, size: float) -> Iterator[FaultModel]:
    """A guide of the ground, shifted across or turned."""
    written = model.linkage.written
    shifts: tuple[str, Change, Callable[[Array], str], float] = (
        "offset",
        lambda found, c: _with_guide(found, link, float(c[0]), 0.0),
        lambda c: f"the guide of '{link}' is shifted by {written(c[0])} across its direction",
        size,
    )
    turns: tuple[str, Change, Callable[[Array], str], float] = (
        "direction",
        lambda found, c: _with_guide(found, link, 0.0, float(c[0])),
        lambda c: f"the guide of '{link}' is turned by {math.degrees(c[0]):.3g}°",
        1.0,
    )
    for kind, change, words, scale in (shifts, turns):
        yield _of(model, f"guide {kind}:{link}", change, words, start=(0.0,), sizes=(scale,))


def _with_guide(linkage: Linkage, link: str, shift: float, turn: float) -> Linkage:
    def moved(slider: Slider) -> Slider:
        (x, y), (c, s), through = slider.guide.along, (math.cos(turn), math.sin(turn)), slider.guide.through
        place, along = (through[0] - shift * y, through[1] + shift * x), (c * x - s * y, s * x + c * y)
        return replace(slider, guide=replace(slider.guide, through=place, along=along))

    return replace(linkage, sliders=tuple(moved(s) if s.link == link else s for s in linkage.sliders))


def _modes(model: JudgedModel) -> Iterator[FaultModel]:
    """Another assembly mode of one group."""
    dyads = model.mechanism.structure.dyads
    open_dyads = [number for number, dyad in enumerate(dyads) if dyad.has_two_modes]
    for number in open_dyads[:MOST_MODES]:
        signs = tuple(-dyad.sign if n == number else dyad.sign for n, dyad in enumerate(dyads))
        words = f"'{dyads[number].first}' and '{dyads[number].second}' are assembled in their other mode"
        yield FaultModel(f"mode:{dyads[number].first}", _in_modes(model, signs), said(words))


def _in_modes(model: JudgedModel, signs: tuple[int, ...]) -> Callable[[Array, Sequence[SignalVerdict]], list[Array]]:
    other = replace(model, modes=signs)
    return lambda _, verdicts: other.predicted([verdict.samples for verdict in verdicts])
