"""``optimise``: the best of a linkage's designs at a steady speed."""

from __future__ import annotations

from collections.abc import Callable

from analytic.description.linkage import Linkage
from analytic.errors import LinkproofError
from comparisons.designs.optimum.optimisation import OptimisationRequest, Optimum, optimise
from comparisons.designs.parameters import mass_words
from reports.requests.campaign import named
from reports.requests.options.designs import OptimiseOptions
from reports.requests.steady import steady_case


def request_of(options: OptimiseOptions) -> OptimisationRequest:
    """The request of the options; raises LinkproofError for contradictory options, before any computation."""
    if (options.minimise is None) == (options.maximise is None):
        got = "neither" if options.minimise is None else "both"
        raise LinkproofError(f"expected --minimise FIGURE or --maximise FIGURE, got {got}; give one, such as Mkr.peak")
    request = OptimisationRequest(
        options.minimise or options.maximise or "", options.over, options.keep, options.minimise is not None,
        options.starts, options.seed, options.everywhere, options.step or "",
    )  # fmt: skip
    request.check()
    named(options.simulate)
    return request


def optimum(
    linkage: Linkage, options: OptimiseOptions, announce: Callable[[str, int, int], None] = lambda *_: None
) -> tuple[Optimum, str]:
    """The best design, and the conditions in words."""
    request = request_of(options)
    mechanism, motion, conditions = steady_case(linkage, options)
    best = optimise(mechanism, motion, request, announce)
    return best, conditions + mass_words(mechanism.linkage, best.after)
