"""Trust in engines: the plane in which failures show, errors with their limit, runs without a result."""

import numpy as np
import pytest

from reports.charts import draw
from reports.designs.trust_picture import BEYOND, NOTHING, SIGNS, WITHIN, Trial, telling, trust_figure

NAMES = ("rod.B.x, mm", "links.coupler_upper.centre.y, mm", "crank.mass, kg")


def trials(count=60):
    """Errors grow with the third parameter, and above 0.9 of the second there is no result."""
    found = []
    for values in np.random.default_rng(0).uniform(size=(count, 3)):
        error = 10.0 ** (-8.0 + 6.0 * values[2])
        verdict = NOTHING if values[1] > 0.9 else WITHIN if error < 1e-5 else BEYOND
        found.append(Trial(tuple(values), np.nan if verdict == NOTHING else error, verdict))
    return found


def words(axes):
    return [text.get_text() for text in axes.texts]


def dots(axes):
    """Points by their marker."""
    return {line.get_marker(): line.get_xydata() for line in axes.lines if line.get_marker() in {"o", "s", "X"}}


def test_the_plane_is_that_of_the_parameters_that_tell_failures_best():
    mine = trials()
    values = np.array([trial.parameters for trial in mine])
    errors = np.array([trial.error for trial in mine])
    assert telling(values, errors, values[:, 1] > 0.9)[0] == 1
    assert telling(values, errors, np.isin(np.arange(60), np.flatnonzero(errors > 1e-5)))[0] == 2
    assert telling(values, 10.0 ** values[:, 0], np.zeros(60, dtype=bool))[0] == 0


def test_every_design_is_drawn_once_in_both_panels_with_its_verdict():
    mine = trials()
    plane, errors, head = trust_figure({"exudyn": mine}, NAMES, 1e-5, "Trust").axes
    counts = {verdict: sum(trial.verdict == verdict for trial in mine) for verdict in SIGNS}
    for axes in (plane, errors):
        assert {verdict: len(dots(axes)[marker]) for verdict, (marker, _) in SIGNS.items()} == counts
    assert "crank.mass, kg" in words(plane)
    assert any("60 within limits" in " ".join(word.split()) for word in words(plane))
    assert {WITHIN, BEYOND, f"{NOTHING} (above all errors)", "limit", "Trust"} <= set(words(head))
    assert errors.get_yscale() == "log"
    assert np.max(dots(errors)["o"][:, 1]) < 1e-5 < np.min(dots(errors)["s"][:, 1])
    assert np.min(dots(errors)["X"][:, 1]) > np.max(dots(errors)["s"][:, 1])
    assert any(list(line.get_ydata()) == [1e-5, 1e-5] for line in errors.lines)


def test_engines_have_two_panels_each_and_one_of_one_parameter():
    mine = trials()
    both = trust_figure(dict.fromkeys(("exudyn", "pymunk", "simbody"), mine), NAMES, None)
    assert len(both.axes) == 2 * 3 + 1
    alone = [trial._replace(parameters=trial.parameters[:1]) for trial in mine]
    assert len(trust_figure({"exudyn": alone}, NAMES[:1], 1e-5).axes) == 1 + 1


@pytest.mark.parametrize("mine", [[], [Trial((1.0, 2.0), np.nan, NOTHING)], [Trial((1.0, 2.0), 0.0, WITHIN)] * 3])
def test_few_trials_are_drawn(mine):
    assert draw.svg(trust_figure({"exudyn": mine}, NAMES[:2], 1e-5), page="white")
