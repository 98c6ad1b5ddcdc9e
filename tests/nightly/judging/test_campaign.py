"""Files of an independent program: the fault is named first, whatever the names of links and points."""

import pytest

from tests.nightly.judging.campaign import KINDS, RIGHT, judged, outcome, trial
from tests.nightly.judging.exports import case

SEED = 7


USUAL = [("clean", 50), ("fault", 6)]
OTHERS = [(kind, number) for kind in ("clean", "fault") for number in (6, 17, 44, 50, 81)]


@pytest.mark.parametrize(
    ("kind", "number"), [*USUAL, *(pytest.param(*one, marks=pytest.mark.nightly) for one in OTHERS if one not in USUAL)]
)
def test_the_fault_is_named_first_and_none_in_a_clean_file(kind, number):
    export = case(SEED, number, int(kind == "fault"))
    assert outcome(export, judged(export)) in RIGHT


@pytest.mark.nightly
@pytest.mark.parametrize("number", [94, 36])
def test_an_answer_does_not_hang_on_names_nor_on_the_order_of_the_file(number):
    came, changes, _, words = trial("fault", number, SEED)
    assert (came in RIGHT, changes) == (True, False), words


@pytest.mark.nightly
def test_faults_of_two_columns_are_both_named():
    named = [outcome(export, judged(export)) for export in (case(0, number, KINDS["columns"]) for number in range(20))]
    assert named.count("first") >= 18
