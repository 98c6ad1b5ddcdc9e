"""Two folders side by side: an upgrade that got worse, a design that changed, a variant."""

import shutil

import pytest

from analytic.description.crank_motion import crank_motion
from analytic.description.loading import load
from analytic.errors import LinkproofError
from comparisons.campaign.results import load as load_results
from comparisons.folders.difference import difference
from comparisons.folders.verification import verify
from tests.comparisons.folders.saved_campaign import changed, row, save_campaign


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return save_campaign(tmp_path_factory.mktemp("sent") / "a", load("juki-mf7923d"))


def _upgrade(folder, into, edit):
    """What has moved where an engine's upgrade has changed its records."""

    def upgraded(told, run):
        run["engine_version"] = "2"
        edit(told, run)

    return difference(load_results(folder), load_results(changed(folder, into, upgraded)))


def _fewer_figures(told, _):
    """A folder as earlier versions wrote it: peaks alone."""
    told["figures"] = [one for one in told["figures"] if one["figure"].endswith((".peak", ".mean"))]


def test_figures_that_an_earlier_version_did_not_tell_are_no_difference(folder, tmp_path):
    older = changed(folder, tmp_path / "older", _fewer_figures)
    assert difference(load_results(older), load_results(folder)).figures == ()
    assert verify(older).findings == ()


def test_nothing_moves_from_a_folder_to_itself(folder):
    found = difference(load_results(folder), load_results(folder))
    assert (found.moves, found.figures, found.facts, found.beyond) == ((), (), (), 0)
    assert found.only_before == found.only_after == ()
    assert found.compared == len(load_results(folder).records) + len(load_results(folder).invariants)


def test_an_error_within_three_times_its_own_is_told_and_one_beyond_decides(folder, tmp_path):
    (limit,) = (one.limit for one in load_results(folder).records if one.quantity == "Mkr")

    def to(share):
        return lambda _, run: row(run, "Mkr").update(error_max=share * limit, error_rms=0.0)

    first = changed(folder, tmp_path / "first", to(0.1))
    within = _upgrade(first, tmp_path / "within", to(0.29))
    (move,) = within.moves
    assert (move.after.quantity, move.beyond, within.beyond) == ("Mkr", False, 0)
    assert move.factor == pytest.approx(2.9)
    beyond = _upgrade(first, tmp_path / "beyond", to(0.31))
    assert [(move.allowed, move.beyond) for move in beyond.moves] == [(pytest.approx(0.3 * limit), True)]
    assert beyond.beyond == 1
    assert beyond.runs[0].versions[1] == "2"


def test_a_new_failure_decides_and_an_old_one_does_not(folder, tmp_path):
    def fail(_, run):
        row(run, "S").update(outcome="over-limit")

    failed = _upgrade(folder, tmp_path / "b", fail)
    assert [(move.before.outcome, move.after.outcome) for move in failed.moves] == [("passed", "over-limit")]
    assert failed.beyond == 1
    assert _upgrade(tmp_path / "b", tmp_path / "c", lambda *_: None).beyond == 0


def test_what_only_one_folder_has_is_told(folder, tmp_path):
    found = _upgrade(folder, tmp_path / "b", lambda _, run: run["errors"].remove(row(run, "v")))
    assert found.only_before == ("juki-mf7923d/as-built/run-up/direct/tuned: v",)
    assert found.only_after == ()


def test_a_mass_that_was_changed_moves_key_figures_of_the_same_linkage_beyond(folder, tmp_path):
    text = load("juki-mf7923d").text
    heavier = tmp_path / "juki-mf7923d.toml"
    heavier.write_text(text.replace("0.64\n", "0.6464\n", 1), encoding="utf-8")
    found = difference(load_results(folder), load_results(save_campaign(tmp_path / "b", load(str(heavier)))))
    assert {figure.figure for figure in found.figures} >= {"Mkr.peak", "Peq.peak", "Jeq.mean"}
    assert found.beyond == len(found.figures)


def test_two_variants_and_two_designs_are_pairs_and_their_figures_decide_nothing(folder, tmp_path):
    printed = save_campaign(tmp_path / "printed", load("juki-mf7923d", "as-printed"))
    found = difference(load_results(folder), load_results(printed))
    assert found.linkages == ((("juki-mf7923d", "as-built"), ("juki-mf7923d", "as-printed")),)
    assert found.figures
    assert found.beyond == 0
    other = tmp_path / "other.toml"
    shutil.copyfile(_file("juki-mf7923d", tmp_path), other)
    found = difference(load_results(folder), load_results(save_campaign(tmp_path / "design", load(str(other)))))
    assert found.linkages == ((("juki-mf7923d", "as-built"), ("other", "as-built")),)
    assert (found.figures, found.moves) == ((), ())


def _file(name, folder):
    path = folder / f"{name}.toml"
    path.write_text(load(name).text, encoding="utf-8")
    return path


def test_times_of_two_machines_are_not_of_one(folder, tmp_path):
    def elsewhere(told, _):
        told["environment"]["machine"] = "another"

    assert not _upgrade(folder, tmp_path / "b", elsewhere).same_machine


def test_folders_without_a_run_in_common_are_refused(folder, tmp_path):
    slower = save_campaign(tmp_path / "b", load("juki-mf7923d"), crank_motion("constant-speed", start_angle=0.3))
    with pytest.raises(LinkproofError, match="expected runs under the same conditions in both folders, got none"):
        difference(load_results(folder), load_results(slower))
