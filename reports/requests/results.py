"""``results``: the closed form of one linkage over one motion, for its designer."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from analytic.description.changes import without
from analytic.description.file_units import file_unit
from analytic.description.linkage import Linkage
from analytic.errors import LinkproofError
from analytic.kinematics.mechanism import Mechanism
from comparisons.datasheet.instants import Instants
from comparisons.reference.case import Case
from reports.requests.case import requested_case
from reports.requests.motions import check_motion
from reports.requests.options.linkage import ResultsOptions


class RequestedResults(NamedTuple):
    """A linkage under a motion, and the instants (n,), s, of its tables; None for the whole motion."""

    case: Case
    chosen: NDArray[np.float64] | None


def requested_results(linkage: Linkage, options: ResultsOptions) -> RequestedResults:
    """The motion and the instants of a request; raises LinkproofError for those that cannot be."""
    check_motion(options)
    if options.at is not None and options.time is not None:
        raise LinkproofError("--at and --time both choose the instants of the table: leave one of the two out")
    case = requested_case(Mechanism(linkage if options.gravity else without(linkage, "gravity")), options)
    linkage, instants = case.mechanism.linkage, Instants(case.motion, turns=not case.mechanism.linkage.is_linear)
    if options.at is not None:
        length = file_unit("m", linkage)
        unit, size = (f" {length.name}", length.size) if linkage.is_linear else ("°", math.radians(1.0))
        return RequestedResults(case, instants.at_angles(np.array(options.at), unit, size))
    return RequestedResults(case, None if options.time is None else instants.at_times(np.array(options.time)))
