"""Groups of class III and higher: search, continuation, solution; against 50 digits and their own bounds."""

from pathlib import Path

import numpy as np
import pytest
from mpmath import mp, mpf

from analytic.description.linkage import GROUND
from analytic.description.loading import parse
from analytic.dynamics.reduced import drive_torque
from analytic.errors import AssemblyError, LinkproofError
from analytic.kinematics.decomposition import find_structure
from analytic.kinematics.error_bounds import ErrorBounds
from analytic.kinematics.group_solver import GroupSolver, Problem, follow_branch, newton
from analytic.kinematics.structure import Group, Revolute
from tests.analytic.fifty_digits import exact
from tests.analytic.linkages import driven, from_text, path_of
from tests.analytic.tolerances import FIFTY_DIGITS, ORACLE

SOLVED = ("boom", "cylinder-in-the-loop", "linear-motor", "pushed-slide", "ternary-on-rods")
TEXT = Path(path_of("ternary-on-rods")).read_text(encoding="utf-8")
BOOM = Path(path_of("boom")).read_text(encoding="utf-8")


@pytest.mark.parametrize("name", SOLVED)
def test_positions_derivatives_and_torque_are_those_of_50_digits_within_their_bound(name):
    model = driven(name)
    low, high = model.crank_range().limits
    for value in low + (high - low) * np.array([0.07, 0.93]):
        truth, sweep = exact(model, float(value)), model.sweep(float(value))
        bounds, errors, peaks = ErrorBounds(sweep), np.zeros(3), np.zeros(3)
        for body, link in model.linkage.links.items():
            for local in (*link.points.values(), link.centre):
                true = truth.point(body, local)
                for order in range(3):
                    got = sweep.local_point(body, local, order)
                    error = float(mp.hypot(*(mpf(float(g)) - t[order] for g, t in zip(got, true, strict=True))))
                    assert body == model.linkage.crank or error <= bounds.point(body, local, order)[0] + ORACLE
                    errors[order] = max(errors[order], error)
                    peaks[order] = max(peaks[order], float(mp.hypot(*(t[order] for t in true))))
        assert np.all(errors <= FIFTY_DIGITS * peaks)
        mkr = drive_torque(sweep, -3.0, 20.0)
        assert abs(mpf(float(mkr)) - truth.torque(-3.0, 20.0)) <= FIFTY_DIGITS * abs(float(mkr))


HEAD = TEXT[: TEXT.index("[links.crank]")]


def test_a_group_with_a_closed_contour_of_four_links_is_of_class_iv():
    links = {
        "crank": {"O1": (0, 0), "A": (16, 0)},
        "a": {"A": (0, 0), "B": (30, 0), "E": (10, 20)},
        "b": {"B": (0, 0), "C": (30, 0)},
        "c": {"C": (0, 0), "O2": (30, 0), "D": (10, 20)},
        "d": {"D": (0, 0), "E": (40, 0)},
    }
    text = HEAD.replace('output  = { point = "P", along = [0, 1] }', "")
    for name, places in links.items():
        points = ", ".join(f"{point} = {[*at]}" for point, at in places.items())
        text += f"[links.{name}]\nmass = 1\ninertia = 1\npoints = {{ {points} }}\n"
    structure = find_structure(parse(text, "sample", "sample.toml"))
    assert [(g.kind, len(g.links)) for g in structure.groups] == [("IV, numerical", 4)]
    assert structure.is_numerical
    assert not structure.dyads


def test_a_turn_returns_and_later_turns_are_the_same():
    model = driven("ternary-on-rods")
    assert model.crank_range().is_full_turn
    angle = np.linspace(0.0, 2.0 * np.pi, 11)
    first, later = model.sweep(angle), model.sweep(angle - 6.0 * np.pi)
    assert first.point("P") == pytest.approx(later.point("P"), abs=1e-15)
    assert model.structure.formula == "I (crank) -> left + plate + right + rod (III, numerical)"
    assert model.is_numerical
    assert np.max(first.closure_error()) < 1e-16


SWINGS = TEXT.replace("A = [16, 0]", "A = [34, 0]")


def test_a_swing_ends_where_its_links_stand_dead_and_says_so():
    model = from_text(SWINGS)
    limits = model.crank_range()
    low, high = limits.limits
    assert limits.low is not None
    assert "left + plate + right + rod (III, numerical): its links stand in a dead position" in limits.low.sentence
    inside = model.sweep(np.linspace(low, high, 50)[1:-1])
    assert np.max(inside.closure_error()) < 1e-15
    ends = model.sweep(np.array([0.5 * (low + high), low + 1e-7, high - 1e-7]))
    middle, *rates = np.abs(ends.rates("plate")[2])
    assert min(rates) > 1e2 * middle  # of the root of the distance from a dead position
    with pytest.raises(AssemblyError, match=r"'sample' cannot be assembled at .*°: 'left', .* keep the configuration"):
        model.sweep(np.array([0.0, high + 0.05])).point("P")
    with pytest.raises(AssemblyError, match="its crank reaches"):
        limits.check(low, high + 0.1, "sample")


