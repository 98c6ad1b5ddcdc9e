"""Figures of many designs at once: peaks, means and single values of any signal, without its curves."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Final, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from analytic.description.law import FULL_TURN
from analytic.designs.batches import Integers, Sweeps, in_blocks
from analytic.designs.checking import checked
from analytic.designs.figures import Figure
from analytic.designs.sampling import Asked
from analytic.errors import LinkproofError
from analytic.kinematics.mechanism import Mechanism

Array = NDArray[np.float64]

CHUNK: Final = 2048  # designs a thread takes at a time: their tops are refined together
FEWEST: Final = 3  # crank angles, so that a top has neighbours
EVEN: Final = 1e-9  # of a step


def design_figures(
    mechanism: Mechanism,
    parameters: Mapping[str, ArrayLike],
    figures: Sequence[Figure],
    angle: ArrayLike,
    *,
    speed: float,
    weights: ArrayLike | None = None,
    period: float | Literal["auto"] | None = "auto",
    refine: bool = False,
    cores: int | None = None,
    path: str = "auto",
) -> Array:
    """Figures of every design, (figures, designs), SI; the crank turns at a constant ``speed``, rad/s, signed.

    ``parameters`` are arrays (designs,) of numbers of the description, SI, by the names of
    ``analytic.description.changes``; all else is as described, and the assembly modes are those that its sketch picks.
    A signal is sampled at the crank angles ``angle`` (angles,), rad, ascending; its means take the ``weights``
    (angles,), which add up to one: equal ones if None. S counts from the design's own largest output.

    With ``refine`` the extremes are the true ones, looked for between neighbours of the highest samples, and S counts
    from the true top. They are those over a ``period``, rad, or over a range, whose ends count, if that is None; by
    default over a turn where the angles divide one evenly, its end left out.

    The figures of a design that cannot be assembled, or stands in a dead position, at any of the angles are nan.
    ``cores`` and ``path`` are as for ``analytic.evaluation.evaluate``. Raises UnknownNameError and LinkproofError as
    ``analytic.designs.values.evaluate_designs`` does.
    """
    places = np.asarray(angle, dtype=float)
    if places.ndim != 1 or len(places) < FEWEST or not np.all(np.diff(places) > 0.0) or not np.all(np.isfinite(places)):
        raise LinkproofError(
            f"angle: expected a flat list of {FEWEST} or more finite crank angles in rad, ascending, got "
            f"{f'shape {places.shape}' if places.ndim != 1 or len(places) < FEWEST else 'others'}; pass such a list"
        )
    arrays = checked(mechanism.linkage, parameters)
    count = len(next(iter(arrays.values())))
    share = np.full(places.shape, 1.0 / len(places)) if weights is None else np.asarray(weights, dtype=float)
    full = None if mechanism.linkage.is_linear or not is_turn(places) else FULL_TURN
    asked = Asked(mechanism, tuple(figures), places, speed, share, full if period == "auto" else period, refine)
    found = np.full((len(figures), count), np.nan)

    def work(rows: Integers, sweeps: Sweeps) -> None:
        found[:, rows] = asked.of(sweeps, rows)

    in_blocks(mechanism, arrays, CHUNK, work, cores)
    return found


def is_turn(places: Array) -> bool:
    """Whether crank angles, rad, divide a turn evenly, the end left out."""
    step = FULL_TURN / len(places)
    return bool(np.all(np.abs(np.diff(places) - step) <= EVEN * step))
