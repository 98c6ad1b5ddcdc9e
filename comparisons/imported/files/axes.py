"""The axis of a curve: times that grow, or crank angles that run one way; and curves long enough to be judged."""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray

from analytic.errors import LinkproofError, shortened
from comparisons.imported.columns import Axis, Column

FEWEST: Final = 4  # instants of a curve


def instants(column: Column, name: Axis) -> tuple[NDArray[np.intp], str]:
    """The rows of an axis that are instants of their own, the last of equal ones, and a word on those left out.

    Tools write an instant twice where an event changes the motion. Raises LinkproofError for an axis that turns back.
    """
    steps = np.diff(column.values)
    forward = -1.0 if name == "phi" and len(steps) and column.values[-1] < column.values[0] else 1.0
    back = np.flatnonzero(forward * steps < 0.0)
    if len(back):
        row = int(back[0])
        before, after = column.values[row], column.values[row + 1]
        cure = "export one run a file, its rows in order" if name == "time" else "export the time beside it"
        wanted = "a time that grows" if name == "time" else "a crank angle that runs one way"
        raise LinkproofError(
            f"{column.place}: expected {wanted} in '{shortened(column.header)}', got {after:g} after {before:g} "
            f"(row {row + 2} of the table); {cure}"
        )
    kept = np.flatnonzero(np.append(steps != 0.0, True))
    if len(kept) < FEWEST:
        raise LinkproofError(
            f"{column.place}: expected a curve of at least {FEWEST} instants, got {len(kept)}; export more "
            "steps of the run"
        )
    left_out = len(column.values) - len(kept)
    return kept, f"of instants written more than once the last is taken ({left_out} left out)" if left_out else ""


def check_curve(column: Column, axis: Column) -> None:
    """Refuse a column that goes on where its axis has ended, or that ends at once."""
    if len(column.values) > len(axis.values):
        raise LinkproofError(
            f"{column.place}: expected no more than the {len(axis.values)} numbers of '{shortened(axis.header)}', got "
            f"{len(column.values)} of '{shortened(column.header)}'; export them with one axis"
        )
    if len(column.values) < FEWEST:
        raise LinkproofError(
            f"{column.place}: expected at least {FEWEST} numbers of '{shortened(column.header)}', got "
            f"{len(column.values)}; export more steps of the run"
        )
