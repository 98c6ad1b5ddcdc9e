"""The tree of a scene: each body once and after its parent, each joint once, and no slider cut but where it must be."""

import pytest

from analytic.description.crank_motion import crank_motion
from analytic.description.linkage import GROUND
from comparisons.reference.start_state import scene
from engines.mechanics.spanning_tree import spanning_tree
from engines.scene import Body, PinJoint, Prescribed, Scene, SliderJoint
from tests.analytic.linkages import FULL_TURN, mechanism


def _scene(bodies, pins=(), sliders=()):
    rest = {"position": (0, 0), "angle": 0, "velocity": (0, 0), "angular_velocity": 0}
    rest |= {"acceleration": (0, 0), "angular_acceleration": 0}
    return Scene(
        crank="crank",
        bodies=tuple(Body(name, 1.0, 1.0, **rest) for name in bodies),
        pins=tuple(PinJoint(f"{first}-{second}", first, second, (0, 0), (0, 0)) for first, second in pins),
        sliders=tuple(SliderJoint(f"{body}-{host}", body, (0, 0), host, (0, 0), (1, 0)) for body, host in sliders),
        slots=(),
        gravity=(0, 0),
        drive=Prescribed(crank_motion()),
        channels=frozenset(),
    )


@pytest.mark.parametrize(("name", "variant"), FULL_TURN)
def test_every_body_comes_once_after_its_parent_and_every_joint_once(name, variant):
    given = scene(mechanism(name, variant), Prescribed(crank_motion()), frozenset())
    tree = spanning_tree(given)
    reached = [GROUND]
    for branch in tree.branches:
        assert branch.parent in reached
        reached.append(branch.body.name)
        ends = [getattr(branch.joint, end) for end in ("first", "second", "body", "host") if hasattr(branch.joint, end)]
        assert ends == ([branch.parent, branch.body.name] if branch.reverse else [branch.body.name, branch.parent])
    assert sorted(reached) == sorted([GROUND, *(body.name for body in given.bodies)])
    joints = [*(branch.joint.name for branch in tree.branches), *(cut.name for cut in tree.cuts)]
    assert sorted(joints) == sorted(joint.name for joint in (*given.pins, *given.guided))
    assert (tree.branches[0].body.name, tree.branches[0].parent) == (given.crank, GROUND)
    assert not any(isinstance(cut, SliderJoint) for cut in tree.cuts)


def test_a_slider_between_two_bodies_that_pins_reach_first_is_in_the_tree():
    pins = [("crank", GROUND), ("rocker", GROUND), ("crank", "coupler"), ("rocker", "coupler")]
    dyad = [("crank", "rod"), ("rocker", "sleeve")]
    tree = spanning_tree(_scene(["crank", "coupler", "rocker", "rod", "sleeve"], pins + dyad, [("sleeve", "rod")]))
    assert "sleeve-rod" not in [cut.name for cut in tree.cuts]
    assert len(tree.cuts) == 2


def test_a_slider_is_cut_where_sliders_alone_form_a_loop():
    sliders = [("left", GROUND), ("wedge", "left"), ("wedge", GROUND)]
    tree = spanning_tree(_scene(["crank", "left", "wedge"], [("crank", GROUND)], sliders))
    assert [type(cut) for cut in tree.cuts] == [SliderJoint]


def test_a_body_that_only_slots_hold_hangs_on_nothing():
    tree = spanning_tree(_scene(["crank", "loose", "arm"], [("crank", GROUND), ("arm", "loose")]))
    assert [(branch.body.name, branch.parent) for branch in tree.branches[1:]] == [("loose", GROUND), ("arm", "loose")]
    assert tree.branches[1].joint is None
