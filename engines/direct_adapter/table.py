"""Functions of the crank angle as Chebyshev series on panels that are halved until the series end in rounding."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.polynomial import chebyshev

from engines.direct_adapter.assembly import UnsolvableError
from engines.direct_adapter.equations import Reals
from engines.direct_adapter.path import FULL_TURN, Path

POINTS = 16
PANELS = 24
HALVINGS = 12
MOST = 4096  # panels; a function that needs more has no series, as at a dead point
TAIL = 1e-14  # of a function's size: what a panel's series may end in
NOISE = 1e-9  # likewise, where rounding keeps it from ending in less
LEAST = 1e-3  # of the terms of a function: its size where the terms cancel

Functions = Callable[[Reals], tuple[Reals, Reals]]  # angles (n,) in; values and magnitudes of their terms (c, n) out
Panel = tuple[float, float, float]  # start, end, tail of the series of the panel it is half of

_ORDERS = np.arange(POINTS, dtype=float)
_NODES = chebyshev.chebpts1(POINTS)
_TO_SERIES = np.linalg.inv(chebyshev.chebvander(_NODES, POINTS - 1))


@dataclass(frozen=True)
class Table:
    """Functions of φ on panels between ``edges`` (p + 1,): ``series`` (p, functions, points).

    ``largest`` (functions,) is the largest magnitude of each; ``repeats`` tells whether the panels make a full turn.
    """

    edges: Reals
    series: Reals
    largest: Reals
    repeats: bool

    def __call__(self, angle: Reals) -> Reals:
        """All functions (c, n) at crank angles (n,); raises UnsolvableError outside the panels."""
        start, end = self.edges[0], self.edges[-1]
        if self.repeats:
            angle = start + (angle - start) % FULL_TURN
        elif not (np.min(angle) >= start and np.max(angle) <= end):
            stop = math.degrees(start if np.min(angle) < start else end)
            raise UnsolvableError(f"the free crank runs up against its stop at {stop:.4g}°")
        panel = np.minimum(np.searchsorted(self.edges, angle, side="right"), len(self.series)) - 1
        left, right = self.edges[panel], self.edges[panel + 1]
        x = np.minimum(1.0, np.maximum(-1.0, (2.0 * angle - left - right) / (right - left)))
        terms = np.cos(np.arccos(x)[:, None] * _ORDERS)
        return np.asarray((self.series[panel] @ terms[..., None])[..., 0].T)


def tabulate(functions: Functions, path: Path) -> Table:
    """The functions' series over a path; raises UnsolvableError where they are not finite."""
    edges = np.linspace(path.angle[0], path.angle[-1], PANELS + 1)
    todo = [(float(left), float(right), math.inf) for left, right in itertools.pairwise(edges)]
    done: list[tuple[float, Reals]] = []
    largest = terms = np.zeros(1)
    for halving in range(HALVINGS + 1):
        series, sizes, magnitudes = _fitted(functions, todo)
        largest, terms = np.maximum(largest, sizes), np.maximum(terms, magnitudes)
        scale = np.maximum(largest, LEAST * terms)
        tails = np.max(np.abs(series[:, :, -2:]) / np.where(scale > 0.0, scale, 1.0)[:, None], axis=(1, 2))
        before = np.array([tail for *_, tail in todo])
        # What is small and does not get smaller by halving is rounding.
        ended = (tails <= TAIL) | ((tails <= NOISE) & (tails > 0.5 * before))
        if halving == HALVINGS or len(done) + 2 * len(todo) > MOST:
            ended[:] = True
        done += [(todo[i][0], series[i]) for i in np.flatnonzero(ended)]
        todo = [half for i in np.flatnonzero(~ended) for half in _halves(*todo[i][:2], float(tails[i]))]
        if not todo:
            break
    done.sort(key=lambda panel: panel[0])
    starts = [start for start, _ in done]
    series = np.stack([part for _, part in done])
    return Table(np.array([*starts, path.angle[-1]]), series, largest, path.turns is not None)


def _fitted(functions: Functions, panels: list[Panel]) -> tuple[Reals, Reals, Reals]:
    """Series (p, c, points), and the largest values and magnitudes (c,) met in fitting them."""
    left, right = np.array([panel[:2] for panel in panels]).T
    angles = 0.5 * (left + right)[:, None] + 0.5 * (right - left)[:, None] * _NODES
    values, magnitudes = functions(angles.ravel())
    if not np.all(np.isfinite(values)):
        raise UnsolvableError("the equation of motion is not finite everywhere; check masses, inertias and loads")
    series = np.einsum("kj,cpj->pck", _TO_SERIES, values.reshape(len(values), *angles.shape))
    return series, np.max(np.abs(values), axis=1), np.max(magnitudes, axis=1)


def _halves(left: float, right: float, tail: float) -> tuple[Panel, Panel]:
    middle = 0.5 * (left + right)
    return (left, middle, tail), (middle, right, tail)
