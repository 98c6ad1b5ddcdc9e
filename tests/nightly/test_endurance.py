"""A campaign killed at random moments and resumed has the records of one that nobody disturbed, each once."""

import multiprocessing
import random
import sys
import time
from dataclasses import asdict

import pytest

from analytic.description.crank_motion import REGIMES, crank_motion
from analytic.description.loading import catalogue, load
from comparisons.campaign.campaign import CampaignRequest, compare
from comparisons.campaign.results import document, save
from comparisons.campaign.results import load as load_results
from comparisons.runs.files import STORE
from comparisons.runs.store import begin
from comparisons.runs.workers import LocalPool
from engines.contract import Setting
from tests.commands import stored_runs
from tests.comparisons.faults import wait_for

COMMAND = "linkproof compare --regime all --engine direct"
RUNS = len(catalogue()) * len(REGIMES)
KILLS, PAUSE = 8, 0.06  # and the mean time from a saved run to the kill, s: in the runs after it or in the writing
UNSTEADY = ("seconds", "setup_seconds")  # fields of a record that differ from run to run


def run_campaign(folder, processes=2):
    """Short, slow motions and two quantities, resumed from what is stored; its workers are forked, which is fast."""
    motions = tuple(crank_motion(name, speed=10.0, ramp_time=0.03, hold_time=0.01) for name in REGIMES)
    wanted = CampaignRequest(
        tuple(load(name) for name in catalogue()), motions, "brief", ("direct",), (Setting.TUNED,), ("Jeq", "Mkr"),
        with_invariants=False,
    )  # fmt: skip
    runs, _ = begin(folder, COMMAND, COMMAND)
    results = list(compare(wanted, pool=LocalPool(processes), finished=runs))
    save(folder, document(wanted, COMMAND), results)
    runs.clear()


def contents(folder):
    """Every record without its unsteady fields and every curve, in order."""
    found = []
    for run in load_results(folder).runs:
        rows = [{name: value for name, value in asdict(one).items() if name not in UNSTEADY} for one in run.every]
        found += [("/".join(run.run), repr(rows), {name: curve.tobytes() for name, curve in run.curves.items()})]
    return found


@pytest.mark.nightly
@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="forks")
def test_kills_at_random_moments_lose_and_double_nothing(tmp_path, monkeypatch):
    monkeypatch.setenv("LINKPROOF_WORKER_START", "fork")
    run_campaign(tmp_path / "undisturbed", 0)
    chance, kills, campaigns = random.Random(7), 0, 0
    while kills < KILLS:
        folder = tmp_path / str(campaigns)
        running = multiprocessing.get_context("fork").Process(target=run_campaign, args=(folder,))
        running.start()
        runs = chance.randint(stored_runs(folder), RUNS)
        wait_for(lambda: stored_runs(folder) >= runs or running.exitcode is not None)  # noqa: B023
        time.sleep(chance.expovariate(1.0 / PAUSE))
        running.kill()
        running.join()
        kills += running.exitcode != 0
        if running.exitcode == 0:
            assert contents(folder) == contents(tmp_path / "undisturbed")
            assert {path.name for path in folder.iterdir()} == {STORE}
            campaigns += 1
    run_campaign(tmp_path / str(campaigns))
    assert contents(tmp_path / str(campaigns)) == contents(tmp_path / "undisturbed")
