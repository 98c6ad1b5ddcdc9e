"""The designs of a sweep that its picture draws: all, or a sample of many, with the best and the file's own."""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

from analytic.errors import printable
from comparisons.designs.space import ONE_BY_ONE
from reports.document import numbers
from reports.document.chart import Array, axis_label

if TYPE_CHECKING:
    import xarray


MOST: Final = 9  # figures in one picture
SAMPLE: Final = 20_000  # designs in a curve or a map
LINES: Final = 2_000  # designs drawn as a line each
FAR: Final = 3.0  # times the span of eight tenths of the values: beyond, these are shown and the others cut off
CUT: Final = "If two numbers follow a name, values reach that far and are cut off, to separate the others."
SIGNED: Final = (".mean", ".max", ".min")  # figures that may be negative, as those at an angle
FAILS: Final = "does not assemble"
OWN: Final = "design of the file"


@dataclass(frozen=True)
class DrawnDesigns:
    """Designs over a dimension per parameter, or over one, ``design``, with the parameters as coordinates.

    nan is a design that does not assemble. ``own`` are the numbers of the file by name, in its units; ``count`` is the
    number of designs of which these are drawn.
    """

    dataset: xarray.Dataset
    own: Mapping[str, float]
    count: int

    @property
    def are_lines(self) -> bool:
        """Whether designs are one beside the other, not on a grid of one or two numbers."""
        return ONE_BY_ONE in self.dataset.dims

    @property
    def parameters(self) -> tuple[str, ...]:
        """Names of the varied parameters."""
        return tuple(str(name) for name in (self.dataset.coords if self.are_lines else self.dataset.dims))

    @property
    def figures(self) -> tuple[str, ...]:
        """The figures that are drawn."""
        return tuple(map(str, self.dataset.data_vars))[:MOST]

    def values(self, name: str) -> Array:
        """The values of a figure or a parameter over the designs, in the file's unit."""
        return np.asarray(self.dataset[name].values, dtype=float)

    def failing(self, name: str) -> int:
        """Number of designs without this figure."""
        return int(np.count_nonzero(np.isnan(self.values(name))))

    def best(self, name: str) -> int | None:
        """The design, in the order of the dimensions, whose figure is nearest to its target; None where all fail."""
        away = np.abs(self.values(name) - self.target(name)[0])
        return None if np.all(np.isnan(away)) else int(np.nanargmin(away))

    def span(self, name: str) -> tuple[float, float] | None:
        """Limits of a figure's scale that cut off a few very large values, such as those near dead positions.

        Twice the span of eight tenths of all, and the value nearest to the target; None where all can be shown.
        """
        values = self.values(name)
        values = values[np.isfinite(values)]
        if not len(values):
            return None
        low, high = np.quantile(values, [0.1, 0.9])
        if np.ptp(values) <= FAR * (high - low) or high == low:
            return None
        half, nearest = 0.5 * (high - low), values[np.argmin(np.abs(values - self.target(name)[0]))]
        ends = max(np.min(values), min(low - half, nearest)), min(np.max(values), max(high + half, nearest))
        return float(ends[0]), float(ends[1])

    def unit(self, name: str) -> str:
        """The unit of a parameter or figure, of the file."""
        return printable(str(self.dataset[name].attrs.get("units", "")))

    def label(self, name: str) -> str:
        """A name with its unit; of values that are cut off in the picture with both ends of all."""
        ends = ""
        if name in self.figures and self.span(name):
            values = self.values(name)
            ends = f" ({numbers.figure(np.nanmin(values))} to {numbers.figure(np.nanmax(values))})"
        return axis_label(f"{printable(name)}{ends}", self.unit(name))

    def target(self, figure: str) -> tuple[float, str]:
        """The best value of a figure, and the note on the design nearest to it."""
        if figure.startswith("transmission_angle:") and not figure.endswith(".range"):
            return 0.5 * math.pi if self.unit(figure) == "rad" else 90.0, "nearest to 90°"
        return 0.0, "nearest to 0" if figure.endswith(SIGNED) or "@" in figure else "least"

    @property
    def own_place(self) -> tuple[float, ...]:
        """The file's own numbers by parameter if they lie among the designs, else nothing."""
        place = tuple(self.own[name] for name in self.parameters)
        ends = [(np.min(values), np.max(values)) for values in map(self.values, self.parameters)]
        return place if all(low <= value <= high for value, (low, high) in zip(place, ends, strict=True)) else ()

    @property
    def head(self) -> tuple[str, ...]:
        """Lines above the picture: whose designs, under which conditions, what is left out."""
        about, left = self.dataset.attrs, len(self.dataset.data_vars) - len(self.figures)
        conditions = about["conditions"].removeprefix(f"{about['mechanism']} ({about['variant']}): ")
        drawn, failing = self.dataset[self.figures[0]].size, max(map(self.failing, self.figures))
        sample = f", a sample of {_grouped(drawn)} is drawn" if drawn < self.count else ""
        fails = f", {_grouped(failing)} of which {'does' if failing == 1 else 'do'} not assemble" if failing else ""
        designs = f"{_grouped(self.count)} design{'s' * (self.count != 1)}{sample}{fails}"
        cut = CUT if any(map(self.span, self.figures)) else ""
        more = f"The first {MOST} of {left + MOST} figures are drawn." if left else ""
        texts = (f"{about['mechanism']}, {about['variant']}: {designs}", conditions, cut, more)
        return tuple(printable(text) for text in texts if text)


def drawn_designs(dataset: xarray.Dataset, own: Mapping[str, float], always: Collection[int]) -> DrawnDesigns:
    """The designs of a sweep to draw: a grid of one or two numbers thinned out evenly, of others a random sample.

    ``always`` are numbers of designs that are among them, in the order of the dimensions.
    """
    shape = tuple(dataset.sizes.values())
    count, always_drawn = math.prod(shape), np.array(sorted(always), dtype=int)
    if ONE_BY_ONE not in dataset.dims and len(shape) < 3:
        most = round(SAMPLE ** (1.0 / len(shape)))
        chosen = {}
        for name, size, indices in zip(dataset.dims, shape, np.unravel_index(always_drawn, shape), strict=True):
            places = np.linspace(0, size - 1, min(size, most)).round().astype(int)
            chosen[name] = np.union1d(places, indices)
        thinned = dataset.isel(chosen)
        return DrawnDesigns(thinned.sortby(list(thinned.dims)), own, count)
    rng = np.random.default_rng(0)
    some = np.arange(count) if count <= LINES else rng.choice(count, LINES, replace=False, shuffle=False)
    chosen_at = np.unravel_index(np.union1d(some, always_drawn), shape)
    drawn = dataset.isel({name: (ONE_BY_ONE, at) for name, at in zip(dataset.dims, chosen_at, strict=True)})
    return DrawnDesigns(drawn, own, count)


def _grouped(count: int) -> str:
    return numbers.grouped(count, "\N{NARROW NO-BREAK SPACE}")
