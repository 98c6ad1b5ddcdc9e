"""Figures of many designs at once: peaks, means and single values of any signal, without its curves."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Final, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from analytic.description.changes import design_numbers
from analytic.description.law import FULL_TURN
from analytic.designs.figures import Figure
from analytic.designs.reductions import can_reduce, reduced_figures
from analytic.designs.sampled_figures import FigureRequest
from analytic.designs.sampled_signals import checked_parameters
from analytic.errors import LinkproofError, UnknownNameError
from analytic.kinematics.mechanism import Mechanism
from analytic.machine_code.compiling import is_worthwhile
from analytic.signals import names_with_magnitudes, table

Array = NDArray[np.float64]

LEAST_ANGLES: Final = 3  # crank angles, so that a top has neighbours, where it is refined
EVEN: Final = 1e-9  # of a step
USUAL_LIST, OF_FIGURE = 200, 15  # operations of a six-bar's motion, and of each signal


def design_figures(
    mechanism: Mechanism,
    parameters: Mapping[str, ArrayLike],
    figures: Sequence[Figure],
    angle: ArrayLike,
    *,
    speed: float,
    period: float | Literal["auto"] | None = "auto",
    refine: bool = False,
    cores: int | None = None,
    path: str = "auto",
) -> Array:
    """Figures of every design, (figures, designs), SI; the crank turns at a constant ``speed``, rad/s, signed.

    ``parameters`` are arrays (designs,) of numbers of the description, SI, by the names of
    ``analytic.description.changes``, and ``speed``, turned as ``speed``; all else is as described, and the assembly
    modes are those that its sketch picks. Without any it is one design, the file's. A signal is sampled at the crank
    angles ``angle`` (angles,), rad, ascending; S counts from the design's own largest output. With ``refine`` the
    extremes are the true ones between the samples, and S counts from the true top: over a ``period``, rad, or over a
    range, whose ends count, if None; "auto" is a turn where the angles divide one evenly. Means are integrals over the
    same, whatever the samples, and of S from the true top.

    The figures of a design that cannot be assembled, or stands in a dead position, at or between any of the angles are
    nan, and so are those of one that passes a change point where the linkage as described passes none. ``cores`` and
    ``path`` are as for ``analytic.evaluation.evaluate``. Raises UnknownNameError and LinkproofError as
    ``evaluate_designs`` does.
    """
    places = _checked_places(angle, LEAST_ANGLES if refine else 1)
    if not parameters:  # of the file's own numbers one stands for all
        name, (_, value) = next(iter(design_numbers(mechanism.linkage).items()))
        parameters = {name: [value]}
    arrays = checked_parameters(mechanism.linkage, parameters, has_speed=True)
    _check_names(mechanism, figures)
    closes = period_of(mechanism, places) if period == "auto" else period
    request = FigureRequest(mechanism, tuple(figures), places, speed, closes, refine, path)
    designs = request.designs(arrays)
    if designs.trace is None or not can_reduce(request) or not designs.is_compiled:
        return request.values_for(arrays, cores)
    reduced, doubtful = reduced_figures(request, arrays, designs.trace, cores)
    if np.any(doubtful):
        some = {name: values[doubtful] for name, values in arrays.items()}
        reduced[:, doubtful] = replace(request, path="auto").values_for(
            some, cores
        )  # few: another function rarely pays
    return reduced


def usual_path(figures: Sequence[Figure], size: int) -> str:
    """The path by name that "auto" takes for so many designs times crank angles: one for all blocks of a sweep."""
    return "compiled" if is_worthwhile("auto", USUAL_LIST + OF_FIGURE * len(figures), size) else "numpy"


def _checked_places(angle: ArrayLike, least: int) -> Array:
    """Crank angles (angles,), rad; raises LinkproofError for less than some, and such as do not ascend."""
    places = np.asarray(angle, dtype=float)
    is_list = places.ndim == 1 and len(places) >= least
    if not (is_list and np.all(np.diff(places) > 0.0) and np.all(np.isfinite(places))):
        raise LinkproofError(
            f"angle: expected a flat list of {least} or more finite crank angles in rad, ascending, got "
            f"{'others' if is_list else f'shape {places.shape}'}; pass such a list"
        )
    return places


def period_of(mechanism: Mechanism, places: Array) -> float | None:
    """The period, rad, of crank angles that divide a turn evenly, its end left out; None for any others."""
    return None if mechanism.linkage.is_linear or not is_turn(places) else FULL_TURN


def _check_names(mechanism: Mechanism, figures: Sequence[Figure]) -> None:
    """Raise UnknownNameError for a figure of a signal that the mechanism does not have."""
    known = {*table(mechanism), *names_with_magnitudes(mechanism)}
    for figure in figures:
        if figure.signal not in known:
            raise UnknownNameError("signal", figure.signal, known)


def is_turn(places: Array) -> bool:
    """Whether crank angles, rad, divide a turn evenly, the end left out."""
    step = FULL_TURN / len(places)
    return bool(np.all(np.abs(np.diff(places) - step) <= EVEN * step))
