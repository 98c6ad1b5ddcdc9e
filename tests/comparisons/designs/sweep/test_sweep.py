"""A sweep is what a loop over its designs, one by one, makes of them."""

import itertools
import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from analytic.designs.results import design_figures
from analytic.kinematics.mechanism import Mechanism
from comparisons.designs.sweep import sweep as sweeps
from comparisons.designs.sweep.sweep import Blocks, RankedDesign, Summary, own_figures, sweep, usual_figures, why_not
from comparisons.runs.workers import LocalPool
from tests.comparisons.designs.sweeps import SIX_BAR, grid, request


@given(st.integers(1, 40), st.integers(1, 40), st.integers(1, 100))
def test_blocks_follow_each_other_and_are_whole_slabs_or_parts_of_one(slabs, slab, size):
    blocks = list(Blocks(slabs * slab, slab, size))
    assert [number for first, last in blocks for number in range(first, last)] == list(range(slabs * slab))
    for first, last in blocks:
        assert 0 < last - first <= max(size, slab)
        assert (first % slab == 0 == last % slab) or (first // slab == (last - 1) // slab and last - first <= size)


def looped(asked):
    """Every design on its own, (figures, designs), file's units."""
    mechanism, found = Mechanism(SIX_BAR), []
    for number in range(asked.space.count):
        values = asked.space.block(number, number + 1)
        found.append(
            design_figures(
                mechanism, values, [one.figure for one in asked.figures], asked.motion.places,
                speed=asked.motion.speed, path="numpy",
            )[:, 0] / [one.unit.size for one in asked.figures]
        )  # fmt: skip
    return np.array(found).T


@pytest.mark.parametrize("pool", [None, LocalPool(2)])
def test_figures_and_their_ends_are_those_of_a_loop(monkeypatch, pool):
    monkeypatch.setattr(sweeps, "PLACES", 8 * 7)
    asked = request()
    found = np.full((3, 30), np.nan)

    def keep(number, first, values, summary):
        assert (first, first + values.shape[1]) == asked.blocks[number]
        assert summary == Summary.decoded(summary.encoded())
        found[:, first : first + values.shape[1]] = values

    heard = []
    summary = sweep(asked, keep=keep, announce=heard.append, pool=pool)
    truth = looped(asked)
    np.testing.assert_allclose(found, truth, rtol=1e-12)
    there = ~np.isnan(truth[0])
    assert 0 < summary.assembled == np.count_nonzero(there) < summary.designs == 30 == heard[-1]
    assert heard == sorted(heard)
    shown = np.array(list(itertools.product(range(160, 181, 5), (0.1, 0.15, 0.2), (50.0, 60.0)))).T
    np.testing.assert_allclose(
        summary.reach, np.stack([shown[:, there].min(axis=1), shown[:, there].max(axis=1)], axis=1), rtol=1e-14
    )
    ranks = (np.abs(found[0]), np.abs(found[1] - 90.0), found[2])
    for row, rank, least, largest in zip(found, ranks, summary.least, summary.largest, strict=True):
        assert (least.design, largest.design) == (np.nanargmin(rank), np.nanargmax(rank))
        assert (least.value, largest.value) == (row[least.design], row[largest.design])


def test_what_is_done_is_not_made_again(monkeypatch):
    monkeypatch.setattr(sweeps, "PLACES", 8 * 7)
    asked, parts = request(), {}
    whole = sweep(asked, keep=lambda number, first, values, summary: parts.setdefault(number, summary))
    made = []
    done = [number for number in parts if number % 2]
    begun = parts[done[1]].plus(parts[done[0]])
    rest = [*done[:2]]
    again = sweep(asked, done=rest, begun=begun, keep=lambda number, *_: made.append(number))
    assert again == whole
    assert sorted(made + rest) == sorted(parts)


@given(st.permutations(range(6)), st.lists(st.sampled_from([1.0, 2.0, math.nan]), min_size=6, max_size=6))
def test_summaries_add_up_in_any_order(order, values):
    def one(number):
        value = values[number]
        if math.isnan(value):
            return Summary(1)
        least, largest = RankedDesign(value, number, value), RankedDesign(-value, number, value)
        return Summary(1, 1, (least,), (largest,), ((value, value),))

    total = Summary()
    for number in order:
        total = total.plus(one(number))
    assert total.designs == 6
    there = [value for value in values if not math.isnan(value)]
    assert total.assembled == len(there)
    if there:
        assert total.least[0].design == values.index(min(there))
        assert total.largest[0].design == values.index(max(there))
        assert total.reach == ((min(there), max(there)),)


def test_the_own_design_is_that_of_the_file():
    asked = request()
    own = grid("rod.B.x=175:175:1")
    np.testing.assert_allclose(own_figures(asked), looped(request(own))[:, 0], rtol=1e-14)


def test_a_design_that_does_not_assemble_says_where():
    assert "cannot be assembled" in why_not(request(grid("rod.B.x=100:110:2")))
    assert "stands in a dead position between two" in why_not(request(grid("rod.B.x=166.4:166.41:2")))
    assert not why_not(request(grid("rod.B.x=175:180:2")))


def test_what_is_asked_of_designs_where_nobody_says():
    names = [one.name for one in usual_figures(Mechanism(SIX_BAR))]
    assert names[0] == "Mkr.peak"
    assert names[-1] == "stroke"
    assert {name.partition(":")[0] for name in names[1:-1]} == {"joint_force", "transmission_angle"}
