"""Lists printed in JavaScript: NumPy's numbers, for every linkage that has a list, whatever its numbers."""

import json
from contextlib import suppress

import numpy as np
import pytest

from analytic.description.changes import design_numbers, with_numbers
from analytic.description.loading import catalogue, literature
from analytic.errors import LinkproofError
from analytic.evaluation import evaluate
from analytic.machine_code.compiling import javascript_source
from analytic.machine_code.tracing import is_traceable, linkage_trace
from analytic.signals import names, unit
from tests.analytic.linkages import MADE_UP, from_text, mechanism, text_of
from tests.analytic.machine_code.test_compiling import every_operation
from tests.javascript import called

SAME = 1e-13  # of the peak
CHANGES, SHARE, SPEED, ACCELERATION = 6, 0.02, 30.0, 400.0
ANGLES = np.linspace(-2.0, 9.0, 40)
CALL = """({designs, rows, count, results}) => designs.map((given) => {
  const found = new Float64Array(results * count);
  FUNCTION(given, Float64Array.from(rows), found, count);
  return [...found].map(one => Number.isFinite(one) ? one : String(one));
})"""


def by_javascript(source, designs, rows, results):
    """Results (designs, results, count) of a printed function at rows (rows, count)."""
    arguments = {"designs": designs, "rows": rows.ravel().tolist(), "count": rows.shape[1], "results": results}
    result = called(CALL.replace("FUNCTION", f"({source})"), arguments)
    return np.array(result, dtype=float).reshape(len(designs), results, -1)


def test_every_operation():
    trace, numbers, rows, outputs = every_operation()
    x, y, row = 0.7, -2.5, np.array([-1.0, -0.0, 0.0, 0.7, 3.0])
    (result,) = by_javascript(javascript_source(trace, numbers, rows, outputs), [[x, y]], row[None], len(outputs))
    expected = trace.evaluate(outputs, dict(zip([*numbers, *rows], [x, y, row], strict=True)))
    for one, truth in zip(result, expected, strict=True):
        np.testing.assert_allclose(one, np.broadcast_to(truth, len(row)), rtol=1e-15, atol=0.0)


def test_a_source_has_no_names():
    hostile = "\\u2028'); fetch(`//x`); </script>"
    sample = from_text(text_of("centric-slider-crank").replace("coupler", json.dumps(hostile)))
    of = linkage_trace(sample, design_numbers(sample.linkage), names(sample))
    words = set(javascript_source(of.trace, sorted(of.trace.inputs.values()), (), of.lines))
    assert not words & set("\"'`\\</>") - {"<", ">", "/"}
    assert "fetch" not in javascript_source(of.trace, sorted(of.trace.inputs.values()), (), of.lines)


ORDINARY = ("moving-guides",)
OTHERS = [pytest.param(name, marks=pytest.mark.nightly) for name in (*catalogue(), *literature(), *MADE_UP)]


@pytest.mark.parametrize("name", [*ORDINARY, *OTHERS])
def test_signals_of_other_designs_are_numpy_s(name):
    sample = mechanism(name)
    if not is_traceable(sample) or sample.linkage.is_linear:
        return
    linkage, chosen, chance = sample.linkage, names(sample), np.random.default_rng(7)
    free = {number: value for number, (kind, value) in design_numbers(linkage).items() if kind != "direction"}
    listed = linkage_trace(sample, free, chosen, accelerates=True)
    given = {number: listed.trace.inputs[number] for number in free if number in listed.trace.inputs}
    rows = [line for one, line in listed.trace.inputs.items() if one not in given]
    source = javascript_source(listed.trace, [*given.values()], rows, listed.signals)
    reach = sample.crank_range()
    places = ANGLES if reach.is_full_turn else np.linspace(*np.array(reach.limits) @ [[0.8, 0.2], [0.2, 0.8]], 40)
    values = listed.values({}, places, SPEED, ACCELERATION)
    given_rows = np.array([np.broadcast_to(values[line], places.shape) for line in rows])
    designs, truths = [], []
    for _ in range(CHANGES):
        other = {number: float(value * chance.uniform(1.0 - SHARE, 1.0 + SHARE)) for number, value in free.items()}
        motion = {"speed": SPEED, "acceleration": ACCELERATION}
        with suppress(LinkproofError):  # a design that cannot turn as the file's does
            truths.append(evaluate(sample.redesigned(with_numbers(linkage, other)), places, chosen, **motion))
            designs.append([other[one] for one in given])
    assert designs
    for truth, result in zip(truths, by_javascript(source, designs, given_rows, len(chosen)), strict=True):
        scales: dict[tuple[str, str], float] = {}
        for signal in chosen:
            kind = (signal.partition(":")[0], unit(signal, linkage))
            scales[kind] = max(scales.get(kind, 1e-9), float(np.max(np.abs(truth[signal]))))
        for signal, one in zip(chosen, result, strict=True):
            expected, near = truth[signal], one
            if signal == "S":  # counts from the farthest place, which the list leaves to who knows the motion
                near = one + (expected[0] - one[0])
            elif signal.startswith("link:") and signal.endswith(":angle"):
                near = one + 2.0 * np.pi * np.round((expected - one) / (2.0 * np.pi))
            peak = scales[signal.partition(":")[0], unit(signal, linkage)]
            assert np.max(np.abs(near - expected)) <= SAME * peak, signal
