"""The linkages of the literature in the suite's second derivation, in their own regimes or a quintic run-up."""

import numpy as np
import pytest

from analytic.description.loading import literature, load
from comparisons.campaign.campaign import compare
from comparisons.judging.records import Verdict
from comparisons.runs.workers import LocalPool
from reports.requests.campaign import request
from reports.requests.options.campaign import CompareOptions
from tests.analytic.linkages import FOLDER

# Of peak; the energy balance is left out, an integral over samples.
SECOND_DERIVATION = 1e-12
# `direct` ends at change points, and forty windows take it half a minute: ten between two of them.
THROUGH_CHANGE_POINTS = {"n-four-bar": str(FOLDER / "change-points" / "ten-four-bars.toml")}
VARIANTS = [(name, variant) for name in literature() for variant in load(name).variants]


def _choice(name: str, variant: str) -> CompareOptions:
    if name in THROUGH_CHANGE_POINTS:  # between two of them
        ten = (THROUGH_CHANGE_POINTS[name],)
        return CompareOptions(
            mechanisms=ten, engine=("direct",), regime=("cycloidal",), from_angle=90.0, to_angle=30.0, speed=30.0
        )
    regimes = ("own",) if load(name).regimes else ("run-up-quintic",)
    return CompareOptions(mechanisms=(name,), engine=("direct",), regime=regimes, variant=variant, speed=100.0)


@pytest.mark.parametrize(("name", "variant"), VARIANTS)
def test_the_second_derivation_agrees_to_rounding(name, variant):
    for result in compare(request(_choice(name, variant)), pool=LocalPool(0)):
        records = [*result.records, *result.invariants]
        assert {record.outcome for record in records} == {Verdict.PASSED}
        held = [record.error_max for record in records if record.quantity != "energy_balance"]
        assert np.max(held) <= SECOND_DERIVATION
