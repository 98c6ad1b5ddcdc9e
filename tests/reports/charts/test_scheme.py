"""The scheme of every linkage there is: to scale, and with the symbols of its joints."""

from pathlib import Path

import numpy as np
import pytest

from analytic.description.loading import catalogue, load
from analytic.kinematics.mechanism import Mechanism
from reports.charts import scheme, symbols
from reports.records.views import View

LINKAGES = sorted((Path(__file__).parents[2] / "linkages").glob("*.toml"))


@pytest.mark.parametrize("name", [*catalogue(), *map(str, LINKAGES)], ids=lambda name: Path(name).stem)
def test_every_linkage_can_be_drawn_to_scale(name):
    view = View(None, load(name))
    if not view.makes_full_turn:
        pytest.skip("the crank cannot make a full turn")
    figure = scheme.scheme_figure(view)
    (axes,) = figure.axes
    assert axes.get_aspect() == 1.0
    low, high = scheme.scheme_of(view.mechanism).extent
    assert np.all(low > [axes.get_xlim()[0], axes.get_ylim()[0]])
    assert np.all(high < [axes.get_xlim()[1], axes.get_ylim()[1]])
    names = {point for link in view.linkage.links.values() for point in link.points} | set(view.linkage.ground)
    assert names <= {text.get_text() for text in axes.texts}


def test_the_extent_is_that_of_the_crank_slider():
    low, high = scheme.scheme_of(Mechanism(load("juki-mf7923d"))).extent
    np.testing.assert_allclose(low, [-15.5, -70.0], atol=1e-9)
    np.testing.assert_allclose(high, [15.5, 15.5], atol=1e-9)


def test_a_guide_covers_the_travel_of_its_slider():
    found = scheme.scheme_of(Mechanism(load("juki-mf7923d")))
    slider = found.linkage.sliders[0]
    ends = np.array(found.travel(slider.guide, slider.link, slider.point))
    np.testing.assert_allclose(ends, [[0.0, -0.070], [0.0, -0.039]], atol=1e-12)


def test_outlines_are_hulls_and_straight_links_stay_straight():
    square = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0], [0.5, 0.5]])
    assert len(symbols.outline(square)) == 4
    straight = np.array([[0.0, 0.0], [0.3, 0.3], [1.0, 1.0]])
    np.testing.assert_array_equal(symbols.outline(straight), [[0.0, 0.0], [1.0, 1.0]])
