"""The standard of a campaign: files of limits with precedence over the suite's, and a baseline."""

import json
from dataclasses import replace

import pytest

from analytic.description.crank_motion import crank_motion
from analytic.description.loading import read
from analytic.errors import LinkproofError
from comparisons.campaign.campaign import CampaignRequest, cases
from comparisons.campaign.standard import judged_campaign, places, standard
from comparisons.judging.baseline import departures, read_baseline
from comparisons.judging.limits import shipped_limits
from comparisons.judging.records import blank_record, run_record

MOTION = crank_motion("run-up")
ROW = '[[limit]]\nquantities = ["Mkr"]\nvalue = {}\n'


@pytest.fixture
def folder(tmp_path):
    """Two linkages of one name."""
    text = read("juki-mf7923d").text
    for name in ("a", "b"):
        (tmp_path / name).mkdir()
        (tmp_path / name / "press.toml").write_text(text, encoding="utf-8")
    (tmp_path / "limits.toml").write_text(ROW.format(0.25))
    return tmp_path


def _files(folder):
    return [replace(read(str(folder / name / "press.toml")), name=f"{name}-press") for name in ("a", "b")]


def test_limits_of_a_file_go_before_the_suites(folder):
    assert standard([]).limits == shipped_limits()
    assert standard([], folder / "limits.toml").limits.limit("Mkr", "tuned", "run-up").value == 0.25


def test_places_are_paths_from_the_baseline(folder):
    files = _files(folder)
    for file, paths in ((folder / "held.json", {"a/press.toml", "b/press.toml"}),
                        (folder / "a" / "held.json", {"press.toml", "../b/press.toml"})):  # fmt: skip
        held = standard(files, baseline=file, may_lack=True).baseline.places
        assert {place.path for place in held.values()} == paths
    assert places([read("juki-mf7923d")], folder)["juki-mf7923d"].path == "juki-mf7923d"


def test_a_named_baseline_that_does_not_exist_is_refused(folder):
    with pytest.raises(LinkproofError, match=r"expected a baseline at '.*nix.json', got no such file: .*--record-base"):
        standard([], baseline=folder / "nix.json")


def _run(record):
    return run_record(record, [record])


def _campaign(folder, *, records=False):
    """Both linkages by an engine whose torque is off by a millionth."""
    files = _files(folder)
    linkages = tuple(file.linkage() for file in files)
    request = CampaignRequest(linkages, (MOTION,), "c", ())
    record = {"engine": "e", "quantity": "Mkr", "error_max": 1e-6, "outcome": "passed"}
    results = [_run(replace(blank_record(case, "tuned"), **record)) for case in cases(request)]
    file = folder / "held.json"
    held = standard(files, folder / "limits.toml", file, may_lack=True)
    return judged_campaign(request, results, held, file if records else None)


def test_a_campaign_is_recorded_and_then_compared_with_its_record(folder):
    first = _campaign(folder)
    assert first.as_dict["limits"][0]["value"] == 0.25
    assert all(one.recorded is None and one.now is not None and one.sentence for one in first.figures)
    assert first.notes == ("the baseline is empty: --record-baseline writes it",)
    recorded = _campaign(folder, records=True)
    assert recorded.notes == ()
    assert [record.baseline for record in recorded.records] == [None, None]  # judged by the limits alone
    again = _campaign(folder)
    assert [record.baseline for record in again.records] == [pytest.approx(0.25e-3)] * 2
    assert not any(figure.changed for figure in again.figures)
    assert {figure.mechanism for figure in again.figures} == {"a-press", "b-press"}
    assert set(json.loads((folder / "held.json").read_text(encoding="utf-8"))["linkages"]) == {
        "a/press.toml",
        "b/press.toml",
    }


def test_a_mass_changed_by_a_hundredth_is_seen_in_its_own_file_alone(folder):
    _campaign(folder, records=True)
    path = folder / "b" / "press.toml"
    path.write_text(path.read_text(encoding="utf-8").replace("mass    = 0.03\n", "mass    = 0.0303\n"), "utf-8")
    found = _campaign(folder)
    assert {figure.mechanism for figure in found.figures if figure.changed} == {"b-press"}
    (note,) = found.notes
    assert note == "b/press.toml has changed since its baseline was recorded"


def test_a_linkage_without_a_record_is_a_departure(folder):
    file = folder / "held.json"
    _campaign(folder, records=True)
    files = _files(folder)
    baseline = read_baseline(file, places(files, folder))
    linkages = (files[0].linkage("as-printed"),)
    seen = [blank_record(case, "") for case in cases(CampaignRequest(linkages, (MOTION,), "c", ()))]
    (one,) = departures(linkages, seen, baseline)
    assert one.place == ("a/press.toml", "as-printed", "run-up: c, gravity on")
    assert one.sentence.startswith("a/press.toml (as-printed), run-up: c, gravity on is not in the baseline: --record")


def test_a_recorded_linkage_without_its_file_is_a_departure_until_it_is_recorded_anew(folder):
    file = folder / "held.json"
    _campaign(folder, records=True)
    (folder / "b" / "press.toml").unlink()
    kept = [replace(read(str(folder / "a" / "press.toml")), name="a-press")]
    held = standard(kept, baseline=file)
    one = CampaignRequest((kept[0].linkage(),), (MOTION,), "c", ())
    (words,) = judged_campaign(one, [], held).departures
    assert words.startswith("b/press.toml is in the baseline and does not exist any more: ")
    assert judged_campaign(one, [], held, file).departures == ()
    assert [*json.loads(file.read_text(encoding="utf-8"))["linkages"]] == ["a/press.toml"]
