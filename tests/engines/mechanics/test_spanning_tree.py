"""The tree of a scene: each body once and after its parent, each joint once, and no slider cut but where it must be."""

import cmath

import pytest

from analytic.description.crank_motion import crank_motion
from analytic.description.linkage import GROUND
from comparisons.case import scene
from engines.mechanics.spanning_tree import slots_as_blocks, spanning_tree
from engines.mechanics.start_check import start_misfit
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


def test_the_carrier_of_a_cut_is_the_nearest_body_that_carries_both_ends():
    pins = [("crank", GROUND), ("rocker", GROUND), ("crank", "coupler"), ("rocker", "coupler")]
    dyad = [("crank", "left"), ("coupler", "right"), ("left", "right")]
    tree = spanning_tree(_scene(["crank", "coupler", "rocker", "left", "right"], pins + dyad))
    carriers = {cut.name: tree.carrier(cut) for cut in tree.cuts}
    assert carriers == {"rocker-coupler": GROUND, "left-right": "crank"}


@pytest.mark.parametrize(("name", "variant"), FULL_TURN)
def test_positions_and_speeds_of_the_start_follow_from_the_coordinates_of_the_branches(name, variant):
    """A body is where its parent's point is, moved along the line or turned about the pin; likewise its velocity."""
    given = scene(mechanism(name, variant), Prescribed(crank_motion("constant-speed", start_angle=0.4)), frozenset())
    spin = {GROUND: 0.0, **{body.name: body.angular_velocity for body in given.bodies}}
    frame = {GROUND: (0j, 0j, 0.0)} | {
        body.name: (complex(*body.position), complex(*body.velocity), body.angle) for body in given.bodies
    }
    for branch in spanning_tree(given).branches:
        on_parent, on_body = (complex(*point) for point in branch.points)
        place, velocity, angle = frame[branch.parent]
        turning = spin[branch.parent]
        slides = isinstance(branch.joint, SliderJoint)
        line = cmath.exp(1j * (angle + branch.tilts[0])) if slides else 0.0
        arm = on_parent * cmath.exp(1j * angle)
        end = place + arm + branch.value * line
        drift = velocity + 1j * turning * (arm + branch.value * line) + branch.speed * line
        own = angle + (branch.tilts[0] - branch.tilts[1] if slides else branch.value)
        spin[branch.body.name] = turning + (0.0 if slides or branch.rigid else branch.speed)
        lever = on_body * cmath.exp(1j * own)
        assert end - lever == pytest.approx(complex(*branch.body.position), abs=1e-12)
        rate = drift - 1j * spin[branch.body.name] * lever
        assert rate == pytest.approx(complex(*branch.body.velocity), abs=1e-9)
        assert cmath.exp(1j * own) == pytest.approx(cmath.exp(1j * branch.body.angle), abs=1e-12)


@pytest.mark.parametrize("name", ["moving-guides", "ground-pin-in-slot", "slotted-takeup", "shaper"])
def test_blocks_move_with_their_slots_and_leave_pins_alone_to_be_cut(name):
    given = scene(mechanism(name), Prescribed(crank_motion("constant-speed", start_angle=0.4)), frozenset())
    blocked = slots_as_blocks(given, 1e-9)
    assert start_misfit(blocked) is None
    assert not blocked.slots
    assert {pin.name for pin in blocked.pins} >= {slot.name for slot in given.slots}
    assert all(isinstance(cut, PinJoint) for cut in spanning_tree(blocked).cuts)


def test_a_body_on_a_slider_turns_with_what_carries_it():
    tree = spanning_tree(_scene(["crank", "sleeve"], [("crank", GROUND)], [("sleeve", "crank")]))
    assert (tree.hinges("crank"), tree.hinges("sleeve"), tree.hinges(GROUND)) == ({"crank"}, {"crank"}, set())
