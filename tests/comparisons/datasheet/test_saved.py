"""A designer's cases come back from their folder as they were, the one that was saved last at the end."""

from dataclasses import replace

import pytest

from analytic.description.crank_motion import crank_motion
from analytic.description.loading import load
from analytic.errors import LinkproofError
from analytic.kinematics.mechanism import Mechanism
from comparisons.case import Case, case_of_file_regime
from comparisons.datasheet.saved import load_cases, save_case


def test_cases_come_back_and_a_later_one_of_a_linkage_replaces_the_first(tmp_path):
    juki = replace(load("juki-mf7923d", "as-printed"), gravity=(0.0, 0.0))
    takeup = load("slotted-takeup")
    released = replace(case_of_file_regime(Mechanism(takeup), takeup.released["free"]), mechanism=Mechanism(takeup))
    swing = Case(Mechanism(juki), crank_motion("run-up", clockwise=True, start_angle=0.3), conditions="as asked")
    assert load_cases(tmp_path) == []
    for case in (Case(Mechanism(juki), crank_motion("constant-speed")), released, swing):
        save_case(tmp_path, case)
    free, run_up = load_cases(tmp_path)
    assert (run_up.mechanism.linkage, run_up.motion, run_up.conditions) == (juki, swing.motion, "as asked")
    assert (free.mechanism.linkage, free.conditions) == (takeup, released.conditions)
    assert free.motion.angle(0.1) == pytest.approx(released.motion.angle(0.1), rel=1e-12)


def test_a_damaged_file_is_refused_with_the_cure(tmp_path):
    save_case(tmp_path, Case(Mechanism(load("juki-mf7923d")), crank_motion("run-up")))
    records = tmp_path / "results" / "records.jsonl"
    records.write_text(records.read_text().replace("run-up", "run up"))
    with pytest.raises(LinkproofError, match="run results with --out again"):
        load_cases(tmp_path)
