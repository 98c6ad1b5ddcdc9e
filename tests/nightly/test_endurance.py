"""A campaign killed and resumed is the same as one without kills, and losses are counted right."""

import sys
from dataclasses import replace

import numpy as np
import pytest

from comparisons.campaign.results import load
from tests.nightly import endurance
from tests.nightly.endurance import losses, run_campaign


@pytest.fixture(scope="module")
def results(tmp_path_factory):
    folder = tmp_path_factory.mktemp("campaign")
    run_campaign(folder, 0)
    return load(folder).runs


@pytest.mark.nightly
@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="forks, and reads /proc")
def test_kills_at_random_moments_lose_and_double_nothing():
    result = endurance.measure(8, seed=7)
    assert result.kills == 8
    assert sum(result.stages.values()) == 8
    assert (result.lost, result.doubled, result.survivors, result.litter) == (0, 0, 0, 0)


def test_two_campaigns_differ_in_their_timings_alone(results, tmp_path):
    run_campaign(tmp_path, 2)
    again = load(tmp_path).runs
    assert losses(results, again) == (0, 0)
    assert [r.seconds for run in again for r in run.records] != [r.seconds for run in results for r in run.records]


def test_a_lost_a_doubled_and_a_changed_record_are_counted(results):
    first, *others = results
    every = len(first.every) + len(first.curves)
    assert losses(results, others) == (every, 0)
    assert losses(results, [first, first, *others]) == (0, every)
    assert losses(results, [replace(first, engine="nobody"), *others]) == (every, every)
    other = replace(first.errors[0], samples=-1)
    assert losses(results, [replace(first, errors=(other, *first.errors[1:])), *others]) == (1, 0)


def test_a_curve_off_by_its_last_bit_is_counted(results):
    first, *others = results
    curves = {name: np.array(curve) for name, curve in first.curves.items()}
    curve = next(iter(curves.values()))
    curve[2, 0] = np.nextafter(curve[2, 0], np.inf)
    assert losses(results, [replace(first, curves=curves), *others]) == (1, 0)
