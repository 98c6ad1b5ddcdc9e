"""A traced formula is the formula: one list of operations, without what is there already and what changes nothing."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from analytic.description.changes import named_numbers
from analytic.machine_code.tracing import OperationList, linkage_trace
from tests.analytic.linkages import mechanism

NUMBERS = st.floats(-1e3, 1e3)


def traced(formula, *values):
    """The value of a formula computed from its list, and how many lines of it lead there."""
    trace = OperationList()
    numbers = [trace.input(name) for name in range(len(values))]
    line = trace.line(formula(*numbers))
    given = {number.line: value for number, value in zip(numbers, values, strict=True)}
    return trace.evaluate([line], given)[0], len(trace.lines_needed([line]))


FORMULAS = {
    "arithmetic": lambda x, y: (x + 2.0) * y - x / (y * y + 1.0) + 3.0 * -x,
    "functions": lambda x, y: np.hypot(np.sin(x), np.cos(y)) + np.arctan2(y, x) + np.sqrt(np.square(x)) + abs(y) ** 2,
    "choices": lambda x, y: np.where((x < y) & ~(x <= 0.0), np.maximum(x, y), np.minimum(x, -y)) + np.sign(x),
    "arrays": lambda x, y: np.stack([np.copy(np.broadcast_to(x, ())), y])[0] * y,
}


@pytest.mark.parametrize("name", FORMULAS)
@settings(max_examples=30)
@given(x=NUMBERS, y=NUMBERS)
def test_a_list_computes_what_the_formula_computes(name, x, y):
    outcome, _ = traced(FORMULAS[name], x, y)
    assert outcome == pytest.approx(FORMULAS[name](np.float64(x), np.float64(y)), rel=1e-15, abs=0.0)


@pytest.mark.parametrize(
    ("formula", "operations"),
    [
        (lambda x, y: x * y + y * x, 4),  # the inputs, a product, a sum
        (lambda x, y: x * 1.0 + 0.0 - 0.0 + y * 0.0 + 0.0 / y, 1),
        (lambda x, _: (x + 1.0) * 2.0 - (1.0 + x) * 2.0, 6),  # of constants two
        (lambda x, _: x * (np.sin(0.5) * 0.0), 1),
        (lambda x, y: np.where(True & (x < 1.0) & True | False, x, y), 5),
        (lambda x, y: -1.0 * x + (0.0 - x) + y, 5),
    ],
)
def test_nothing_stands_twice_and_nothing_stands_in_vain(formula, operations):
    assert traced(formula, 2.0, 3.0)[1] == operations


def test_only_what_leads_to_a_result_is_computed():
    trace = OperationList()
    x, y = trace.input("x"), trace.input("y")
    assert trace.input("x").line == x.line
    result, other = x * x + 1.0, np.sin(y)
    assert other.line not in trace.lines_needed([result.line])
    assert y.line not in trace.lines_needed([result.line])
    assert trace.evaluate([result.line], {x.line: 3.0}) == [10.0]
    assert trace.lines_needed([result.line], known=[result.line]) == [result.line]


@pytest.mark.parametrize("slip", [bool, float, math.sqrt, np.asarray, lambda x: x if x > 0.0 else -x, np.cumsum])
def test_what_a_list_cannot_have_raises(slip):
    with pytest.raises(TypeError):
        slip(OperationList().input("x"))
    with pytest.raises(TypeError):
        np.ones(3) * OperationList().input("x")


def test_the_list_of_a_linkage_is_the_same_in_every_process():
    """A set has another order in each: numbers come by name."""
    four_bar = mechanism("juki-mf7923d")
    names = [name for name in named_numbers(four_bar.linkage) if ".x" in name or "mass" in name]
    inputs = linkage_trace(four_bar, names[::-1], ["Mkr"]).trace.inputs
    assert [name for name in inputs if name in names] == sorted(names)
