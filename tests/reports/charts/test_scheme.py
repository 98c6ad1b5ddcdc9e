"""The scheme of every linkage there is: to scale, and with the symbols of its joints."""

from functools import cache
from pathlib import Path

import numpy as np
import pytest

from analytic.description.loading import catalogue, load
from analytic.kinematics.mechanism import Mechanism
from comparisons.designer.building import positions_over_range
from reports.charts.scheme import KinematicScheme, card_figure, scheme_figure

LINKAGES = Path(__file__).parents[2] / "linkages"
EACH_KIND = ("slotted-takeup", str(LINKAGES / "spring-and-damper.toml"), str(LINKAGES / "drives" / "boom.toml"))
OTHERS = {*catalogue(), *map(str, LINKAGES.rglob("*.toml"))} - {*EACH_KIND}
NIGHTLY = [pytest.param(name, marks=pytest.mark.nightly) for name in sorted(OTHERS)]


@cache
def scheme_of(name):
    mechanism = Mechanism(load(name))
    return KinematicScheme(mechanism.linkage, positions_over_range(mechanism))


@pytest.mark.parametrize("name", [*EACH_KIND, *NIGHTLY])
def test_every_linkage_can_be_drawn_to_scale(name):
    scheme = scheme_of(name)
    low, high = scheme.extent
    for draw in (card_figure, scheme_figure):
        (axes,) = draw(scheme.linkage, scheme.positions).axes
        box = axes.get_window_extent()
        assert np.ptp(axes.get_xlim()) / box.width == pytest.approx(np.ptp(axes.get_ylim()) / box.height)
        assert np.all(low > [axes.get_xlim()[0], axes.get_ylim()[0]])
        assert np.all(high < [axes.get_xlim()[1], axes.get_ylim()[1]])
    linkage = scheme.linkage
    names = {point for link in linkage.links.values() for point in link.points} | set(linkage.ground)
    assert names <= {text.get_text() for text in axes.texts}
    assert all(text.get_fontsize() * 96.0 / 72.0 >= 12.0 for text in axes.texts)


def test_places_are_those_of_the_closed_form_in_the_files_unit():
    mechanism = Mechanism(load("slotted-takeup"))
    scheme = scheme_of("slotted-takeup")
    sweep = mechanism.sweep(scheme.positions.axis)
    for point, path in scheme.paths.items():
        for ours, theirs in zip(path, sweep.point(point), strict=True):
            np.testing.assert_allclose(ours, 1e3 * np.broadcast_to(theirs, sweep.angle.shape), atol=1e-9)
