"""A campaign in worker processes: the same results in order, resumed from its journal; faulty engines; sheets."""

import dataclasses
import sys

import pytest

from analytic.description.crank_motion import RPM, crank_motion
from analytic.description.linkage import ReleasedRegime
from analytic.description.loading import load
from comparisons.campaign import campaign as module
from comparisons.campaign.campaign import CampaignRequest, compare, sheets, tasks
from comparisons.datasheet.building import usual_sheet
from comparisons.runs import workers
from comparisons.runs.run_engine import GIB
from comparisons.runs.study import Journal
from comparisons.runs.workers import Bounds, LocalPool
from engines.contract import Setting
from tests.comparisons.faults import PATIENCE, Clock, announce_engines, fail

JUKI = load("juki-mf7923d")
SWING = ReleasedRegime("swing", torque=0.0, start_angle=1.5, start_speed=1.0, duration=0.01)
RAISED = (
    "the adapter of raising raised ValueError: first line second line (tests/comparisons/faults.py, line "
    f"{fail.__code__.co_firstlineno + 1})"
)


BRIEF = tuple(crank_motion(name, ramp_time=0.05, hold_time=0.02) for name in ("run-up", "run-up-cubic"))


def _brief(**changes):
    """A request of real runs: two motions and two settings of the direct engine, and a released crank."""
    settings = (Setting.NAIVE, Setting.TUNED)
    linkage = dataclasses.replace(JUKI, regimes=(SWING,))
    request = CampaignRequest((linkage,), BRIEF, "brief", ("direct",), settings, own_regimes=("swing",))
    return dataclasses.replace(request, **changes)


def _untimed(result):
    """All of a result but its timings; arrays as bytes, so that == means every bit."""
    curves = {name: curve.tobytes() for name, curve in result.curves.items()}
    return dataclasses.replace(result, seconds=0.0, setup_seconds=0.0), curves


@pytest.fixture(scope="module")
def made_here():
    """The results of the brief request, made in this process."""
    return [_untimed(result) for result in compare(_brief(), pool=LocalPool(0))]


def test_runs_in_workers_are_the_same_in_the_same_order_and_announced(made_here):
    heard = []
    results = compare(_brief(), lambda *words: heard.append(words), pool=LocalPool(2))
    assert [_untimed(result) for result in results] == made_here
    runs = [(motion.regime, setting) for motion in BRIEF for setting in ("naive", "tuned")] + [("swing", "tuned")]
    labels = [f"juki-mf7923d, {regime}: direct {setting}" for regime, setting in runs]
    assert {label for label, *_ in heard} == set(labels)
    assert sorted({finished for _, finished, _ in heard}) == list(range(len(labels) + 1))
    assert {total for *_, total in heard} == {len(labels)} == {len(made_here)}


def test_an_interrupted_campaign_goes_on_from_its_journal(tmp_path, made_here):
    journal = Journal(tmp_path, "as tested")
    begun = iter(compare(_brief(), pool=LocalPool(0), journal=journal))
    next(begun)
    begun.close()
    done = len(journal.records.keys)
    assert 1 <= done < len(made_here)
    heard = []
    results = compare(_brief(), lambda *words: heard.append(words), pool=LocalPool(0), journal=journal)
    assert [_untimed(result) for result in results] == made_here
    assert min(finished for _, finished, _ in heard) == done
    assert set(journal.records.keys) == {task.key for task in tasks(_brief())}


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="bounds on memory are Linux's")
def test_faulty_engines_cost_their_own_rows(tmp_path, monkeypatch, capfd):
    announce_engines(tmp_path)
    monkeypatch.syspath_prepend(tmp_path)
    faulty = ("aborting", "hanging", "leaving", "raising", "swelling", "writing")
    motions, settings = BRIEF[:1], (Setting.TUNED,)
    request = CampaignRequest((JUKI,), motions, "brief", ("direct", *faulty), settings)
    clock = Clock()
    monkeypatch.setattr(workers, "time", clock)
    monkeypatch.setattr(workers, "_EXIT_TIMEOUT", PATIENCE)

    def begun(label, *_):
        if "hanging" in label and not clock.ahead:
            clock.put_forward()

    results = list(compare(request, begun, bounds=Bounds(memory=GIB // 4), pool=LocalPool(1)))
    found = {result.records[0].engine: {(r.outcome, r.detail) for r in result.records} for result in results}
    assert list(found) == list(request.engines)
    assert found == {
        "direct": {("passed", "")},
        "aborting": {("crashed", "died by signal 6 (SIGABRT)")},
        "hanging": {("timed-out", "took longer than 600 s")},
        "leaving": {("crashed", "exited with code 3")},
        "raising": {("adapter-error", RAISED)},
        "swelling": {("crashed", "needed more than 0.25 GiB of memory")},
        "writing": {("diverged", "did nothing")},
    }
    assert {record.engine_version for result in results[1:] for record in result.records} == {"1.0"}
    assert len({len(result.records) for result in results}) == 1
    assert capfd.readouterr() == ("", "")


NAMES = ("slotted-takeup", "juki-mf7923d")
LINKAGES = tuple(load(name) for name in NAMES)
SHEETS = LINKAGES, (crank_motion("run-up", speed=500 * RPM),), ("free",)


def test_every_linkage_has_a_sheet_of_the_campaigns_motions():
    found = sheets(*SHEETS, 2)
    assert [sheet.name for sheet in found] == list(NAMES)
    assert all("500 rpm" in sheet.conditions for sheet in found)
    assert [list(sheet.released) for sheet in found] == [["free"], []]


def test_a_sheet_that_fails_costs_no_other(monkeypatch):
    def broken(linkage, *rest):
        if linkage.name == "juki-mf7923d":
            raise ZeroDivisionError("a fault of the suite")
        return usual_sheet(linkage, *rest)

    monkeypatch.setattr(module, "usual_sheet", broken)
    whole, lost = sheets(*SHEETS, 0)
    assert "a fault of the suite" in lost.missing["values"]
    assert (lost.name, lost.linkage) == ("juki-mf7923d", LINKAGES[1])
    assert whole.values