def test_of_two_groups_that_end_between_two_looks_the_nearer_end_is_the_range_s():
    """The boom's cylinder could go on after the rods are stretched."""
    mechanism = driven("boom")
    low = mechanism.crank_range().low
    assert low is not None
    assert low.sentence == "jib + rod (RRR): stretched in one line"
    mechanism.sweep(np.array([low.angle + 1e-9])).poses("jib")


NO_SKETCH = TEXT.replace("points = { B = [40, 38], C = [80, 33], D = [62, 55] }", "")
LOOSE = "O3 = [0, 0], D = [38, 0], O2 = [-30, -100]"
LOCKED = TEXT.replace("O3 = [0, 0], D = [38, 0]", LOOSE).replace("O2 = [0, 0], C = [45, 0]", "C = [45, 0]")
TWO_DRIVERS = TEXT.replace("gravity =", 'cylinder = { between = ["B", "O2"] }\ngravity =')
ON_ONE_BODY = BOOM.replace('["C", "Q"]', '["C", "J"], links = ["boom", "boom"]')
FAULTS = [
    (NO_SKETCH, r"expected the rough position of 'B' or 'C' or 'D' or 'P' at crank angle 0°, got a sketch that leaves"),
    (TEXT.replace("B = [50, 0]", "B = [5, 0]"), r"cannot be assembled at 0° from the sketch; check the"),
    (TWO_DRIVERS, r"expected one driver, got crank and cylinder"),
    (TEXT.replace('crank   = "crank"', ""), r"crank is missing: .* or a cylinder"),
    (ON_ONE_BODY, r"on two different bodies, got both on 'boom'"),
    (
        BOOM.replace("angle  = 350\n", ""),
        r"sample.toml:\d+: sketch.*: expected the length of the cylinder at which the",
    ),
    (BOOM.replace('["C", "Q"]', '["C", "Z"]'), r"cylinder: unknown point 'Z'"),
    (BOOM.replace('["C", "Q"]', '["C", "Q", "R"]'), r"cylinder.between: expected "),
    (LOCKED, r"too many joints|form no group"),
]


@pytest.mark.parametrize(("text", "message"), FAULTS)
def test_a_linkage_that_cannot_be_solved_is_refused_with_its_cure(text, message):
    with pytest.raises(LinkproofError, match=message):
        from_text(text)


def test_a_sketch_that_is_rough_finds_the_configuration_nearest_to_it():
    exact = driven("ternary-on-rods").sweep(np.asarray(0.0))
    here = {p: exact.point(p) * 1e3 for p in "BCD"}
    for shift in ((9.0, 0.0), (-7.0, 7.0)):
        points = ", ".join(f"{p} = [{here[p][0] + shift[0]}, {here[p][1] + shift[1]}]" for p in here)
        model = from_text(TEXT.replace("B = [40, 38], C = [80, 33], D = [62, 55]", points))
        assert model.sweep(np.asarray(0.0)).point("P") == pytest.approx(exact.point("P"), abs=1e-14)


def test_a_turn_that_ends_in_another_configuration_is_refused():
    """Two links between the ground and a body that turns half as fast as the crank."""
    joints = (
        Revolute("P", "half", "one", (0.3, 0.0), (0.0, 0.0)),
        Revolute("Q", "two", "one", (0.9, 0.0), (1.0, 0.0)),
        Revolute("R", GROUND, "two", (1.0, 0.1), (0.0, 0.0)),
    )

    def hosts(angle):
        none, one = np.zeros(angle.shape), np.ones(angle.shape)
        still = (none, none, none)
        half = ((none, none, np.cos(0.5 * angle), np.sin(0.5 * angle)), (none, none, 0.5 * one), still)
        return {GROUND: ((none, none, one, none), still, still), "half": half}

    problem = Problem(joints, ("one", "two"), hosts, 1.0, is_linear=False)
    start = newton(problem.system(np.zeros(1)), np.array([[[0.3, 0.0, 0.9], [1.0, 0.1, 1.6]]]))[0]
    branch = follow_branch(problem, start, 0.0)
    assert branch.strays
    assert branch.turns is None
    assert branch.ends == pytest.approx((-2.0 * np.pi, 2.0 * np.pi))
    solver = GroupSolver(Group(("one", "two"), joints, 2, branch), np.array([7.0]))
    assert solver.margin()[0] < 0.0
    _, words = solver.fault(None, driven("boom").linkage)
    assert "a turn of the driver takes 'one', 'two' into another configuration" in words
