"""Studies behind promised figures: what they make of their findings."""

from comparisons.stress.campaign import Stressed
from comparisons.stress.long_run import LongRun
from comparisons.stress.verdict import StressVerdict
from tests.comparisons.stress.test_border import result
from tests.targets import promises


def test_a_long_run_tells_its_ratio_and_what_it_is_made_of(monkeypatch):
    runs = [LongRun("m", "e", "tuned", 10, "finished", "", 1e-8, 3e-8, 1e-6, 2e-6, 0.5, 100)]
    monkeypatch.setattr(
        promises, "long_runs", lambda *_: iter([*runs, LongRun("m", "f", "tuned", 10, "crashed", "died")])
    )
    good, failed = promises.long_turns({"mechanisms": ["m"], "setting": "tuned", "turns": 10}, ["e", "f"])
    assert (good.subject, round(good.reached, 9)) == ("e, m", 3.0)
    assert "gap 1.0e-08, then 3.0e-08" in good.detail
    assert (failed.reached, failed.detail) == (float("inf"), "crashed: died")


def test_missed_cells_are_counted(monkeypatch):
    cells = (result(1.0, StressVerdict.WITHIN), result(2.0, StressVerdict.CAUGHT))
    monkeypatch.setattr(promises, "stress", lambda _request: Stressed(cells, ()))
    (found,) = promises.missed({"quick": True}, ["e"])
    assert (found.reached, found.detail) == (0.0, "of 2 cells")


def test_lost_and_doubled_records_add_up(monkeypatch):
    monkeypatch.setattr(promises, "killed_and_resumed", lambda kills: (kills, 2))
    (found,) = promises.endurance({"kills": 3}, [])
    assert (found.reached, found.detail) == (5.0, "3 lost, 2 doubled")
