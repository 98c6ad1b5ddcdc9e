"""The scheme of every linkage there is: to scale, and with the symbols of its joints."""

import re
from functools import cache
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest

from analytic.description.loading import catalogue, load
from analytic.kinematics.mechanism import Mechanism
from comparisons.designer.building import positions_over_range
from reports.charts.moving import moving_scheme
from reports.charts.scheme import KinematicScheme, scheme_figure

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
    (axes,) = scheme_figure(scheme.linkage, scheme.positions).axes
    box = axes.get_window_extent()
    assert np.ptp(axes.get_xlim()) / box.width == pytest.approx(np.ptp(axes.get_ylim()) / box.height)
    low, high = scheme.extent
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


# A moving scheme's rules carry every pin, spring and cylinder to where the closed form has it.


NAMES = ("slotted-takeup", "spring-and-damper.toml", "drives/boom.toml")
NUMBER = r"(-?[\d.]+)"


def linkage(name):
    return load(str(LINKAGES / name) if name.endswith(".toml") else name)


@pytest.fixture(scope="module", params=NAMES)
def moving(request):
    mechanism = Mechanism(linkage(request.param))
    positions = positions_over_range(mechanism)
    markup = str(moving_scheme(mechanism.linkage, positions, "key"))
    return KinematicScheme(mechanism.linkage, positions), ElementTree.fromstring(markup), markup


def carried(text, number, place):
    """Where the rules of one part carry a place of the drawing, by the share of the motion."""
    rule = re.search(rf"#key \.key-{number}{{transform-origin:{NUMBER}px {NUMBER}px", text)
    origin = np.array([float(one) for one in rule.groups()])
    body = re.search(rf"@keyframes key-{number}{{(.*?)}}}}", text)[1]
    found = {}
    for share, rule in re.findall(r"([\d.]+)%{transform:([^}]*)", body):
        a, b, c, d, x, y = map(float, re.match(r"matrix\((.*)\)", rule)[1].split(","))
        found[float(share) / 100.0] = np.array([x, y]) + origin + np.array([[a, c], [b, d]]) @ (place - origin)
    return found


def points(scheme, places):
    """Places of the scheme on the drawing, by its rim and its size."""
    low, high = scheme.extent
    scale = min((330 - 36) / (high - low)[0], (300 - 36) / max((high - low)[1], 1e-9))
    return (np.asarray(places) - [low[0], high[1]]) * [scale, -scale] + 18.0


def test_every_point_of_every_body_is_carried_along_its_path(moving):
    scheme, _, text = moving
    for number, (name, link) in enumerate(scheme.linkage.links.items()):
        for point, local in link.points.items():
            path = points(scheme, scheme.path(name, [local])[0].T)
            for share, place in carried(text, number, points(scheme, scheme.spots[point])).items():
                np.testing.assert_allclose(place, path[round(share * (len(path) - 1))], atol=0.3)


def test_springs_and_cylinders_stay_between_their_ends(moving):
    scheme, _, text = moving
    for number, ends in enumerate(scheme.stretches.values(), start=len(scheme.linkage.links)):
        for end, path in zip(scheme.at(ends), ends, strict=True):
            track = points(scheme, path.T)
            for share, place in carried(text, number, points(scheme, end)).items():
                np.testing.assert_allclose(place, track[round(share * (len(track) - 1))], atol=0.5)
