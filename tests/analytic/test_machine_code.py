"""The list of operations of a linkage, and its sources in Python and in JavaScript: the numbers of NumPy."""

import gc
import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from analytic import machine_code
from analytic.designs.sampled_signals import evaluate_designs
from analytic.errors import LinkproofError, UnknownNameError
from analytic.kinematics.mechanism import Mechanism
from analytic.machine_code import (
    FUNCTION,
    LANES,
    Result,
    StraightFunction,
    is_worthwhile,
    linkage_trace,
    plain_program,
    python_source,
)
from analytic.operations import FUNCTIONS, OperationList
from analytic.signals import names
from reports.document.templates import FOLDER
from tests.analytic.linkages import from_text, mechanism, text_of
from tests.javascript import called

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


@pytest.mark.parametrize("slip", [bool, float, math.sqrt, np.asarray, lambda x: x if x > 0.0 else -x, np.cumsum])
def test_what_a_list_cannot_have_raises(slip):
    with pytest.raises(TypeError):
        slip(OperationList().input("x"))
    with pytest.raises(TypeError):
        np.ones(3) * OperationList().input("x")


SAME = 1e-14  # of the peak: square roots of sums in place of a library's hypot

numba = pytest.mark.skipif(not machine_code.is_installed(), reason="numba is not installed")


def every_operation():
    """A trace of every operation on two numbers of a lane and one of a row."""
    trace = OperationList()
    x, y, row = (trace.input(name) for name in ("x", "y", "row"))
    terms = [x + y, x - row, x * y, x / y, -x, abs(row), np.sign(x), np.sqrt(abs(y)), np.hypot(x, y), np.sin(x)]
    terms += [np.cos(row), np.arctan2(y, x), np.maximum(x, y), np.minimum(x, row), np.where(x < y, x, row)]
    terms += [np.where((x <= y) & (x > row) | ~(x >= 0.0), 1.5, math.inf), np.where(x > 2.0, math.nan, y)]
    return trace, [x.line, y.line], [row.line], [trace.line(term) for term in terms]


@numba
@pytest.mark.parametrize("count", [1, 2 * LANES + 5])
def test_every_operation_in_any_number_of_lanes(count):
    trace, lanes, rows, outputs = every_operation()
    assert {operation.name for operation in trace.operations} >= set(FUNCTIONS)
    draw = np.random.default_rng(count)
    x, y = draw.uniform(-3.0, 3.0, (2, count))
    given = dict(zip([*lanes, *rows], [x, y, 0.7], strict=True))
    result = StraightFunction(trace, lanes, rows, [Result(line) for line in outputs])([x, y], np.array([[0.7]]), count)
    for one, expected in zip(result, trace.evaluate(outputs, given), strict=True):
        np.testing.assert_allclose(one, np.broadcast_to(expected, count), rtol=SAME, atol=0.0)


def test_a_source_is_made_of_numbers_and_operations():
    hostile = '"\'); import os; os.abort()"'
    sample = from_text(text_of("centric-slider-crank").replace("coupler", hostile))
    of = linkage_trace(sample, (), names(sample))
    source = python_source(of.trace, of.split_inputs(of.lines)[1], (), [Result(line) for line in of.lines])
    assert "import" not in source
    assert '"' not in source
    assert source.startswith(f"def {FUNCTION}(lanes, rows, results):")


def test_it_is_compiled_where_that_saves_time(monkeypatch):
    assert not is_worthwhile("auto", 200, 1e5)
    assert is_worthwhile("auto", 200, 1e8) == machine_code.is_installed()
    assert not is_worthwhile("auto", 10_000, 1e9)  # too long a list
    assert not is_worthwhile("numpy", 200, 1e9)
    with pytest.raises(UnknownNameError, match="path"):
        is_worthwhile("quick", 1, 1.0)
    monkeypatch.setattr(machine_code, "is_installed", lambda: False)
    assert not is_worthwhile("auto", 200, 1e8)
    with pytest.raises(LinkproofError, match=r"pip install 'linkproof\[compiled\]'"):
        is_worthwhile("compiled", 1, 1.0)


SCRIPT = (FOLDER / "scripts" / "live_program.js").read_text(encoding="utf-8")
CALL = """({program, designs, rows, count, results}) => {
  const linkproof = {};
  SCRIPT
  const run = eval(linkproof.programSource(program));
  return designs.map((given) => {
    const found = new Float64Array(results * count);
    run(Float64Array.from(given), Float64Array.from(rows), found, count);
    return [...found].map(one => Number.isFinite(one) ? one : String(one));
  });
}""".replace("SCRIPT", SCRIPT)


def by_javascript(program, designs, rows, results):
    """Results (designs, results, count) of a list of operations at rows (rows, count)."""
    arguments = {
        "program": program,
        "designs": designs,
        "rows": rows.ravel().tolist(),
        "count": rows.shape[1],
        "results": results,
    }
    result = called(CALL, arguments)
    return np.array(result, dtype=float).reshape(len(designs), results, -1)


def test_every_operation():
    trace, numbers, rows, outputs = every_operation()
    x, y, row = 0.7, -2.5, np.array([-1.0, -0.0, 0.0, 0.7, 3.0])
    (result,) = by_javascript(plain_program(trace, numbers, rows, outputs), [[x, y]], row[None], len(outputs))
    expected = trace.evaluate(outputs, dict(zip([*numbers, *rows], [x, y, row], strict=True)))
    for one, truth in zip(result, expected, strict=True):
        np.testing.assert_allclose(one, np.broadcast_to(truth, len(row)), rtol=1e-15, atol=0.0)


def test_a_list_that_reads_what_is_not_there_is_refused():
    trace, numbers, rows, outputs = every_operation()
    program = plain_program(trace, numbers, rows, outputs)
    source = "linkproof.programSource(program)"
    call = CALL.replace("const run", f"try {{ {source}; }} catch (e) {{ return e.message; }} const run")
    for wrong in ({"names": ["constructor"]}, {"results": [10**6]}, {"operations": [[0, 99, 1]]}, {"results": [0.5]}):
        assert called(call, {"program": program | wrong, "designs": []}) == "this is no list of operations"
    assert called(call, {"program": program, "designs": []}) == []


@pytest.mark.parametrize("name", ["maximum", "minimum"])
@pytest.mark.parametrize("pair", [(1.0, 2.0), (2.0, 1.0), (2.0, 2.0), (math.nan, 1.0), (1.0, math.nan)])
def test_the_larger_of_no_number_is_none_as_with_numpy(name, pair):
    written = machine_code.PYTHON_FORMS[name].format("x", "y")
    value = eval(written, {"x": pair[0], "y": pair[1]})
    assert value == pytest.approx(getattr(np, name)(*pair), nan_ok=True)


def test_designs_that_are_followed_one_by_one_are_let_go():
    """Of a linkage with change points: its signals' table kept 64 of them alive."""
    sample = mechanism("parallelogram")
    lengths = np.linspace(0.05, 0.07, 20)

    def alive():
        gc.collect()
        found = [one for one in gc.get_objects() if isinstance(one, Mechanism)]
        return sum(one.linkage.name == sample.linkage.name for one in found)

    before = alive()
    evaluate_designs(sample, {"crank.A.x": lengths, "rocker.B.x": lengths}, [0.3, 0.4], ["point:B:x"])
    assert alive() < before + 5
