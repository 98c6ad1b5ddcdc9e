"""The benchmark in a terminal."""

from rich.console import Console

from reports.work_precision.terminal import bench_tables
from tests.reports.made_up_bench import made_up_bench, nothing_finished


def _text(renderable, width=110):
    console = Console(width=width, no_color=True, force_terminal=False)
    with console.capture() as capture:
        console.print(renderable)
    return capture.get()


def test_methods_choices_and_settings_stand_in_one_block_per_place():
    text = _text(bench_tables(made_up_bench()))
    assert text.count("largest error over the peak") == 2
    assert "still falling" in text
    assert "4.00 ms: plain @ 4" in text
    assert "tuned: 4.0e-4 in 17.0 ms; on the front" in text
    assert "torn: diverged: the joints <gave> way" in text
    assert "beside every run took 1.00 ms at best" in " ".join(text.split())


def test_quantities_asked_for_have_a_block_each():
    text = _text(bench_tables(made_up_bench(), ("joint_force", "Mkr")))
    assert text.index("joint force, largest error") < text.index("Mkr, largest error")
    assert text.count("largest error over the peak") == 4


def test_an_engine_that_is_absent_says_so():
    assert "gamma: unavailable: not installed" in _text(bench_tables(nothing_finished()))
