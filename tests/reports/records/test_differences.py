"""What has moved between two folders, as a table tells it."""

from comparisons.folders.difference import FolderDifference, MovedRecord, RunPair
from comparisons.judging.records import Record
from reports.document.terminal import rendered
from reports.records.differences import difference_printout

RUN = ("press", "base", "run-up", "pymunk", "tuned")


def _record(error, outcome="passed", peak=2.0):
    return Record(
        *RUN[:3],
        "1000 rpm",
        RUN[3],
        "7",
        RUN[4],
        quantity="Mkr",
        unit="N m",
        error_max=error,
        outcome=outcome,
        peak=peak,
    )


def _difference(same_machine, seconds=(0.5, 0.25)):
    move = MovedRecord(_record(1e-5), _record(4e-5, "over-limit", peak=1.0), 3e-5, beyond=True)
    runs = (RunPair(RUN, ("7.0", "7.1"), seconds, (100, 200)),)
    names = ((("press", "base"), ("press", "base")),)
    facts = (("pymunk", "7.0", "7.1"),)
    return FolderDifference(names, 3, (move,), runs, (), ("a run",), (), facts, same_machine)


def test_an_error_stands_beside_the_one_before_with_factor_and_peak():
    printout = difference_printout(_difference(same_machine=True))
    (line,) = [line for line in rendered(*printout.tables).splitlines() if "Mkr" in line]
    assert line.split()[-8:] == ["1.0e-5", "✓", "4.0e-5", "✗", "4.0", "−50.0", "%", "beyond"]
    assert printout.closing == [
        "only in the first folder: a run",
        "3 records in both folders: 1 moved; 1 beyond limits",
    ]


def test_seconds_are_told_of_one_machine_alone():
    here, elsewhere = (rendered(*difference_printout(_difference(same)).details) for same in (True, False))
    assert "7.0 → 7.1" in here
    assert "500 ms" in here
    assert "0.50" in here
    assert "500 ms" not in elsewhere
    assert "seconds are not compared" in elsewhere


def test_a_run_that_took_no_time_has_no_factor():
    assert "–" in rendered(*difference_printout(_difference(True, seconds=(0.0, 0.1))).details)
