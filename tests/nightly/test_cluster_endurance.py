"""Workers and a scheduler killed in a campaign cost no record, and double none."""

import importlib.util
import sys

import pytest

from comparisons.runs import cluster as connecting
from tests.comparisons.faults import PATIENCE
from tests.nightly import cluster_endurance

pytestmark = [
    pytest.mark.skipif(importlib.util.find_spec("distributed") is None, reason="needs distributed"),
    pytest.mark.skipif(not sys.platform.startswith("linux"), reason="reads /proc"),
]


@pytest.mark.nightly
def test_killed_workers_and_a_killed_scheduler_cost_and_double_no_record(monkeypatch):
    monkeypatch.setattr(connecting, "PATIENCE", PATIENCE)
    monkeypatch.setattr(cluster_endurance, "catalogue", lambda: ("juki-mf7923d", "rimoldi-164"))
    found = cluster_endurance.measure(3, 1, regimes=1)
    assert (found.workers, found.schedulers, found.lost, found.doubled) == (3, 1, 0, 0)
