"""Result files read as signals."""

import numpy as np

from analytic.description.loading import load
from comparisons.imported.reading import read_results
from tests.comparisons.imported.layouts import Channel, csv


def test_a_plain_table_becomes_signals_in_si_units(tmp_path):
    file = tmp_path / "torque.csv"
    time = np.linspace(0.0, 1.0, 5)
    file.write_text(csv([Channel("time", "s", time), Channel("Mkr", "N*mm", 1e3 * np.cos(time))], digits=17))
    results = read_results([file], load("juki-mf7923d"), None)
    (signal,) = results.signals
    assert (signal.name, signal.axis) == ("Mkr", "time")
    np.testing.assert_allclose(signal.at, time)
    np.testing.assert_allclose(signal.values, np.cos(time))
