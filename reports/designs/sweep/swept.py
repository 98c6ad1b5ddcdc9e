"""A sweep's dataset as its pictures read it: parameters, figures, the best design, the file's own, lines of words."""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, Final

import numpy as np
from numpy.typing import NDArray

from analytic.errors import printable
from reports.designs.sweep import thinning
from reports.designs.sweep.thinning import Indices, Kept, PixelCells
from reports.document import numbers

if TYPE_CHECKING:
    import xarray

Array = NDArray[np.float64]

DESIGN: Final = "design"  # the dimension of a table
MOST: Final = 9  # figures in one picture
COARSE: Final = 1000  # cells of which only the extremes count
CUT: Final = "Where two numbers follow a name, values reach that far and are cut off, for the others to be told apart."
SIGNED: Final = (".mean", ".max", ".min")  # figures that may be negative, as those at an angle
FAILS: Final = "does not assemble"
OWN: Final = "design of the file"


@dataclass(frozen=True)
class Swept:
    """A dataset with a dimension per parameter, or one, ``design``, over which the parameters are coordinates.

    nan is a design that does not assemble. ``own`` are the numbers of the file by name, in its units.
    """

    dataset: xarray.Dataset
    own: Mapping[str, float]

    @property
    def is_table(self) -> bool:
        """Whether designs stand in a table, not on a grid."""
        return DESIGN in self.dataset.dims

    @property
    def parameters(self) -> tuple[str, ...]:
        """What is varied."""
        if not self.is_table:
            return tuple(map(str, self.dataset.dims))
        return tuple(
            str(name) for name in self.dataset.coords if name != DESIGN and self.dataset[name].dims == (DESIGN,)
        )

    @property
    def figures(self) -> tuple[str, ...]:
        """The figures that are drawn."""
        return tuple(map(str, self.dataset.data_vars))[:MOST]

    @property
    def shape(self) -> tuple[int, ...]:
        """Designs along each dimension."""
        return tuple(self.dataset.sizes.values())

    @property
    def count(self) -> int:
        """How many designs there are."""
        return math.prod(self.shape)

    def places(self, parameter: str) -> Array:
        """The values of a parameter of a grid."""
        return np.asarray(self.dataset[parameter].values, dtype=float)

    def read(self, name: str, first: int, last: int) -> Array:
        """A figure, or a parameter of a table, over a range of the first dimension; a file's values are not kept."""
        first_of_all, *_ = self.dataset.dims
        one = self.dataset[name].isel({first_of_all: slice(first, last)}).transpose(*self.dataset.dims)
        return np.ascontiguousarray(one.values, dtype=float)

    def keep(self, name: str, *cells: PixelCells) -> Kept:
        """A figure, or a parameter of a table, thinned out; without cells only its extremes count."""
        starts = [one.starts for one in cells] or [thinning.evenly(self.shape[0], COARSE)]
        return thinning.keep(partial(self.read, name), self.shape, starts, self.target(name)[0])

    def pick(self, name: str, chosen: Indices) -> Array:
        """A figure, or a parameter, of chosen designs, ascending, by their index in the order of the dimensions."""
        if name in self.dataset.dims:
            return self.places(name)[np.unravel_index(chosen, self.shape)[self.parameters.index(name)]]
        return thinning.picked(partial(self.read, name), self.shape, chosen)

    def unit(self, name: str) -> str:
        """The unit of a parameter or figure, of the file."""
        return printable(str(self.dataset[name].attrs.get("units", "")))

    def label(self, name: str, kept: Kept | None = None) -> str:
        """A name with its unit; of values that are cut off in the picture with both ends of all."""
        low, high = map(numbers.figure, kept.extremes[:2]) if kept is not None and kept.span else ("", "")
        return ", ".join(filter(None, (f"{printable(name)}{f' ({low} to {high})' if low else ''}", self.unit(name))))

    def scale(self, name: str) -> str:
        """What stands beside a scale of a figure that is named above it."""
        return ", ".join(filter(None, ("value", self.unit(name))))

    def target(self, figure: str) -> tuple[float, str]:
        """The best value of a figure, and what is said of the design nearest to it."""
        if figure.startswith("transmission_angle:") and not figure.endswith(".range"):
            return 0.5 * math.pi if self.unit(figure) == "rad" else 90.0, "nearest to 90°"
        return 0.0, "nearest to 0" if figure.endswith(SIGNED) or "@" in figure else "least"

    @property
    def own_place(self) -> tuple[float, ...]:
        """The file's own numbers by parameter if they lie among the designs, else nothing."""
        place = tuple(self.own.get(name, math.nan) for name in self.parameters)
        if np.any(np.isnan(place)):
            return ()
        spans = map(self.ends, self.parameters)
        return place if all(low <= one <= high for one, (low, high) in zip(place, spans, strict=True)) else ()

    def ends(self, parameter: str) -> Array:
        """The least and the largest value of a parameter."""
        if parameter in self.dataset.dims:
            places = self.places(parameter)
            return np.array([np.min(places), np.max(places)])
        return self.keep(parameter).extremes[:2]

    def head(self, kept: Collection[Kept], *notes: str) -> tuple[str, ...]:
        """Lines above the picture: whose designs, under which conditions, what is left out."""
        failing = max(one.failing for one in kept)
        about, left = self.dataset.attrs, len(self.dataset.data_vars) - len(self.figures)
        conditions = str(about.get("conditions", "")).removeprefix(
            f"{about.get('mechanism')} ({about.get('variant')}): "
        )
        who = ", ".join(filter(None, (str(about.get(key, "")) for key in ("mechanism", "variant"))))
        fails = f", {grouped(failing)} of which {'does' if failing == 1 else 'do'} not assemble" if failing else ""
        what = f"{grouped(self.count)} design{'s' * (self.count != 1)}{fails}"
        more = f"The first {MOST} of {left + MOST} figures are drawn." if left else ""
        cut = CUT if any(one.span for one in kept) else ""
        texts = (f"{who}: {what}" if who else what, conditions, *notes, cut, more)
        return tuple(printable(text) for text in texts if text)


def grouped(count: int) -> str:
    """A count with its thousands apart."""
    return f"{count:,}".replace(",", "\u202f")
