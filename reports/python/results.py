"""``linkproof.results``: every signal of a linkage over a motion of its crank."""

from __future__ import annotations

from pathlib import Path

import xarray

from analytic.description.linkage import Linkage
from comparisons.datasheet.building import sheet
from reports.python.keywords import of_linkage, with_keywords
from reports.python.labels import labelled
from reports.requests.case import requested_results
from reports.requests.options.linkage import ResultsOptions


@with_keywords()
def results(linkage: Linkage | str | Path, *, options: ResultsOptions) -> xarray.Dataset:
    """Every signal of a linkage over a motion of its crank, as by ``linkproof results``, in SI.

    The dimension is ``phi``, rad, where the crank turns at one speed, else ``time``, s; the other stands beside it.
    Points, links, joints and groups are dimensions of their own, as are the components x and y of a vector. ``at``, in
    degrees, or ``time``, in s, choose the instants. Raises LinkproofError for what cannot be.
    """
    case, chosen = requested_results(*of_linkage(linkage, options))
    result = sheet(case, chosen)
    about = {"regime": case.motion.regime, "conditions": result.conditions}
    return labelled(result.linkage, result.axis, result.table, about)
