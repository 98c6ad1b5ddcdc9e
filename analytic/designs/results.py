"""Figures of many designs at once: peaks, means and single values of any signal, without its curves."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import replace
from typing import Final, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from analytic.compiled.choice import cores as available
from analytic.compiled.choice import is_compiled
from analytic.compiled.design_figures import can_figure, compiled_figures
from analytic.compiled.flat_linkage import FlatLinkage, flatten, redesigned
from analytic.description.law import FULL_TURN
from analytic.designs.batches import Booleans, Integers
from analytic.designs.checking import checked
from analytic.designs.figures import Figure, Reduction
from analytic.designs.means import is_settled
from analytic.designs.sampling import Asked
from analytic.designs.values import designs_of
from analytic.errors import LinkproofError, UnknownNameError
from analytic.kinematics.mechanism import Mechanism
from analytic.signals import MAGNITUDE, formulas

Array = NDArray[np.float64]

FEWEST: Final = 3  # crank angles, so that a top has neighbours, where it is refined
EVEN: Final = 1e-9  # of a step
# s per design and crank angle on one core, measured on the six-bar.
PLAIN, WITH_FORCES = 1.0e-7, 2.3e-7


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
    ``analytic.description.changes``; all else is as described, and the assembly modes are those that its sketch picks.
    A signal is sampled at the crank angles ``angle`` (angles,), rad, ascending; S counts from the design's own largest
    output. With ``refine`` the extremes are the true ones between the samples, and S counts from the true top: over a
    ``period``, rad, or over a range, whose ends count, if None; "auto" is a turn where the angles divide one evenly.
    Means are integrals over the same, whatever the samples, and of S from the true top.

    The figures of a design that cannot be assembled, or stands in a dead position, at or between any of the angles are
    nan, and so are those of one that passes a change point where the linkage as described passes none. ``cores`` and
    ``path`` are as for ``analytic.evaluation.evaluate``; refined extremes and the angles of links but the crank are
    NumPy's in any case. Raises UnknownNameError and LinkproofError as ``evaluate_designs`` does.
    """
    places = _checked_places(angle, FEWEST if refine else 1)
    arrays = checked(mechanism.linkage, parameters)
    names = _known_names(mechanism, figures)
    closes = period_of(mechanism, places) if period == "auto" else period
    asked = Asked(mechanism, tuple(figures), places, speed, closes, refine)
    able = not refine and can_figure(mechanism.structure, names)
    if is_compiled(path, "figures", _seconds(names, len(next(iter(arrays.values()))) * len(places), cores)) and able:
        flat = flatten(mechanism)
        if set(arrays) <= set(flat.places):
            return _by_kernels(flat, asked, arrays, cores)
    return asked.of(arrays, cores)


def _by_kernels(flat: FlatLinkage, asked: Asked, arrays: Mapping[str, Array], cores: int | None) -> Array:
    """Figures of designs by the kernels; by NumPy which of them stand, and means for which the samples are too few."""
    designs, count = designs_of(flat, arrays), len(asked.figures)
    means = [row for row, one in enumerate(asked.figures) if one.is_mean]
    averaged = [asked.figures[row] for row in means]

    def sampled(figures: Sequence[Figure], places: Array) -> tuple[Array, Booleans]:
        return compiled_figures(
            flat, figures, places, largest=redesigned(flat, designs.largest()), count=designs.count,
            designs=designs.rows, speed=asked.speed, cores=cores,
        )  # fmt: skip

    def some(rows: Integers) -> dict[str, Array]:
        return {name: values[rows] for name, values in arrays.items()}

    every, doubtful = sampled([*asked.figures, *(Figure(one.signal, Reduction.RMS) for one in averaged)], asked.places)
    found, sizes = every[:count], every[count:]
    rows = np.flatnonzero(doubtful)
    if len(rows):
        found[:, rows[asked.stand(some(rows), cores)]] = np.nan
    if means:
        few = doubtful | ~np.array(all(map(asked.may_sample, averaged)))
        if not np.all(few):
            few |= ~is_settled(found[means], sampled(averaged, asked.places[::2])[0], sizes).all(axis=0)
        rows = np.flatnonzero(few & np.isfinite(found[means[0]]))
        if len(rows):
            found[np.array(means)[:, None], rows] = replace(asked, figures=tuple(averaged)).of(some(rows), cores)
    return found


def usual_path(figures: Sequence[Figure], size: int, cores: int | None = None) -> str:
    """The path by name that "auto" takes for so many designs times crank angles: one for all blocks of a sweep."""
    seconds = _seconds([one.signal for one in figures], size, cores)
    return "compiled" if is_compiled("auto", "figures", seconds) else "numpy"


def _seconds(names: Collection[str], size: int, cores: int | None) -> float:
    """What NumPy takes for signals of so many designs times crank angles, about."""
    each = WITH_FORCES if any(name.startswith("joint_force:") for name in names) else PLAIN
    return each * size / (cores or available())


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
    """A turn where places of a crank divide one evenly, its end left out."""
    return None if mechanism.linkage.is_linear or not is_turn(places) else FULL_TURN


def _known_names(mechanism: Mechanism, figures: Sequence[Figure]) -> set[str]:
    """The signals of the figures; raises UnknownNameError for one that the mechanism does not have."""
    names = {one.signal for one in figures}
    known = list(formulas(mechanism))
    forces = [name.removesuffix(":x") for name in known if "force:" in name and name.endswith(":x")]
    known += [force + MAGNITUDE for force in forces]
    for name in names:
        if name not in known:
            raise UnknownNameError("signal", name, known)
    return names


def is_turn(places: Array) -> bool:
    """Whether crank angles, rad, divide a turn evenly, the end left out."""
    step = FULL_TURN / len(places)
    return bool(np.all(np.abs(np.diff(places) - step) <= EVEN * step))
