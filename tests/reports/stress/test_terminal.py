"""The terminal has the counts, the borders, and every cell that was missed or an alarm."""

from comparisons.stress.cell_result import StressVerdict
from reports.document.terminal import rendered
from reports.stress.terminal import cell_details, printout
from tests.reports.made_up_stress import made_up_stress

STRESS = made_up_stress()


def told(stress, width=100):
    tables, closing, _ = printout(stress)
    return rendered(*tables, *closing, width=width)


def test_the_terminal_has_counts_borders_and_what_was_missed():
    text = told(STRESS)
    assert max(map(len, text.splitlines())) <= 100
    assert text.count("missed: ") == len(STRESS.of(StressVerdict.MISSED))
    assert text.count("alarm: ") == len(STRESS.of(StressVerdict.ALARM))
    assert "✗ missed" in text
    assert "last within, first beyond" in text
    assert "last within" not in told(made_up_stress(borders=[]))


def test_one_cell_is_told_in_full():
    (caught, *_) = STRESS.of(StressVerdict.CAUGHT)
    text = rendered(cell_details(caught))
    assert text.startswith(f"{caught.cell.key}: caught")
    assert caught.reason in text
    assert "10 steps" in text
    every = rendered(*printout(STRESS).details)
    assert all(result.cell.key in every for result in STRESS.results)
