"""Lists as machine code: the numbers that NumPy computes from the list, whatever is reduced and however many lanes."""

import math
import subprocess
import sys

import numpy as np
import pytest

from analytic.errors import LinkproofError, UnknownNameError
from analytic.machine_code import compiling
from analytic.machine_code.compiling import FUNCTION, LANES, Result, StraightFunction, is_worthwhile, python_source
from analytic.machine_code.tracing import FUNCTIONS, OperationList, linkage_trace
from analytic.signals import names
from tests.analytic.linkages import from_text, text_of

SAME = 1e-14  # of the peak: square roots of sums in place of a library's hypot

numba = pytest.mark.skipif(not compiling.is_installed(), reason="numba is not installed")


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


@numba
def test_results_over_rows():
    trace, lanes, rows, outputs = every_operation()
    draw, numbers = np.random.default_rng(3), np.linspace(-2.0, 2.0, 9)
    x, y = draw.uniform(-3.0, 3.0, (2, 70))
    sums = Result(outputs[1], "{so_far} + {value}", 1.0)
    rises = Result(outputs[1], "{so_far} + 1.0 if {value} > {next} else {so_far}")  # above the row before
    last = Result(outputs[1], start=math.nan)
    result = StraightFunction(trace, lanes, rows, [sums, rises, last])([x, y], numbers[:, None], 70)
    np.testing.assert_allclose(result[0], 1.0 + np.sum(x - numbers[:, None], axis=0), rtol=1e-13)
    assert np.all(result[1] == 0.0)  # nothing is above nan, and x - row falls
    np.testing.assert_array_equal(result[2], x - numbers[-1])


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
    assert is_worthwhile("auto", 200, 1e8) == compiling.is_installed()
    assert not is_worthwhile("auto", 10_000, 1e9)  # too long a list
    assert not is_worthwhile("numpy", 200, 1e9)
    with pytest.raises(UnknownNameError, match="path"):
        is_worthwhile("quick", 1, 1.0)
    monkeypatch.setattr(compiling, "is_installed", lambda: False)
    assert not is_worthwhile("auto", 200, 1e8)
    with pytest.raises(LinkproofError, match=r"pip install 'linkproof\[compiled\]'"):
        is_worthwhile("compiled", 1, 1.0)


def test_a_few_designs_do_not_import_numba():
    code = (
        "import sys, numpy as np\n"
        "from analytic.designs.sampled_signals import evaluate_designs\n"
        "from analytic.description.loading import load\n"
        "from analytic.kinematics.mechanism import Mechanism\n"
        "sample = Mechanism(load('juki-mf7923d'))\n"
        "evaluate_designs(sample, {'crank.mass': np.ones(3)}, np.linspace(0.0, 6.0, 9), ['Jeq'])\n"
        "assert 'numba' not in sys.modules\n"
    )
    subprocess.run([sys.executable, "-W", "error", "-c", code], check=True)
