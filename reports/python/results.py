"""``linkproof.results``: every signal of a linkage over one motion of its crank."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Unpack

import xarray

from analytic.description.linkage import Linkage
from comparisons.datasheet.building import sheet
from reports.command_line.commands.results import ResultsChoice, designer_case
from reports.python.labels import labelled
from reports.python.options import MotionOptions, choice, chosen_linkage


def results(
    linkage: Linkage | str | Path,
    *,
    at: Sequence[float] | None = None,
    time: Sequence[float] | None = None,
    **options: Unpack[MotionOptions],
) -> xarray.Dataset:
    """Every signal of a linkage over one motion of its crank, as ``linkproof results`` has them, in SI.

    The dimension is ``phi``, rad, where the crank turns at one speed, else ``time``, s; the other stands beside it.
    Points, links, joints and groups are dimensions of their own, as are the components x and y of a vector. ``at``, in
    degrees, or ``time``, in s, choose the instants. Raises LinkproofError for what cannot be.
    """
    chosen = [None if given is None else ",".join(repr(float(one)) for one in given) for given in (at, time)]
    asked = ResultsChoice(mechanism=str(linkage), at=chosen[0], time=chosen[1], **choice(options))
    asked.check()
    case, instants = designer_case(chosen_linkage(linkage, asked.variant), asked)
    found = sheet(case, instants)
    about = {"regime": case.motion.regime, "conditions": found.conditions}
    return labelled(found.linkage, found.axis, found.table, about)
