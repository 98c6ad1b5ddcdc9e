"""Two folders, or two studies, compared: moved errors, changed figures, contradictions."""

import json
import shutil

import pytest

from analytic.description.crank_motion import crank_motion
from analytic.description.loading import load
from analytic.errors import LinkproofError
from comparisons.campaign.results import load as load_results
from comparisons.folders.difference import difference
from comparisons.folders.studies import StudyFolder, check_studies, study_differences
from comparisons.folders.verification import verify
from comparisons.runs.study_folder import save_study
from comparisons.stress import saved as stress_test
from comparisons.stress.border import borders
from reports.records.differences import study_printout, verification_line
from tests.comparisons.folders.saved_campaign import changed, row, save_campaign
from tests.reports.made_up_bench import made_up_bench
from tests.reports.made_up_stress import made_up_cell, made_up_stress


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


def test_an_error_within_three_times_its_record_is_a_move_and_one_beyond_decides(folder, tmp_path):
    (limit,) = (one.limit for one in load_results(folder).records if one.quantity == "Mkr")

    def to(share):
        return lambda _, run: row(run, "Mkr").update(error_max=share * limit, error_rms=0.0)

    first = changed(folder, tmp_path / "first", to(0.1))
    within = _upgrade(first, tmp_path / "within", to(0.29))
    (move,) = within.moves
    assert (move.after.quantity, move.is_beyond, within.beyond_count) == ("Mkr", False, 0)
    assert move.factor == pytest.approx(2.9)
    beyond = _upgrade(first, tmp_path / "beyond", to(0.31))
    assert [(move.allowed, move.is_beyond) for move in beyond.moves] == [(pytest.approx(0.3 * limit), True)]
    assert beyond.beyond_count == 1
    assert beyond.runs[0].versions[1] == "2"


def test_a_new_failure_decides_and_an_old_one_does_not(folder, tmp_path):
    def fail(_, run):
        row(run, "S").update(outcome="over-limit")

    failed = _upgrade(folder, tmp_path / "b", fail)
    assert [(move.before.outcome, move.after.outcome) for move in failed.moves] == [("passed", "over-limit")]
    assert failed.beyond_count == 1
    assert _upgrade(tmp_path / "b", tmp_path / "c", lambda *_: None).beyond_count == 0


def test_a_mass_that_was_changed_moves_key_figures_of_the_same_linkage_beyond(folder, tmp_path):
    text = load("juki-mf7923d").text
    heavier = tmp_path / "juki-mf7923d.toml"
    heavier.write_text(text.replace("0.64\n", "0.6464\n", 1), encoding="utf-8")
    found = difference(load_results(folder), load_results(save_campaign(tmp_path / "b", load(str(heavier)))))
    assert {figure.figure for figure in found.figures} >= {"Mkr.peak", "Peq.peak", "Jeq.mean"}
    assert found.beyond_count == len(found.figures)


def test_two_variants_and_two_designs_are_pairs_and_their_figures_decide_nothing(folder, tmp_path):
    printed = save_campaign(tmp_path / "printed", load("juki-mf7923d", "as-printed"))
    found = difference(load_results(folder), load_results(printed))
    assert found.linkages == ((("juki-mf7923d", "as-built"), ("juki-mf7923d", "as-printed")),)
    assert found.figures
    assert found.beyond_count == 0
    other = tmp_path / "other.toml"
    shutil.copyfile(_file("juki-mf7923d", tmp_path), other)
    found = difference(load_results(folder), load_results(save_campaign(tmp_path / "design", load(str(other)))))
    assert found.linkages == ((("juki-mf7923d", "as-built"), ("other", "as-built")),)
    assert (found.figures, found.moves) == ((), ())


def _file(name, folder):
    path = folder / f"{name}.toml"
    path.write_text(load(name).text, encoding="utf-8")
    return path


