"""The benchmark in a terminal."""

from dataclasses import asdict

from comparisons.work_precision.records import Bench, MeasuredCost
from reports.document.terminal import rendered
from reports.work_precision.terminal import printout
from tests.reports.made_up_bench import made_up_bench, nothing_finished


def _text(bench, quantities=(), width=110):
    tables, closing, _ = printout(bench, quantities)
    return rendered(*tables, *closing, width=width)


def test_methods_choices_and_settings_stand_in_one_block_per_place():
    text = _text(made_up_bench())
    assert text.count("largest error over the peak") == 2
    assert "still falling" in text
    assert "alpha   1e-2          4.00 ms  plain @ 4\n" in text
    assert "beta    1e-6 to 1e-7   256 ms  higher x2 @ 32\n" in text
    assert "tuned: 4.0e-4 in 17.0 ms; on the front of single runs" in text
    assert "torn: diverged: the joints <gave> way" in text
    assert "beside every run took 1.00 ms at best" in " ".join(text.split())


def test_quantities_asked_for_have_a_block_each():
    text = _text(made_up_bench(), ("joint_force", "Mkr"))
    assert text.index("joint force, largest error") < text.index("Mkr, largest error")
    assert text.count("largest error over the peak") == 4


def test_an_engine_that_is_absent_says_so():
    assert "gamma: unavailable: not installed" in _text(nothing_finished())


def test_costs_stand_below_where_they_were_measured():
    cost = MeasuredCost("made-up", "base", "alpha", "Jeq <alone>", "", seconds=(1.0, 0.5, 0.75))
    text = _text(Bench({**made_up_bench().document, "costs": [asdict(cost)]}, made_up_bench().points))
    assert "Jeq <alone> 500 ms (100 %)" in " ".join(text.split())


def test_details_have_a_row_for_every_point():
    bench = made_up_bench()
    text = rendered(*printout(bench).details)
    assert len(text.splitlines()) == len(bench.records) + 2
    assert all(record.detail in text for record in bench.records)
