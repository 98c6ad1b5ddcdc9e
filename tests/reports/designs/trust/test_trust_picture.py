"""Trust in engines: the plane in which failures show, errors with their limit, runs without a result."""

import numpy as np
import pytest

from analytic.description.loading import load
from comparisons.datasheet.units import FileUnit
from comparisons.designs.parameters import Parameter
from comparisons.designs.trust.sample import DesignSample, SampledDesign
from comparisons.designs.trust.trust import DesignRun, DesignStanding, EngineTrust, SpaceTrust
from reports.charts import draw
from reports.designs.trust.trust_picture import SIGNS, trust_figure, trust_svg

NAMES = ("rod.B.x", "links.coupler_upper.centre.y", "crank.mass")
LINKAGE = load("rimoldi-164")


def trust(count=60, parameters=3, engines=("exudyn",), transmission=np.nan):
    """Errors grow with the last parameter, and above 0.9 of the first there is no result."""
    values = np.random.default_rng(0).uniform(size=(count, parameters))
    designs = tuple(
        SampledDesign(n, LINKAGE, tuple(row.tolist()), transmission * row[0]) for n, row in enumerate(values, 1)
    )
    runs = []
    for number, row in enumerate(values, 1):
        share = 10.0 ** (6.0 * row[-1] - 4.0)
        standing = (
            DesignStanding.NO_RESULT if row[0] > 0.9 else DesignStanding.WITHIN if share <= 1.0 else DesignStanding.OVER
        )
        runs.append(DesignRun(number, standing, share))
    told = tuple(Parameter(name, "length", 0.0, FileUnit("mm", 1e-3)) for name in NAMES[:parameters])
    sample = DesignSample(told, designs, 0)
    return SpaceTrust(sample, tuple(EngineTrust(name, "tuned", tuple(runs), None, None) for name in engines))


def words(axes):
    return [" ".join(text.get_text().split()) for text in axes.texts]


def dots(axes):
    """Points by their marker."""
    return {line.get_marker(): line.get_xydata() for line in axes.lines if line.get_marker() in {"o", "s", "X", "d"}}


def test_every_design_is_drawn_once_in_both_panels_with_its_standing():
    made_up = trust()
    plane, errors, head = trust_figure(made_up, "Trust").axes
    for axes in (plane, errors):
        counts = {standing: len(dots(axes)[marker]) for standing, (marker, _) in SIGNS.items()}
        assert counts == {standing: made_up.engines[0].count(standing) for standing in SIGNS}
    assert {"rod.B.x, mm", "crank.mass, mm"} <= set(words(plane))  # the two that errors come from
    within = made_up.engines[0].count(DesignStanding.WITHIN)
    assert f"exudyn tuned: {within} of 60 within limits" in words(plane)
    assert {"within limits", "over a limit", "no result (above all errors)", "limit", "Trust"} <= set(words(head))
    assert "not judged" not in words(head)
    assert errors.get_yscale() == "log"
    assert np.max(dots(errors)["o"][:, 1]) <= 1.0 < np.min(dots(errors)["s"][:, 1])
    assert np.min(dots(errors)["X"][:, 1]) > np.max(dots(errors)["s"][:, 1])
    assert any(list(line.get_ydata()) == [1.0, 1.0] for line in errors.lines)


def test_the_transmission_angle_is_a_feature_too():
    (errors, _) = trust_figure(trust(parameters=1)).axes
    assert "rod.B.x, mm" in words(errors)
    plane, _, _ = trust_figure(trust(parameters=1, transmission=90.0)).axes
    assert {"rod.B.x, mm", "least transmission angle, deg"} <= set(words(plane))


def test_where_none_fails_the_errors_say_which_features_tell():
    made_up = trust()
    runs = tuple(DesignRun(run.design, DesignStanding.WITHIN, run.share) for run in made_up.engines[0].runs)
    plane, *_ = trust_figure(SpaceTrust(made_up.sample, (EngineTrust("exudyn", "tuned", runs, None, None),))).axes
    assert words(plane).index("crank.mass, mm") == min(
        words(plane).index(word) for word in words(plane) if ", mm" in word
    )


def test_engines_have_two_panels_each():
    assert len(trust_figure(trust(engines=("exudyn", "pymunk", "simbody"))).axes) == 2 * 3 + 1


@pytest.mark.parametrize("standing", list(DesignStanding))
def test_a_single_design_is_drawn_whatever_became_of_it(standing):
    made_up = trust(count=1)
    engine = EngineTrust("exudyn", "tuned", (DesignRun(1, standing),), None, None)
    assert draw.svg(trust_figure(SpaceTrust(made_up.sample, (engine,))))
    assert trust_svg(SpaceTrust(made_up.sample, ()))
