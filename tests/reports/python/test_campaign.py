"""``linkproof.compare``: records as a table and a picture, files of limits and of earlier results, refusals."""

import re

import numpy as np
import pytest
from matplotlib.text import Text

import linkproof
from analytic.description.loading import read
from comparisons.campaign.standard import JudgedCampaign

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


def test_a_check_gives_the_comparison_or_shows_every_row_over_its_limit_of_a_file(tmp_path):
    press, limits = tmp_path / "press.toml", tmp_path / "limits.toml"
    press.write_text(read("juki-mf7923d").text, encoding="utf-8")
    limits.write_text('[[limit]]\nquantities = ["Mkr"]\nvalue = 1e-30\nreason = "none can"\n')
    found = linkproof.compare(press, quantity=("Mkr", "Jeq"), **FAST)
    assert found.check() is found
    found = linkproof.compare(press, quantity=("Mkr", "Jeq"), limits=limits, **FAST)
    assert [record.outcome for record in found.records] == ["over-limit", "passed"]
    with pytest.raises(AssertionError) as failed:
        found.check()
    head, row = str(failed.value).splitlines()
    assert head == "1 of 2 errors and checks failed"
    assert re.fullmatch(
        r"press \(as-built\), run-up, direct tuned, Mkr: over-limit, error \S+ of peak is over its limit 1e-30", row
    )


def test_what_changed_since_results_were_recorded_fails_a_check(tmp_path):
    held = tmp_path / "held.csv"
    linkproof.compare("juki-mf7923d", quantity="Jeq", record=held, **FAST)
    assert linkproof.compare("juki-mf7923d", quantity="Jeq", against=held, **FAST).check().changes == ()
    held.write_text(held.read_text(encoding="utf-8").replace("Jeq.mean,,8.02", "Jeq.mean,,8.03"), encoding="utf-8")
    found = linkproof.compare("juki-mf7923d", quantity="Jeq", against=held, **FAST)
    with pytest.raises(AssertionError, match=r"0 of 1 errors and checks failed\n.*Jeq.mean: was 8.03\d+e-05 kg m²"):
        found.check()


def test_where_nothing_can_be_judged_it_has_neither_passed_nor_failed():
    found = linkproof.Comparison(JudgedCampaign(None, None, ()), None)
    with pytest.raises(linkproof.LinkproofError, match="got no run at all"):
        found.check()


def test_a_linkage_has_to_be_a_name_or_a_path():
    with pytest.raises(linkproof.LinkproofError, match="expected names and paths of linkages, got a int: give its"):
        linkproof.compare(3)
