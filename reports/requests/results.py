"""``results``: the closed form of one linkage over one motion, for its designer."""

from __future__ import annotations

import math

import numpy as np

from analytic.description.changes import without
from analytic.description.linkage import Linkage
from analytic.errors import LinkproofError
from analytic.kinematics.mechanism import Mechanism
from comparisons.datasheet.designer_results import DesignerResults
from comparisons.datasheet.instants import Instants
from comparisons.datasheet.units import file_unit
from comparisons.reference.case import Case
from reports.requests.case import requested_case
from reports.requests.motions import check_motion
from reports.requests.options.linkage import ResultsOptions


def designer_results(linkage: Linkage, options: ResultsOptions) -> DesignerResults:
    """The results of a linkage under the requested motion and at the requested instants.

    Raises LinkproofError for a motion or an instant that cannot be.
    """
    check_motion(options)
    if options.at is not None and options.time is not None:
        raise LinkproofError("--at and --time both choose the instants of the table: leave one of the two out")
    case = requested_case(Mechanism(linkage if options.gravity else without(linkage, "gravity")), options)
    case.check_motion()
    return DesignerResults(case, _instants(case, options.at, options.time))


def _instants(case: Case, at: tuple[float, ...] | None, time: tuple[float, ...] | None) -> Instants:
    """The whole motion, or the requested instants."""
    linkage = case.mechanism.linkage
    instants = Instants(case.motion, turns=not linkage.is_linear)
    if at is not None:
        length = file_unit("m", linkage)
        unit, size = (f" {length.name}", length.size) if linkage.is_linear else ("°", math.radians(1.0))
        return instants.at_angles(np.array(at), unit, size)
    return instants if time is None else instants.at_times(np.array(time))
