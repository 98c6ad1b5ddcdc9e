"""``linkproof.compare``: the command's words, records as a table, limits and baselines of one's own."""

import numpy as np
import pytest
from matplotlib.text import Text

import linkproof
from analytic.description.loading import read
from comparisons.campaign.standards import JudgedCampaign

FAST = {"engine": "direct", "jobs": 0}


@pytest.fixture
def press(tmp_path):
    """A linkage file of one's own."""
    path = tmp_path / "press.toml"
    path.write_text(read("juki-mf7923d").text, encoding="utf-8")
    return path


def test_records_are_a_table_by_run_and_quantity():
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


def test_limits_of_ones_own_decide(press):
    limits = press.parent / "limits.toml"
    limits.write_text('[[limit]]\nquantities = ["Mkr"]\nvalue = 1e-30\nreason = "none can"\n')
    found = linkproof.compare(press, quantity=("Mkr", "Jeq"), limits=limits, **FAST)
    assert [record.outcome for record in found.records] == ["over-limit", "passed"]
    assert not found.passed


def test_a_mass_changed_by_a_hundredth_is_seen_in_a_figure(press):
    baseline = press.parent / "baseline.json"
    assert linkproof.compare(press, baseline=baseline, record_baseline=True, **FAST).passed
    text = press.read_text(encoding="utf-8")
    assert "mass   = 0.076" in text
    press.write_text(text.replace("mass   = 0.076", "mass   = 0.07676"), encoding="utf-8")
    found = linkproof.compare(press, baseline=baseline, **FAST)
    assert "Mkr.peak" in [figure.figure for figure in found.figures if figure.changed]
    assert "press.toml has changed" in found.notes[0]
    assert not found.passed


def test_the_project_says_what_the_words_leave_open(press):
    (press.parent / "linkproof.toml").write_text('engines = ["direct"]\nsettings = ["best"]\n')
    found = linkproof.compare(press, quantity="S", jobs=0)
    assert [(record.engine, record.setting, record.quantity) for record in found.records] == [("direct", "best", "S")]


def test_where_nothing_can_be_judged_it_has_neither_passed_nor_failed():
    found = linkproof.Comparison(JudgedCampaign(None, (), (), ()), None)
    with pytest.raises(linkproof.LinkproofError, match="got no run at all"):
        _ = found.passed


def test_bad_words_are_refused():
    with pytest.raises(linkproof.LinkproofError, match="unknown engine 'diretc': did you mean 'direct'"):
        linkproof.compare("juki-mf7923d", engine="diretc")
    with pytest.raises(linkproof.LinkproofError, match="--time-limit: expected a positive"):
        linkproof.compare("juki-mf7923d", engine="direct", time_limit=-1)


def test_a_linkage_in_place_of_its_file_is_refused_in_a_sentence():
    with pytest.raises(
        linkproof.LinkproofError, match=r"expected names and paths of linkages, got a Linkage: give its"
    ):
        linkproof.compare(linkproof.load("juki-mf7923d"), **FAST)
