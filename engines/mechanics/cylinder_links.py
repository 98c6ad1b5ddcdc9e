"""A cylinder as a barrel and a rod, for engines that prescribe a joint's coordinate and no distance of two points."""

from __future__ import annotations

import math
from dataclasses import replace

from analytic.description.linkage import GROUND
from engines.mechanics.driver import Driver
from engines.mechanics.joints import scene_size
from engines.mechanics.states import pose_of, start_motion
from engines.scene import Body, Cylinder, PinJoint, Scene, SliderJoint

BARREL, ROD = "/barrel", "/rod"  # names that no body and no joint of a scene has


def cylinder_as_links(scene: Scene, mass: float) -> Scene:
    """The scene with a cylinder's barrel on its second end and its rod, the new ``crank``, on its first.

    Each has the given mass at its pin, and turns; the slider ROD between them has the cylinder's length as its travel.
    A scene without a cylinder comes back as it is.
    """
    ends = scene.cylinder
    if ends is None:
        return scene
    if (
        ends.first == GROUND
    ):  # length and force are the same from either end, and the rod is to be carried by the barrel
        ends = Cylinder(ends.second, ends.first, ends.second_anchor, ends.first_anchor)
        return cylinder_as_links(replace(scene, cylinder=ends), mass)
    position, rate, _ = start_motion(scene)
    driver, pose = Driver(scene), pose_of(position)
    span = driver.span(pose)
    assert span is not None
    (first, second), (x, y) = driver.ends, span.along[0].tolist()
    rates = [
        (float(rate[0, n, 0] - rate[0, n, 2] * arm[0, 1]), float(rate[0, n, 1] + rate[0, n, 2] * arm[0, 0]))
        for n, arm in ((first, span.first), (second, span.second))
    ]
    places = [pose.place[0, n] + arm[0] for n, arm in ((first, span.first), (second, span.second))]
    moved = rates[0][0] - rates[1][0], rates[0][1] - rates[1][1]
    turning, inertia = (x * moved[1] - y * moved[0]) / float(span.length[0]), mass * scene_size(scene) ** 2
    rod, barrel = (
        Body(name, mass, inertia, (float(at[0]), float(at[1])), math.atan2(y, x), speed, turning, (0.0, 0.0), 0.0)
        for name, at, speed in zip((ROD, BARREL), places, rates, strict=True)
    )
    return replace(
        scene,
        crank=ROD,
        cylinder=None,
        bodies=(*scene.bodies, barrel, rod),
        pins=(
            *scene.pins,
            PinJoint(BARREL, BARREL, ends.second, (0.0, 0.0), ends.second_anchor),
            PinJoint(f"{ROD}'s pin", ROD, ends.first, (0.0, 0.0), ends.first_anchor),
        ),
        sliders=(*scene.sliders, SliderJoint(ROD, ROD, (0.0, 0.0), BARREL, (0.0, 0.0), (1.0, 0.0))),
    )
