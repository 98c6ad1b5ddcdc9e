"""The standard of a campaign: a project's limits, files with precedence over them, and its baseline."""

import json
from dataclasses import replace

import pytest

from analytic.description.crank_motion import crank_motion
from analytic.description.loading import read
from analytic.errors import LinkproofError
from comparisons.campaign.campaign import CampaignRequest, cases
from comparisons.campaign.project import judged_campaign, places, read_project, standard
from comparisons.judging.baseline import departures, read_baseline
from comparisons.judging.limits import shipped_limits
from comparisons.judging.records import blank_record, run_record

MOTION = crank_motion("run-up")
ROW = '[[limit]]\nquantities = ["Mkr"]\nvalue = {}\n'


@pytest.fixture
def folder(tmp_path):
    """A project of two linkages of one name."""
    text = read("juki-mf7923d").text
    for name in ("a", "b"):
        (tmp_path / name).mkdir()
        (tmp_path / name / "press.toml").write_text(text, encoding="utf-8")
    (tmp_path / "linkproof.toml").write_text(ROW.format(0.25))
    (tmp_path / "limits.toml").write_text(ROW.format(0.5))
    return tmp_path


def _files(folder):
    return [replace(read(str(folder / name / "press.toml")), name=f"{name}-press") for name in ("a", "b")]


def _mkr(found):
    return found.limits.limit("Mkr", "tuned", "run-up").value


def test_options_go_before_the_project_and_the_project_before_the_suite(folder):
    project = read_project(folder / "linkproof.toml")
    assert standard([]).limits == shipped_limits()
    assert _mkr(standard([], project)) == 0.25
    assert _mkr(standard([], project, folder / "limits.toml")) == 0.5
    assert _mkr(standard([], None, folder / "limits.toml")) == 0.5


def test_places_are_paths_from_the_project_or_from_the_baseline(folder):
    files, beside = _files(folder), folder / "a" / "held.json"
    project = read_project(folder / "linkproof.toml")
    for found in (standard(files, project), standard(files, project, baseline=beside, may_lack=True)):
        assert {place.path for place in found.baseline.places.values()} == {"a/press.toml", "b/press.toml"}
    alone = standard(files, baseline=beside, may_lack=True).baseline.places
    assert {place.path for place in alone.values()} == {"press.toml", "../b/press.toml"}
    assert places([read("juki-mf7923d")], folder)["juki-mf7923d"].path == "juki-mf7923d"


def test_a_named_baseline_that_does_not_exist_is_refused(folder):
    with pytest.raises(LinkproofError, match=r"expected a baseline at '.*nix.json', got no such file: .*--record-base"):
        standard([], baseline=folder / "nix.json")


def _run(record):
    return run_record(record, [record])


def _campaign(folder, record_into=None):
    """Both linkages by an engine whose torque is off by a millionth."""
    files = _files(folder)
    linkages = tuple(file.linkage() for file in files)
    request = CampaignRequest(linkages, (MOTION,), "c", ())
    record = {"engine": "e", "quantity": "Mkr", "error_max": 1e-6, "outcome": "passed"}
    results = [_run(replace(blank_record(case, "tuned"), **record)) for case in cases(request)]
    project = read_project(folder / "linkproof.toml")
    return judged_campaign(request, results, standard(files, project), record_into)


def test_a_campaign_is_recorded_and_then_compared_with_its_record(folder):
    file = read_project(folder / "linkproof.toml").baseline
    first = _campaign(folder)
    assert first.as_dict["limits"][0]["value"] == 0.25
    assert all(one.recorded is None and one.now is not None and one.sentence for one in first.figures)
    assert first.notes == ("the baseline is empty: --record-baseline writes it",)
    recorded = _campaign(folder, file)
    assert recorded.notes == ()
    assert [record.baseline for record in recorded.records] == [None, None]  # judged by the limits alone
    again = _campaign(folder)
    assert [record.baseline for record in again.records] == [pytest.approx(0.25e-3)] * 2
    assert not any(figure.changed for figure in again.figures)
    assert {figure.mechanism for figure in again.figures} == {"a-press", "b-press"}
    assert set(json.loads(file.read_text(encoding="utf-8"))["linkages"]) == {"a/press.toml", "b/press.toml"}


def test_a_mass_changed_by_a_hundredth_is_seen_in_its_own_file_alone(folder):
    _campaign(folder, read_project(folder / "linkproof.toml").baseline)
    path = folder / "b" / "press.toml"
    path.write_text(path.read_text(encoding="utf-8").replace("mass    = 0.03\n", "mass    = 0.0303\n"), "utf-8")
    found = _campaign(folder)
    assert {figure.mechanism for figure in found.figures if figure.changed} == {"b-press"}
    (note,) = found.notes
    assert note == "b/press.toml has changed since its baseline was recorded"


def test_a_linkage_without_a_record_is_a_departure(folder):
    file = folder / "held.json"
    _campaign(folder, file)
    files = _files(folder)
    baseline = read_baseline(file, places(files, folder))
    linkages = (files[0].linkage("as-printed"),)
    seen = [blank_record(case, "") for case in cases(CampaignRequest(linkages, (MOTION,), "c", ()))]
    (one,) = departures(linkages, seen, baseline)
    assert one.place == ("a/press.toml", "as-printed", "run-up: c, gravity on")
    assert one.sentence.startswith("a/press.toml (as-printed), run-up: c, gravity on is not in the baseline: --record")


def test_a_recorded_linkage_without_its_file_is_a_departure_until_it_is_recorded_anew(folder):
    file = folder / "held.json"
    _campaign(folder, file)
    (folder / "b" / "press.toml").unlink()
    kept = [replace(read(str(folder / "a" / "press.toml")), name="a-press")]
    held = standard(kept, read_project(folder / "linkproof.toml"), baseline=file)
    one = CampaignRequest((kept[0].linkage(),), (MOTION,), "c", ())
    (words,) = judged_campaign(one, [], held).departures
    assert words.startswith("b/press.toml is in the baseline and does not exist any more: ")
    assert judged_campaign(one, [], held, file).departures == ()
    assert [*json.loads(file.read_text(encoding="utf-8"))["linkages"]] == ["a/press.toml"]
