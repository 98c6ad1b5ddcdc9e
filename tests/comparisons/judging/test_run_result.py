"""A run's result survives as bytes, to the last bit."""

import dataclasses

import numpy as np
from comparisons.judging.run_result import ARRAYS, RunResult, from_bytes, to_bytes
from hypothesis import given
from hypothesis import strategies as st

from comparisons.judging.deviations import Deviation
from comparisons.judging.records import Record

floats = st.floats(allow_nan=False)
perhaps = st.none() | floats
texts = st.text(max_size=20)
FIELDS = {"str": texts, "float": floats, "float | None": perhaps, "int": st.integers()}
records = st.builds(Record, **{one.name: FIELDS[str(one.type)] for one in dataclasses.fields(Record)})


@st.composite
def deviations(draw):
    count = draw(st.integers(0, 5))
    arrays = {name: np.array(draw(st.lists(st.floats(), min_size=count, max_size=count))) for name in ARRAYS}
    numbers = [draw(floats) for _ in range(4)]
    return Deviation(**arrays, peak=numbers[0], error_max=numbers[1], error_rms=numbers[2], worst_time=numbers[3],
                     samples=draw(st.integers()), left_out=draw(st.integers()))  # fmt: skip


results = st.builds(
    RunResult,
    records=st.lists(records, max_size=3).map(tuple),
    invariants=st.lists(records, max_size=3).map(tuple),
    deviations=st.dictionaries(texts, deviations(), max_size=3),
    details=st.dictionaries(texts, texts | st.integers() | floats, max_size=3),
)


@given(results)
def test_a_result_comes_back_to_the_last_bit(result):
    back = from_bytes(to_bytes(result))
    # repr tells -0.0 from 0.0 and 1 from 1.0, which == does not
    assert repr(back.records) == repr(result.records)
    assert repr(back.invariants) == repr(result.invariants)
    assert repr(back.details) == repr(result.details)
    assert list(back.deviations) == list(result.deviations)
    for name, found in result.deviations.items():
        for one in dataclasses.fields(Deviation):
            then, now = getattr(found, one.name), getattr(back.deviations[name], one.name)
            assert then.tobytes() == now.tobytes() if one.name in ARRAYS else repr(then) == repr(now)
