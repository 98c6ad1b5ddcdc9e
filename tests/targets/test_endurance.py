"""A campaign killed and resumed is the campaign that nobody killed, and whoever counts the losses can count."""

import sys
from dataclasses import replace

import numpy as np
import pytest

from comparisons.campaign.results import Results, load
from tests.targets import endurance
from tests.targets.endurance import compared, run_campaign


@pytest.fixture(scope="module")
def results(tmp_path_factory):
    folder = tmp_path_factory.mktemp("campaign")
    run_campaign(folder, 0)
    return load(folder)


def changed(results, *runs):
    return Results(results.document, runs)


@pytest.mark.nightly
@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="forks, and reads /proc")
def test_kills_at_random_moments_lose_and_double_nothing():
    found = endurance.measure(8, seed=7)
    assert found.kills == 8
    assert sum(found.stages.values()) == 8
    assert (found.lost, found.doubled, found.survivors, found.litter) == (0, 0, 0, 0)


def test_two_campaigns_differ_in_their_timings_alone(results, tmp_path):
    run_campaign(tmp_path, 2)
    again = load(tmp_path)
    assert compared(results, again) == (0, 0)
    assert [r.seconds for r in again.records] != [r.seconds for r in results.records]


def test_a_lost_a_doubled_and_a_changed_record_are_counted(results):
    first, *others = results.runs
    every = len(first.every) + len(first.curves)
    assert compared(results, changed(results, *others)) == (every, 0)
    assert compared(results, changed(results, first, first, *others)) == (0, every)
    assert compared(results, changed(results, replace(first, engine="nobody"), *others)) == (every, every)
    other = replace(first.errors[0], samples=-1)
    assert compared(results, changed(results, replace(first, errors=(other, *first.errors[1:])), *others)) == (1, 0)


def test_a_curve_off_by_its_last_bit_is_counted(results):
    first, *others = results.runs
    curves = {name: np.array(curve) for name, curve in first.curves.items()}
    curve = next(iter(curves.values()))
    curve[2, 0] = np.nextafter(curve[2, 0], np.inf)
    assert compared(results, changed(results, replace(first, curves=curves), *others)) == (1, 0)
