"""``linkproof.compare``: records as a table and a picture, files of limits and baselines, refusals."""

import numpy as np
import pytest
from matplotlib.text import Text

import linkproof
from analytic.description.loading import read
from comparisons.campaign.project import JudgedCampaign

FAST = {"engine": "direct", "jobs": 0}


def test_records_are_a_table_and_a_picture_by_run_and_quantity():
    found = linkproof.compare("juki-mf7923d", setting=["naive", "tuned"], **FAST)
    assert found.passed
    assert found.command == "linkproof compare juki-mf7923d --engine direct --setting naive --setting tuned"
    drawn = {text.get_text() for text in found.plot(regime="run-up").findobj(Text)}
    assert {"largest |error| / peak", "Mkr"} <= drawn
    with pytest.raises(linkproof.LinkproofError, match="unknown regime 'runup': did you mean 'run-up'"):
        found.plot(regime="runup")
    table = found.table
    assert table["setting"].values.tolist() == ["naive", "tuned"]
    for record in found.records:
        row = table.isel(run=["naive", "tuned"].index(record.setting)).sel(quantity=record.quantity)
        assert np.array_equal(row["error_max"], np.float64(record.error_max), equal_nan=True)
        assert (row["outcome"].item(), row["steps"].item()) == (record.outcome, record.steps)


def test_a_file_of_limits_and_the_project_of_the_first_file_are_used(tmp_path):
    press, limits = tmp_path / "press.toml", tmp_path / "limits.toml"
    press.write_text(read("juki-mf7923d").text, encoding="utf-8")
    limits.write_text('[[limit]]\nquantities = ["Mkr"]\nvalue = 1e-30\nreason = "none can"\n')
    found = linkproof.compare(press, quantity=("Mkr", "Jeq"), limits=limits, **FAST)
    assert [record.outcome for record in found.records] == ["over-limit", "passed"]
    assert not found.passed
    (tmp_path / "linkproof.toml").write_text('engines = ["direct"]\nsettings = ["best"]\n')
    (record,) = linkproof.compare(press, quantity="S", jobs=0).records
    assert (record.engine, record.setting) == ("direct", "best")


def test_where_nothing_can_be_judged_it_has_neither_passed_nor_failed():
    found = linkproof.Comparison(JudgedCampaign(None, (), (), ()), None)
    with pytest.raises(linkproof.LinkproofError, match="got no run at all"):
        _ = found.passed


@pytest.mark.parametrize(
    ("linkage", "options", "words"),
    [
        ("juki-mf7923d", {"engine": "diretc"}, "unknown engine 'diretc': did you mean 'direct'"),
        (3, {}, r"expected names and paths of linkages, got a int: give its"),
    ],
)
def test_bad_input_is_refused_in_a_sentence(linkage, options, words):
    with pytest.raises(linkproof.LinkproofError, match=words):
        linkproof.compare(linkage, **options)
