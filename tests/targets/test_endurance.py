"""A campaign killed and resumed is the campaign that nobody killed, and whoever counts the losses can count."""

import sys

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


def changed(results, name, rows):
    return Results({**results.document, name: rows}, results.curves)


@pytest.mark.slow
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
    rows = results.document["records"]
    assert compared(results, changed(results, "records", rows[3:])) == (3, 0)
    assert compared(results, changed(results, "records", rows + rows[:2])) == (0, 2)
    assert compared(results, changed(results, "records", [{**rows[0], "samples": -1}, *rows[1:]])) == (1, 0)
    assert compared(results, changed(results, "records", [{**rows[0], "engine": "nobody"}, *rows[1:]])) == (1, 1)


def test_a_curve_off_by_its_last_bit_is_counted(results):
    curves = results.curves.copy(deep=True)
    curves["observed"].values[0] = np.nextafter(curves["observed"].values[0], np.inf)
    assert compared(results, Results(results.document, curves)) == (1, 0)
