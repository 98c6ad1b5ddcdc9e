"""``tolerance``: the tolerances of a linkage's numbers under the requested motion."""

from __future__ import annotations

from dataclasses import replace

from analytic.description.linkage import Linkage
from comparisons.designs.tolerance.tolerance_request import ToleranceRequest, tolerance_request
from comparisons.designs.tolerance.tolerances import Tolerances
from reports.requests.options.designs import ToleranceOptions
from reports.requests.steady import steady_case


def tolerance_request_of(linkage: Linkage, tolerances: Tolerances, options: ToleranceOptions) -> ToleranceRequest:
    """The request, at the speed of the file of tolerances if it has one; raises LinkproofError for what cannot be."""
    if tolerances.speed is not None:
        options = replace(options, speed=tolerances.speed)
    mechanism, motion, conditions = steady_case(linkage, options)
    return tolerance_request(
        mechanism, motion, tolerances, samples=options.samples, seed=options.seed, conditions=conditions
    )
