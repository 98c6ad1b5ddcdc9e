"""Signals of many designs of one linkage over crank angles, with all of their curves."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any, Final

import numpy as np
from numpy.typing import ArrayLike, NDArray

from analytic.designs.checking import checked
from analytic.designs.samples import BLOCK, Designs, Integers, Sampler
from analytic.errors import LinkproofError
from analytic.kinematics.mechanism import Mechanism
from analytic.signals import check_signals

ASSEMBLED: Final = "assembled"


def evaluate_designs(
    mechanism: Mechanism,
    parameters: Mapping[str, ArrayLike],
    angle: ArrayLike,
    names: Iterable[str],
    *,
    speed: ArrayLike | None = None,
    acceleration: ArrayLike = 0.0,
    cores: int | None = None,
    path: str = "auto",
) -> dict[str, NDArray[Any]]:
    """Signals by name for every design and crank angle, (designs, angles), SI; S counts from the ground's origin.

    ``parameters`` are arrays (designs,) of numbers of the description, SI, by the names of
    ``analytic.description.changes``; all else is as described, and the assembly modes are those that its sketch picks.
    ``angle`` (angles,) is in rad; ``speed`` (rad/s) and ``acceleration`` (rad/s²) are scalar or one per angle.

    Where a design cannot be assembled or stands in a dead position its values are nan, and False in ``assembled``,
    which is returned besides; that counts for the links that the signals need. ``cores`` is the number of threads, all
    of the machine's if None; ``path`` is as for ``analytic.evaluation.evaluate``.
    """
    places = np.asarray(angle, dtype=float)
    if places.ndim != 1 or not np.all(np.isfinite(places)):
        raise LinkproofError(
            "angle: expected a flat list of finite crank angles in rad, got "
            f"{'nan or infinity' if places.ndim == 1 else f'shape {places.shape}'}; pass such a list"
        )
    arrays = checked(mechanism.linkage, parameters)
    chosen = check_signals(mechanism, names, has_speed=speed is not None)
    count = len(next(iter(arrays.values())))
    designs = Designs(
        mechanism, arrays, chosen, 0.0 if speed is None else speed, acceleration,
        all_groups=False, path=path, poses=count * len(places),
    )  # fmt: skip
    values = np.full((len(chosen), count, len(places)), np.nan)
    moves = np.zeros(values.shape[1:], dtype=np.bool_)

    def work(rows: Integers, sampler: Sampler) -> None:
        samples = sampler(rows, np.broadcast_to(places, (len(rows), len(places))), chosen)
        moves[rows] = samples.moves
        for row, name in zip(values, chosen, strict=True):
            row[rows] = np.where(samples.moves, samples.signals[name], np.nan)

    designs.in_blocks(max(1, BLOCK // max(1, len(places))), work, cores)
    return {**dict(zip(chosen, values, strict=True)), ASSEMBLED: moves}
