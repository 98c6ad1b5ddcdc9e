"""A load as a function of a coordinate: constant, or a table made into a cubic spline or lines.

The coordinate is φ, the driver's, or S, the output's travel from its top dead centre. Over a crank angle the table is
closed into a period, of one turn or of two. Over a travel it is not: beyond its ends the load keeps its last value.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING, Annotated, Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from analytic.description.units import Kind

if TYPE_CHECKING:
    from scipy.interpolate import PPoly

FULL_TURN = 2.0 * np.pi


@dataclass(frozen=True)
class TimeLaw:
    """A number that depends on time alone: straight lines between its values, the first and last of them outside.

    Straight lines follow a switched drive without overshoot. ``times``, s, increase; ``torque`` has the values,
    N m, as many.
    """

    times: Annotated[tuple[float, ...], Kind.TIME]
    torque: Annotated[tuple[float, ...], Kind.DRIVE]

    def __call__(self, time: ArrayLike) -> NDArray[np.float64]:
        """The drive's torque, N m, or force, N, at each time, s; shape of ``time``."""
        return np.asarray(np.interp(np.asarray(time, dtype=float), self.times, self.torque))


@dataclass(frozen=True, eq=False)
class Law:
    """A scalar or a vector that depends on the linkage's place, and on which way it moves, alone.

    ``values`` has shape (k,) for a constant of k components; with ``angles`` of shape (n,), rad, increasing and
    spanning less than one ``period``, rad, it has shape (n, k) and the law is the periodic cubic spline through it. One
    without a period is over a travel, m: a not-a-knot spline, constant beyond its ends. Between the values of one that
    is ``linear`` are straight lines instead; its derivative at an angle of the table is that of the line behind it.

    ``over`` says what ``angles`` are of: φ, or S, m. With ``when`` the law is zero while the output does not
    "advance", so that S grows, or "return".
    """

    values: NDArray[np.float64]
    angles: NDArray[np.float64] | None = field(default=None)
    period: float | None = FULL_TURN
    linear: bool = False
    over: Literal["phi", "S"] = "phi"
    when: Literal["advance", "return"] | None = None

    @property
    def is_constant(self) -> bool:
        """Whether the law ignores the motion, so that an engine can set it once: it has no table and no ``when``."""
        return self.angles is None and self.when is None

    @property
    def corners(self) -> tuple[float, ...]:
        """Where the law has a corner, rad or m: the angles of straight lines, and the ends of a table over a travel.

        Else ().
        """
        if self.angles is None or not (self.linear or not self.period):
            return ()
        return tuple((self.angles if self.linear else self.angles[[0, -1]]).tolist())

    @cached_property
    def _curve(self) -> PPoly:
        """The cubic spline, or the straight lines, through the table of the law, repeating if it has a period.

        Only a law with a table has one; else AssertionError is raised.
        """
        from scipy.interpolate import CubicSpline, PPoly  # noqa: PLC0415 - a linkage without tables does not pay for it

        assert self.angles is not None
        knots, values = self.angles, self.values
        if self.period:
            knots, values = np.append(knots, knots[0] + self.period), np.vstack([values, values[:1]])
        if not self.linear:
            return CubicSpline(knots, values, bc_type="periodic" if self.period else "not-a-knot")
        slopes = np.diff(values, axis=0) / np.diff(knots)[:, None]
        cubics = np.stack([np.zeros_like(slopes), np.zeros_like(slopes), slopes, values[:-1]])
        return PPoly(cubics, knots, extrapolate="periodic" if self.period else None)

    def __call__(self, angle: ArrayLike, order: int = 0) -> NDArray[np.float64]:
        """Value, SI, or its derivative of the given order over the coordinate, at each angle, rad, or travel, m.

        Shape (k, *angle.shape); of a traced ``angle`` a list of k traced numbers. The restriction ``when`` is not
        applied here.
        """
        if self.angles is None:
            values, shape = self.values if order == 0 else np.zeros_like(self.values), np.shape(angle)
            return np.broadcast_to(values.reshape(-1, *([1] * len(shape))), (len(values), *shape))
        if hasattr(angle, "looked_up"):  # a traced one
            array: NDArray[np.float64] = angle.looked_up(self, order)
            return array
        angle = np.asarray(angle, dtype=float)
        if self.period:
            return np.moveaxis(np.asarray(self._curve(angle, order)), -1, 0)
        within = np.clip(angle, self.angles[0], self.angles[-1])
        inside = (within == angle) | (order == 0)
        return np.moveaxis(np.asarray(self._curve(within, order)) * inside[..., None], -1, 0)

    def formula(self, place: Any) -> list[Any]:  # noqa: ANN401 - a traced number
        """Components of the load at a traced place within or beyond its table, as formulas without branches.

        Nothing repeats: beyond the ends it keeps the value there, as a table over a travel does.
        """
        knots, pieces = self.pieces()
        within = np.minimum(np.maximum(place, knots[0]), knots[-1])
        begun = [within >= knot for knot in knots[1 : len(pieces)]]

        def chosen(values: list[float]) -> Any:  # noqa: ANN401
            """The one of these ``values``, one for each interval of the table in order, that holds at the place."""
            result: Any = values[0]
            for has_begun, value in zip(begun, values[1:], strict=True) if any(values) else ():
                result = np.where(has_begun, value, result)
            return result

        x = within - chosen(knots[: len(pieces)])
        parts = []
        for component in zip(*pieces, strict=True):
            a, b, c, d = (chosen(list(power)) for power in zip(*component, strict=True))
            parts.append(a + x * (b + x * (c + x * d)))
        return parts

    def pieces(self) -> tuple[list[float], list[Any]]:
        """A table as plain data: knots, rad or m, and by piece and component its coefficients, lowest power first.

        Coefficients are of the distance from the piece's first knot. The knots are the table's places alone; with a
        period there is a last piece behind them. Raises AssertionError for a constant.
        """
        assert self.angles is not None
        return self.angles.tolist(), np.moveaxis(self._curve.c[::-1], 0, -1).tolist()


@dataclass(frozen=True, eq=False)
class LawOfNumbers(Law):
    """A law whose values are arrays, one number for each of many designs: splines and lines are linear in them.

    ``numbers`` are the values in order, of a table row by row, each a number or an array that goes with the angles;
    ``values`` are of the law's own shape.
    """

    numbers: tuple[Any, ...] = ()

    def __call__(self, angle: ArrayLike, order: int = 0) -> Any:  # noqa: ANN401 - what the numbers are
        """Components, N or N m, or their derivatives of an order, as a tuple, at ``angle``, rad or m.

        Places and numbers that are arrays are broadcast together. ``when`` is not applied.
        """
        parts = self.values.shape[-1]
        rows = [self.numbers[start : start + parts] for start in range(0, len(self.numbers), parts)]
        unit = np.eye(len(rows))
        shares = Law(unit[0] if self.angles is None else unit, self.angles, self.period, self.linear, self.over)
        weights = shares(angle, order)
        return tuple(
            sum(weight * row[part] for weight, row in zip(weights, rows, strict=True)) for part in range(parts)
        )
