"""A moving scheme's rules carry every pin, spring and cylinder to where the closed form has it."""

import re
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest

from analytic.description.loading import load
from analytic.kinematics.mechanism import Mechanism
from comparisons.datasheet.positions import over_reach
from reports.charts.kinematic_scheme import KinematicScheme
from reports.charts.moving import moving_scheme

LINKAGES = Path(__file__).parents[2] / "linkages"
NAMES = ("juki-mf7923d", "slotted-takeup", "jansen-leg", "spring-and-damper.toml", "drives/boom.toml")
NUMBER = r"(-?[\d.]+)"


def linkage(name):
    return load(str(LINKAGES / name) if name.endswith(".toml") else name)


@pytest.fixture(scope="module", params=NAMES)
def moving(request):
    mechanism = Mechanism(linkage(request.param))
    positions = over_reach(mechanism)
    markup = str(moving_scheme(mechanism.linkage, positions, "key"))
    return KinematicScheme(mechanism.linkage, positions), ElementTree.fromstring(markup), markup


def turn(degrees):
    """The matrix of a rule's rotation, y down."""
    angle = np.radians(float(degrees))
    return np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])


def carried(text, number, place):
    """Where the rules of one part carry a place of the drawing, by the share of the motion."""
    rule = re.search(rf"#key \.key-{number}{{transform-origin:{NUMBER}px {NUMBER}px", text)
    origin = np.array([float(one) for one in rule.groups()])
    body = re.search(rf"@keyframes key-{number}{{(.*?)}}}}", text)[1]
    found = {}
    for share, rule in re.findall(r"([\d.]+)%{transform:([^}]*)", body):
        x, y = re.match(rf"translate\({NUMBER}px,{NUMBER}px\)", rule).groups()
        turns = [turn(one) for one in re.findall(rf"rotate\({NUMBER}deg\)", rule)]
        stretch = re.search(rf"scale\({NUMBER},1\)", rule)
        matrix = turns[0] if stretch is None else turns[0] @ turns[1] @ np.diag([float(stretch[1]), 1.0]) @ turns[2]
        found[float(share) / 100.0] = np.array([float(x), float(y)]) + origin + matrix @ (place - origin)
    return found


def pixels(scheme, places):
    """Places of the scheme on the drawing, by its rim and its size."""
    low, high = scheme.extent
    scale = min((440 - 48) / (high - low)[0], (400 - 48) / max((high - low)[1], 1e-9))
    return (np.asarray(places) - [low[0], high[1]]) * [scale, -scale] + 24.0


def test_every_point_of_every_body_is_carried_along_its_path(moving):
    scheme, _, text = moving
    for number, (name, link) in enumerate(scheme.linkage.links.items()):
        for point, local in link.points.items():
            path = pixels(scheme, scheme.path(name, [local])[0].T)
            for share, place in carried(text, number, pixels(scheme, scheme.spots[point])).items():
                np.testing.assert_allclose(place, path[round(share * (len(path) - 1))], atol=0.3)


def test_springs_and_cylinders_stay_between_their_ends(moving):
    scheme, _, text = moving
    for number, (name, ends) in enumerate(scheme.stretches.items(), start=len(scheme.linkage.links)):
        for end, path in zip(scheme.ends_shown(name), ends, strict=True):
            track = pixels(scheme, path.T)
            for share, place in carried(text, number, pixels(scheme, end)).items():
                np.testing.assert_allclose(place, track[round(share * (len(track) - 1))], atol=0.5)


def test_it_is_small_and_its_names_are_its_own(moving):
    scheme, root, text = moving
    assert len(list(root.iter())) < 100
    assert len(text) < 80_000
    assert {element.get("id") for element in root.iter()} == {"key", None}
    classes = {element.get("class") for element in root.iter()} - {None, "moving"}
    assert classes <= {f"key-{number}" for number in range(len(scheme.linkage.links) + len(scheme.stretches))}
    assert set(re.findall(r"animation-name:([^}]*)}", text)) >= classes
    assert "prefers-reduced-motion" in text


def test_what_reaches_an_end_of_its_range_goes_back_the_way_it_came(moving):
    scheme, _, text = moving
    assert ("infinite alternate" in text) is not scheme.positions.closed