def test_folders_without_a_run_in_common_are_refused(folder, tmp_path):
    slower = save_campaign(tmp_path / "b", load("juki-mf7923d"), crank_motion("constant-speed", start_angle=0.3))
    with pytest.raises(LinkproofError, match="expected runs under the same conditions in both folders, got none"):
        difference(load_results(folder), load_results(slower))


BENCH = made_up_bench(mechanisms=("juki-mf7923d",))
LINE = [("within limit", 1.0), ("within limit", 2.0), ("caught", 4.0)]


def stress_test_of_a_line():
    place = {"axis": "mass", "row": "four-bar, crank", "engine": "alpha", "usage": "tuned"}
    cells = [made_up_cell(stress_test.StressVerdict(verdict), value=value, **place) for verdict, value in LINE]
    return made_up_stress(("mass",), quick=True, cells=cells, borders=[one.document for one in borders(cells)])


def saved(folder, edit=lambda bench, stress: None):
    """A folder with both, as ``edit`` has changed them."""
    bench, stress = (json.loads(json.dumps(one.as_dict)) for one in (BENCH, stress_test_of_a_line()))
    edit(bench, stress)
    for kind, told, rows in (("bench", bench, bench.pop("records")), ("stress", stress, stress.pop("cells"))):
        save_study(folder, kind, told, ((f"{number}", row, {}) for number, row in enumerate(rows)))
    return folder


def test_nothing_differs_in_folders_as_they_were_written(tmp_path):
    folder = saved(tmp_path / "a")
    assert [faults for _, faults in check_studies(StudyFolder(folder))] == [[], []]
    words = verification_line(verify(folder))
    assert words.endswith("; stress: 3 cells, 1 borders; nothing differs")
    assert words.startswith("bench: ")
    for found in _differences(folder, saved(tmp_path / "b")):
        assert (found.moves, found.only_before, found.only_after) == ((), (), ())
        assert found.compared > 2


def _differences(before, after):
    return study_differences(StudyFolder(before), StudyFolder(after))


def finished(bench):
    return next(row for row in bench["records"] if row["kind"] == "method" and row["errors"])


@pytest.mark.parametrize(
    ("edit", "words"),
    [
        (lambda bench, _: finished(bench).update(seconds=1e-9), "the shortest repeat took"),
        (lambda bench, _: finished(bench).update(fronts=["nothing"]), "it is on the fronts of nothing"),
        (lambda bench, _: finished(bench).update(orders={"Mkr": 9.0}), "its order in Mkr is 9"),
        (lambda _, stress: stress["cells"][0].update(wrong="torque off"), "saved as within limit, its errors say"),
        (lambda _, stress: stress["borders"][0].update(outside=9.0), "its border does not lie between two cells"),
    ],
)
def test_what_contradicts_itself_is_found(tmp_path, edit, words):
    def with_errors(bench, stress):
        stress["cells"][0]["errors"] = [{"quantity": "Mkr", "error_max": 1e-9, "limit": 1e-3}]
        edit(bench, stress)

    (finding,) = (one for one in verify(saved(tmp_path / "a", with_errors)).findings if words in one.sentence)
    assert finding.place.startswith(("bench ", "stress "))


def test_moves_are_listed_and_worse_ones_decide(tmp_path):
    def worse(bench, stress):
        row = finished(bench)
        row["errors"][0]["error_max"] *= 5.0
        stress["cells"][1]["verdict"] = "missed"

    found = {one.kind: one for one in _differences(saved(tmp_path / "a"), saved(tmp_path / "b", worse))}
    (point,), (cell,) = found["bench"].moves, found["stress"].moves
    assert (point.quantity, point.is_worse, point.errors[1] / point.errors[0]) == ("Mkr", True, pytest.approx(5.0))
    assert (cell.outcomes, cell.is_worse) == (("within limit", "missed"), True)
    assert study_printout(found["stress"]).closing == ["stress: 3 runs in both folders: 1 moved; 1 worse"]
