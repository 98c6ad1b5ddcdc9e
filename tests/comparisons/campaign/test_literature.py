"""The linkages of the literature in the suite's second derivation, in their own regimes or a quintic run-up."""

import numpy as np
import pytest

from analytic.description.loading import literature, load
from comparisons.campaign.campaign import compare
from comparisons.judging.records import Verdict
from reports.command_line.requests import CampaignChoice, request

# Of peak; the energy balance is left out, an integral over samples.
SECOND_DERIVATION = 1e-12
VARIANTS = [(name, variant) for name in literature() for variant in load(name).variants]


@pytest.mark.parametrize(("name", "variant"), VARIANTS)
def test_the_second_derivation_agrees_to_rounding(name, variant):
    regimes = ("own",) if load(name).regimes else ("run-up-quintic",)
    choice = CampaignChoice((name,), engines=("direct",), regimes=regimes, variant=variant, speed=100.0)
    for result in compare(request(choice), processes=0):
        records = [*result.records, *result.invariants]
        assert {record.outcome for record in records} == {Verdict.PASSED}
        held = [record.error_max for record in records if record.quantity != "energy_balance"]
        assert np.max(held) <= SECOND_DERIVATION
