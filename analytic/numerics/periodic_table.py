"""Smooth functions of the crank angle as polynomials cell by cell: evaluated in a few microseconds, to a few roundings.

The closed form costs hundreds of microseconds a call however few the angles, far too much for an integrator that asks
for a handful of angles at a time. Over one turn its functions are tabulated once: cells are halved until the polynomial
through a cell's Chebyshev nodes meets the function between them, so sharp peaks and kinks cost cells, not accuracy.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import Final

import numpy as np
from numpy.polynomial import chebyshev

from analytic.description.law import FULL_TURN
from analytic.numerics.arrays import Array

Functions = Callable[[Array], Array]

FIRST_CELLS: Final = 64
DEGREE: Final = 12
TOLERANCE: Final = 4e-15  # of each function's peak: the closed form's own rounding
# Halving a cell that shrinks its error by less than this, once that is small, only chases the closed form's rounding.
PROGRESS, SMALL = 0.6, 1e-11
# Neighbours so close, rad, that a function differs between them by rounding alone; one that differs by more than SMALL
# of its peak is held to that rounding instead of its peak, or it would be halved to the end without getting nearer.
NEIGHBOUR: Final = 1e-14
OUTLIER: Final = 32.0  # times the rounding of a few places is that of others, and of the polynomial through them
PIECE: Final = 16384  # angles at a time: a linkage of many links takes kilobytes an angle
MOST_HALVINGS: Final = 40  # a cell of 1e-13 rad: nothing narrower can be distinguished from a jump
MOST_CELLS: Final = 8192  # of a level: beyond it refining is given up, and the error says so


@dataclass(frozen=True)
class PeriodicTable:
    """Functions of a period, which ``edges`` (cells + 1,), rad, span from 0 on.

    ``coefficients`` (cells, degree + 1, functions) are of powers, from the zeroth on, of the coordinate in [-1, 1]
    across the cell; ``error`` is the largest deviation between the nodes, relative to the function's peak, or to its
    rounding if that is more than ``SMALL`` of it.
    """

    edges: Array
    coefficients: Array
    error: float

    @cached_property
    def _cells(self) -> tuple[Array, Array, Array]:
        """Borders between the cells, rad, and middle, rad, and reciprocal half width, 1/rad, of every cell."""
        left, right = self.edges[:-1], self.edges[1:]
        return left[1:], 0.5 * (left + right), 2.0 / (right - left)

    def __call__(self, angle: Array) -> Array:
        """Every function at each crank angle, rad, less whole periods; shape (functions, *angle.shape)."""
        turned, (borders, middle, scale) = angle.ravel() % self.edges[-1], self._cells
        cell = borders.searchsorted(turned, "right")
        powers = np.empty((len(turned), 1, self.coefficients.shape[1]))
        powers[:, 0, 0] = 1.0
        powers[:, 0, 1:] = ((turned - middle[cell]) * scale[cell])[:, None]
        np.multiply.accumulate(powers, axis=2, out=powers)
        values = powers @ self.coefficients.take(cell, axis=0)
        return np.asarray(values.T.reshape(self.coefficients.shape[2], *angle.shape))


def tabulate(functions: Functions, degree: int = DEGREE, *, period: float = FULL_TURN) -> PeriodicTable:
    """Tabulate functions over a period, rad, with polynomials of a degree.

    ``functions`` is called with angles (n,), rad, and gives values (functions, n). Cells are halved until the table
    meets each function to rounding, or cannot get nearer; the table's ``error`` says how near it is.
    """
    nodes, analysis, powers = _rules(degree)
    between = chebyshev.chebpts2(degree + 2)
    checked = np.vander(between, degree + 1, increasing=True)
    edges = np.linspace(0.0, period, FIRST_CELLS + 1)
    left, right = edges[:-1], edges[1:]
    parents: Array = np.full(len(left), np.inf)
    noise = _rounding(functions, left, right, nodes)
    peak = np.zeros(noise.shape[1])
    done: list[tuple[Array, Array, Array]] = []
    for level in range(MOST_HALVINGS + 1):
        last = level == MOST_HALVINGS or len(left) > MOST_CELLS
        values = _sampled_functions(functions, left, right, nodes)
        peak = np.maximum(np.abs(values).max(axis=(1, 2)), peak)
        size = np.maximum(peak, OUTLIER * noise / SMALL)
        size[size == 0.0] = 1.0
        # Two products: in one, the large entries of the conversion to powers would amplify roundings of the values.
        coefficients = np.moveaxis((values @ analysis.T) @ powers.T, 0, -1)
        true = np.moveaxis(_sampled_functions(functions, left, right, between), 0, -1)
        deviation = np.abs(checked @ coefficients - true).max(axis=1)
        error = (deviation / size).max(axis=1)
        accepted = (error <= TOLERANCE) | ((error < SMALL) & (error > PROGRESS * parents)) | last
        done.append((left[accepted], coefficients[accepted], error[accepted]))
        if np.all(accepted):
            break
        middle = 0.5 * (left + right)
        left, right = (
            np.concatenate([left[~accepted], middle[~accepted]]),
            np.concatenate([middle[~accepted], right[~accepted]]),
        )
        parents, noise = np.tile(error[~accepted], 2), np.tile(noise[~accepted], (2, 1))
    starts, coefficients, errors = (np.concatenate(parts) for parts in zip(*done, strict=True))
    order = np.argsort(starts)
    return PeriodicTable(
        np.append(starts[order], period), np.ascontiguousarray(coefficients[order]), float(errors.max())
    )


def _rounding(functions: Functions, left: Array, right: Array, places: Array) -> Array:
    """The largest difference of neighbouring values in each cell (cells, functions): a smooth function's rounding.

    ``left`` and ``right`` (cells,), rad, are the cells' ends, ``places`` of [-1, 1] those in each to look at.
    """
    here, beside = (_sampled_functions(functions, left + shift, right + shift, places) for shift in (0.0, NEIGHBOUR))
    return np.asarray(np.abs(beside - here).max(axis=2).T)


@lru_cache
def _rules(degree: int) -> tuple[Array, Array, Array]:
    """Chebyshev nodes on [-1, 1], the matrix from values there to coefficients, and from these to powers.

    ``degree`` is that of the polynomial; the coefficients are Chebyshev's. They are made once and kept.
    """
    nodes = chebyshev.chebpts1(degree + 1)
    orders = np.arange(degree + 1)
    analysis = np.cos(np.outer(orders, np.arccos(nodes))) * (2.0 / (degree + 1))
    analysis[0] *= 0.5
    powers = np.zeros((degree + 1, degree + 1))
    for order in orders:
        powers[: order + 1, order] = chebyshev.cheb2poly(np.eye(degree + 1)[order])[: order + 1]
    return nodes, analysis, powers


def _sampled_functions(functions: Functions, left: Array, right: Array, places: Array) -> Array:
    """The functions at ``places`` of [-1, 1] across every cell; (functions, cells, places).

    ``left`` and ``right`` (cells,), rad, are the cells' ends; ``functions`` is called with at most ``PIECE`` angles.
    """
    angle = left[:, None] + np.multiply.outer(right - left, 0.5 * (places + 1.0))
    flat = angle.ravel()
    pieces = [functions(flat[start : start + PIECE]) for start in range(0, flat.size, PIECE)]
    return np.concatenate(pieces, axis=-1).reshape(-1, *angle.shape)
