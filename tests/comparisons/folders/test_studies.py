"""Benchmarks and stability maps are held against themselves and against those of another folder."""

import json

import pytest

from comparisons.folders.studies import StudyFolder, checked_studies, study_differences
from comparisons.folders.verification import verify
from comparisons.runs.study_folder import save_study
from comparisons.stress import saved as stress_test
from comparisons.stress.border import borders
from comparisons.work_precision.analysis import judged
from reports.records.differences import study_printout
from reports.records.findings import closing_line
from tests.reports.made_up_bench import made_up_bench
from tests.reports.made_up_stress import made_up_cell, made_up_stress

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
    assert [faults for _, faults in checked_studies(StudyFolder(folder))] == [[], []]
    words = closing_line(verify(folder))
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


def test_what_has_moved_is_told_and_what_is_worse_decides(tmp_path):
    def worse(bench, stress):
        row = finished(bench)
        row["errors"][0]["error_max"] *= 5.0
        stress["cells"][1]["verdict"] = "missed"

    found = {one.kind: one for one in _differences(saved(tmp_path / "a"), saved(tmp_path / "b", worse))}
    (point,), (cell,) = found["bench"].moves, found["stress"].moves
    assert (point.quantity, point.is_worse, point.errors[1] / point.errors[0]) == ("Mkr", True, pytest.approx(5.0))
    assert (cell.outcomes, cell.is_worse) == (("within limit", "missed"), True)
    assert study_printout(found["stress"]).closing == ["stress: 3 runs in both folders: 1 moved; 1 worse"]


def test_a_run_of_one_folder_alone_is_told(tmp_path):
    def fewer(bench, _):
        bench["records"].pop()

    first, _ = _differences(saved(tmp_path / "a"), saved(tmp_path / "b", fewer))
    assert (len(first.only_before), first.only_after) == (1, ())


def test_made_up_points_are_as_judged():
    assert judged(BENCH.points) == tuple(BENCH.points)
