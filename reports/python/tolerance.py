"""``linkproof.tolerance``: the change of each result with each toleranced number of a linkage."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import xarray

from analytic.description.linkage import Linkage
from comparisons.designs.tolerance.tolerance_study import SHARES, ToleranceStudy, tolerance_study
from comparisons.designs.tolerance.tolerances import Tolerances, read_tolerances
from reports.python.keywords import Words, of_linkage, with_keywords, words
from reports.requests.designs import tolerance_request_of
from reports.requests.options.designs import ToleranceOptions


@with_keywords()
def tolerance(
    linkage: Linkage | str | Path,
    tolerances: Mapping[str, Any] | str | Path,
    results: Words | None = None,
    *,
    options: ToleranceOptions,
) -> xarray.Dataset:
    """The effect of tolerances on a linkage's results, over ``result`` and ``parameter``; in the file's units.

    ``tolerances`` are ± by name, as under [tolerances] in a file of ``linkproof tolerance``, or such a file, which also
    supplies ``results`` and ``speed`` if they are not given: rpm, or the file's unit of length per second. With
    ``scale_mass`` masses change with lengths.

    ``contribution`` (±), ``share`` (of the variance), ``worst`` (±, all together) and ``linear_deviation`` follow from
    ``derivative``, whose attribute ``derivatives`` is exact or difference. ``change`` (over ``limit``) is computed
    with one number at its limit, ``corner`` (``end``) with all; ``mean``, ``deviation`` and ``quantile`` are of random
    designs. Derivatives are NaN where two local maxima are equal, and so are values of designs that do not
    assemble. Raises LinkproofError for bad input.
    """
    given = Tolerances((), None, tolerances) if isinstance(tolerances, Mapping) else read_tolerances(Path(tolerances))
    given = replace(given, results=given.results if results is None else words(results))
    if options.speed is not None:
        given = replace(given, speed=options.speed)
    chosen, options = of_linkage(linkage, options)
    return dataset(tolerance_study(tolerance_request_of(chosen, given, options)))


def dataset(study: ToleranceStudy) -> xarray.Dataset:
    """A study as labelled arrays in the units of the linkage's file."""
    request = study.request
    size = np.array([figure.unit.size for figure in request.figures])
    parameter_size = np.array([tolerance.parameter.unit.size for tolerance in request.tolerances])
    of, by = ("result",), ("result", "parameter")
    return xarray.Dataset(
        {
            "nominal": (of, study.nominal / size),
            "derivative": (by, study.derivatives * parameter_size / size[:, None]),
            "contribution": (by, study.contributions / size[:, None]),
            "share": (by, study.shares),
            "change": ((*by, "limit"), study.changes / size[:, None, None]),
            "worst": (of, study.worst / size),
            "corner": ((*of, "end"), study.corners / size[:, None]),
            "linear_deviation": (of, study.deviations / size),
            "mean": (of, study.mean / size),
            "deviation": (of, study.deviation / size),
            "quantile": ((*of, "level"), study.quantiles / size[:, None]),
        },
        coords={
            "result": [figure.name for figure in request.figures],
            "units": (of, [figure.unit.name for figure in request.figures]),
            "parameter": [tolerance.name for tolerance in request.tolerances],
            "parameter_units": (("parameter",), [tolerance.parameter.unit.name for tolerance in request.tolerances]),
            "plus_minus": (("parameter",), [tolerance.plus_minus for tolerance in request.tolerances] / parameter_size),
            "distribution": (("parameter",), [str(tolerance.distribution) for tolerance in request.tolerances]),
            "limit": ["lower", "upper"],
            "end": ["least", "largest"],
            "level": [*SHARES],
        },
        attrs={
            "mechanism": request.mechanism.linkage.name,
            "variant": request.mechanism.linkage.variant,
            "conditions": request.conditions,
            "derivatives": study.how,
            "corners": "all" if study.has_all_corners else "those to which derivatives point",
            "samples": request.samples,
            "seed": request.seed,
            "assembled": study.assembled,
        },
    )
