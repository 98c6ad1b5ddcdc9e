"""A saved campaign is read back whole, without an engine; a damaged document is refused by the key at fault."""

import csv
import shutil

import numpy as np
import pytest

from analytic.description.crank_motion import crank_motion
from analytic.description.loading import load
from analytic.errors import LinkproofError
from analytic.kinematics.mechanism import Mechanism
from comparisons.trials.campaign import campaign
from comparisons.trials.campaign.campaign import CampaignRequest
from comparisons.trials.campaign.results import (
    CURVE_COLUMNS,
    KINDS,
    described_linkage,
    document,
    linkage_row,
    save,
    write_curves,
)
from comparisons.trials.campaign.results import load as load_results
from comparisons.trials.runs.files import STORE
from comparisons.trials.runs.store import has_study
from engines.contract import Outcome, Run
from tests.comparisons.true_motions import perfect_motion

JUKI, MOTION = load("juki-mf7923d", "as-printed"), crank_motion("run-up", clockwise=True, start_angle=0.3)
REQUEST = CampaignRequest((JUKI,), (MOTION,), "as tested", ("direct",))


def _compared(run):
    """The record of this run of an engine."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(campaign, "run_engine", lambda *_: run)
        (result,) = campaign.compare(REQUEST)
    return result


@pytest.fixture(scope="module")
def saved(tmp_path_factory):
    motion = perfect_motion(Mechanism(JUKI), MOTION, 701)
    result = _compared(Run(Outcome.FINISHED, history=motion.history, details={"step": 1e-3}))
    folder = tmp_path_factory.mktemp("saved")
    save(folder, document(REQUEST, "linkproof compare juki-mf7923d"), [result])
    return folder, result


@pytest.fixture
def copy(saved, tmp_path):
    return shutil.copytree(saved[0], tmp_path / "copy")


def test_records_curves_linkages_and_motions_come_back_to_the_last_bit(saved):
    folder, result = saved
    results = load_results(folder)
    assert results.runs == (result,)
    assert (results.records, results.invariants) == (result.errors, result.invariants)
    assert len(result.curves) > 8
    for name, curve in result.curves.items():
        np.testing.assert_array_equal(results.curve(result.run, name), curve)
    assert (results.linkages, results.motions) == ((JUKI,), (MOTION,))
    assert results.document["environment"]["numpy"] == np.__version__
    assert [path.name for path in folder.iterdir()] == [STORE]


def test_curves_are_a_table_with_a_row_a_sample_and_every_digit(saved, tmp_path):
    (run,) = load_results(saved[0]).runs
    write_curves([run], tmp_path / "curves.csv")
    with (tmp_path / "curves.csv").open(encoding="utf-8", newline="") as opened:
        head, *rows = csv.reader(opened)
    assert tuple(head) == CURVE_COLUMNS
    assert len(rows) == sum(curve.shape[1] for curve in run.curves.values())
    mine = [row for row in rows if row[5] == "Mkr"]
    assert {tuple(row[:7]) for row in mine} == {(*run.run, "Mkr", "N m")}
    columns = np.array([[float(value) for value in row[7:]] for row in mine]).T
    time, angle, reference, error = run.curves["Mkr"].astype(float)
    np.testing.assert_array_equal(columns, [time, angle, reference + error, reference])


def test_a_judgement_takes_the_place_of_a_campaign(saved, copy):
    save(copy, {**load_results(copy).document, "judgement": ["right"]}, [saved[1]])
    assert [has_study(copy, kind) for kind in KINDS] == [False, True]
    assert load_results(copy).document["judgement"] == ["right"]


@pytest.mark.parametrize(
    ("damage", "match"),
    [
        ({"limits": [{"value": 1.0}]}, r"limits\.0"),
        ({"figures": [{}]}, r"figures\.0"),
        ({"motions": [{"regime": "r", "segments": []}]}, r"motions\.0\.segments"),
        ({"descriptions": "x"}, "descriptions"),
    ],
)
def test_a_document_of_another_form_is_refused_by_its_key(saved, tmp_path, damage, match):
    folder, result = saved
    save(tmp_path, {**load_results(folder).document, **damage}, [result])
    with pytest.raises(LinkproofError, match=rf"{match}.*run compare with --out again"):
        load_results(tmp_path)


def test_a_campaign_of_failures_can_be_saved(tmp_path):
    failed = _compared(Run(Outcome.DIVERGED, "ran away"))
    save(tmp_path, document(REQUEST, "linkproof compare"), [failed])
    assert load_results(tmp_path).records == failed.errors


def test_a_saved_text_with_a_byte_order_mark_is_read_again():
    linkage = load("juki-mf7923d")
    assert described_linkage({**linkage_row(linkage), "text": "\ufeff" + linkage.text}) == linkage
