"""A campaign judges the runs of engines, and a failure costs one run only."""

import dataclasses

import numpy as np
import pytest

from analytic.description.crank_motion import RPM, crank_motion
from analytic.description.linkage import ReleasedRegime
from analytic.description.loading import load
from analytic.errors import AssemblyError, LinkproofError, UnknownNameError
from analytic.kinematics.mechanism import Mechanism
from comparisons.designer.building import usual_sheet
from comparisons.trials.campaign import campaign
from comparisons.trials.campaign import campaign as module
from comparisons.trials.campaign.campaign import CampaignRequest, compare, sheets
from comparisons.trials.judging import quantities
from comparisons.trials.judging.records import Verdict
from comparisons.trials.runs.workers import LocalPool
from engines.contract import Origin, Outcome, Run, Setting, Signal
from engines.registry import engine, own_names, why_unavailable
from engines.scene import Channel
from reports.api.campaign import request
from reports.api.options import Motion
from tests.analytic.linkages import FOLDER, double_rocker_text
from tests.comparisons.scripted import Scripted
from tests.comparisons.true_motions import cut, perfect_motion

JUKI = load("juki-mf7923d")
MOTION = crank_motion("run-up-quintic", ramp_time=0.06, hold_time=0.02)
HISTORY = perfect_motion(Mechanism(JUKI), MOTION, 801).history
PARALLELOGRAM = load("tests/linkages/parallelogram.toml")
# Its coupler is too short for a full turn.
COUPLER = dataclasses.replace(JUKI.links["coupler"], points={"A": (0.0, 0.0), "D": (0.0100, 0.0)})
SHORT = dataclasses.replace(JUKI, links={**JUKI.links, "coupler": COUPLER}, sketch_angle=np.pi / 2)
SWING = ReleasedRegime("swing", torque=0.0, start_angle=1.5, start_speed=1.0, duration=0.004)
PART = crank_motion("constant-speed", speed=1.0, ramp_time=0.2, hold_time=0.0, start_angle=1.4)


BRIEF = tuple(crank_motion(name, ramp_time=0.05, hold_time=0.02) for name in ("run-up", "run-up-cubic"))


@pytest.fixture
def with_engine(monkeypatch):
    def install(engine):
        monkeypatch.setattr(campaign, "engine_names", lambda: ("scripted",))
        monkeypatch.setattr(campaign, "engine", lambda name: engine)
        return engine

    return install


def _request(**changes):
    request = CampaignRequest((JUKI,), (MOTION,), "as tested", ("scripted",))
    return dataclasses.replace(request, **changes)


def _finished(channels=tuple(Channel), **changes):
    run = Run(Outcome.FINISHED, history=dataclasses.replace(HISTORY, **changes), seconds=0.5, steps=1400)
    return Scripted(lambda *_: run, channels=channels)


def _outcomes(result):
    return {record.quantity: record.outcome for record in (*result.errors, *result.invariants)}


def _scaled(name, factor, **changes):
    signal = getattr(HISTORY, name)
    return {name: dataclasses.replace(signal, values=factor * signal.values, **changes)}


SIZES = {name: Signal(s.time, np.hypot(*s.values.T)) for name, s in HISTORY.joint_force.items()}
NOT_OFFERED = {"acceleration": None, "channels": {*Channel} - {Channel.ACCELERATION}}
LACKS = {"not-provided": ("closure", "torque_two_routes", "force_balance")}
# What an engine gives in place of the true history, and which rows do not pass, by their outcome.
GIVEN = {
    "the truth": ({}, {}),
    "slow bodies": (_scaled("velocity", 0.99), {"over-limit": ("Peq", "Teq", "closure", "energy_balance", "v")}),
    # An engine that offers a channel has an error in its adapter; one that does not offer it is not at fault.
    "no acceleration that it offers": ({"acceleration": None}, {"adapter-error": ("a",), **LACKS}),
    "no acceleration": (NOT_OFFERED, {"not-provided": ("a", *LACKS["not-provided"])}),
    "sizes of joint forces": ({"joint_force": SIZES}, {"not-provided": ("force_balance",)}),
    "a torque that the adapter computes": (
        _scaled("torque", 2.0, origin=Origin.COMPUTED),
        {"computed": ("Mkr", "Peq", "energy_balance", "torque_two_routes")},
    ),
}


@pytest.mark.parametrize("name", GIVEN)
def test_what_an_engine_gives_costs_its_own_rows(with_engine, name):
    change, expected = GIVEN[name]
    with_engine(_finished(**change))
    (result,) = compare(_request())
    outcomes = _outcomes(result)
    assert {"Jeq", "Teq", "Mkr", "Peq", "S", "v", "a", "joint_force:A"} <= outcomes.keys()
    others = {row: outcome for row, outcome in outcomes.items() if outcome != "passed"}
    assert others == {row: outcome for outcome, rows in expected.items() for row in rows}
    assert all(error.limit and error.error_max is not None for error in result.errors if error.quantity != "a")
    assert (result.seconds, result.steps) == (0.5, 1400)


def test_part_of_a_motion_is_divergence_whichever_quantity_is_compared(with_engine):
    with_engine(Scripted(lambda *_: Run(Outcome.FINISHED, history=cut(HISTORY, lambda t: t > 0.005))))
    (result,) = compare(_request(quantities=("Mkr",), with_invariants=False))
    ((outcome, detail),) = {(r.outcome, r.detail) for r in result.errors}
    assert outcome == "diverged"
    assert detail.endswith("has no samples from 0 to 0.0051 s, where its own step is 0.0001 s")


def test_a_derived_quantity_has_the_weakest_origin_of_its_parts(with_engine):
    with_engine(_finished(velocity=dataclasses.replace(HISTORY.velocity, origin=Origin.EXTRAPOLATED)))
    (result,) = compare(_request())
    origins = {r.quantity: r.origin for r in result.errors}
    assert {name for name, origin in origins.items() if origin == "extrapolated"} == {"Jeq", "Teq", "Peq", "v", "a"}
    assert {origins["Mkr"], origins["S"], origins["joint_force:A"]} == {"read"}


def _raise_type_error(*_):
    raise TypeError("of our own making")


@pytest.mark.parametrize("function", ["checks", "deviation"])
def test_an_exception_of_the_suite_is_not_blamed_on_the_engine(with_engine, monkeypatch, function):
    with_engine(_finished())
    monkeypatch.setattr(campaign, function, _raise_type_error)
    (result,) = compare(_request(), pool=LocalPool(0))
    assert {r.outcome for r in result.errors} == {"suite-error"}
    assert result.errors[0].detail.startswith("this is a fault of linkproof: TypeError: of our own making (comparisons")
    assert "report it with" in result.errors[0].detail


@pytest.mark.parametrize("processes", [0, 1])
def test_an_adapters_exception_costs_its_own_row_and_its_traceback_can_be_shown(
    with_engine, monkeypatch, capfd, processes
):
    with_engine(Scripted(_raise_type_error))
    monkeypatch.setenv("LINKPROOF_WORKER_START", "fork")
    monkeypatch.setenv("LINKPROOF_WORKER_OUTPUT", "1")
    (result,) = compare(_request(), pool=LocalPool(processes))
    assert {r.outcome for r in result.errors} == {"adapter-error"}
    assert "the adapter of scripted raised TypeError: of our own making (tests/" in result.errors[0].detail
    assert "in _raise_type_error" in capfd.readouterr().err


def test_a_quantity_without_a_sample_is_undefined(with_engine, monkeypatch):
    with_engine(_finished())
    monkeypatch.setattr(quantities, "near_jumps", lambda time, motion: np.ones(len(time), dtype=bool))
    (result,) = compare(_request(quantities=("Mkr", "S"), with_invariants=False))
    assert _outcomes(result) == {"Mkr": "undefined", "S": "passed"}
    assert "every sample of Mkr" in result.errors[0].detail
    assert list(result.curves) == ["S"]


def _swell(*_):
    raise MemoryError


@pytest.mark.parametrize(
    ("engine", "outcome", "words"),
    [
        (Scripted(None, version=None), "unavailable", "is not installed"),
        (Scripted(lambda *_: Run(Outcome.UNSUPPORTED, "cannot hold springs")), "unsupported", "cannot hold springs"),
        (Scripted(_swell), "crashed", "needed more than 4 GiB of memory"),
    ],
)
def test_an_engine_without_a_motion_has_records_with_the_reason(with_engine, engine, outcome, words):
    with_engine(engine)
    (result,) = compare(_request())
    assert {r.outcome for r in result.errors} == {outcome}
    assert words in result.errors[0].detail
    assert all(r.error_max is None for r in result.errors)


AT_REST = {"linkages": (PARALLELOGRAM,), "motions": (crank_motion("run-up", start_angle=0.0),)}


@pytest.mark.parametrize(
    ("changes", "error", "words"),
    [
        ({"engines": ("scripted", "scriptd")}, UnknownNameError, "scripted"),
        ({"linkages": (JUKI, SHORT)}, AssemblyError, "cannot be assembled at"),
        (AT_REST, AssemblyError, "at rest on a change point at 0°"),
        ({"motions": (), "own_regimes": ("free",)}, LinkproofError, "'juki-mf7923d' can run in, got none"),
        (
            {"linkages": (dataclasses.replace(JUKI, output=None),), "quantities": ("S",)},
            LinkproofError,
            "names no output",
        ),
    ],
)
def test_a_campaign_that_cannot_be_made_is_refused_before_any_run(with_engine, changes, error, words):
    engine = with_engine(_finished())
    with pytest.raises(error, match=words):
        list(compare(_request(**changes)))
    assert engine.asked == []


def test_joint_forces_are_undefined_where_a_change_point_is_passed(with_engine):
    with_engine(_finished())
    motions = (crank_motion("run-up-quintic", ramp_time=0.06, hold_time=0.02, start_angle=1.5),)
    (result,) = compare(_request(linkages=(PARALLELOGRAM,), motions=motions, quantities=("joint_force",)))
    details = {record.outcome: record.detail for record in result.errors}
    assert "no bound where the linkage passes its change point" in details[Verdict.UNDEFINED.value]


def test_only_angles_that_the_crank_passes_matter():
    request = _request(linkages=(PARALLELOGRAM,), motions=(PART,), engines=("direct",), quantities=("Mkr", "v", "Jeq"))
    (result,) = compare(request)
    assert {record.outcome for record in result.errors} == {"passed"}


def _brief(**changes):
    """A request of real runs: two motions and two settings of the direct engine, and a released crank."""
    settings = (Setting.NAIVE, Setting.TUNED)
    linkage = dataclasses.replace(JUKI, regimes=(SWING,))
    request = CampaignRequest((linkage,), BRIEF, "brief", ("direct",), settings, own_regimes=("swing",))
    return dataclasses.replace(request, **changes)


def _untimed(result):
    """All of a result but its timings; arrays as bytes, so that == means every bit."""
    curves = {name: curve.tobytes() for name, curve in result.curves.items()}
    return dataclasses.replace(result, seconds=0.0, setup_seconds=0.0), curves


@pytest.fixture(scope="module")
def made_here():
    """The results of the brief request, made in this process."""
    return [_untimed(result) for result in compare(_brief(), pool=LocalPool(0))]


def test_runs_in_workers_are_the_same_in_the_same_order_and_announced(made_here):
    heard = []
    results = compare(_brief(), lambda *words: heard.append(words), pool=LocalPool(2))
    assert [_untimed(result) for result in results] == made_here
    runs = [(motion.regime, setting) for motion in BRIEF for setting in ("naive", "tuned")] + [("swing", "tuned")]
    labels = [f"juki-mf7923d, {regime}: direct {setting}" for regime, setting in runs]
    assert {label for label, *_ in heard} == set(labels)
    assert sorted({finished for _, finished, _ in heard}) == list(range(len(labels) + 1))
    assert {total for *_, total in heard} == {len(labels)} == {len(made_here)}


NAMES = ("slotted-takeup", "juki-mf7923d")
LINKAGES = tuple(load(name) for name in NAMES)
SHEETS = LINKAGES, (crank_motion("run-up", speed=500 * RPM),), ("free",)


def test_every_linkage_has_a_sheet_of_the_campaigns_motions():
    found = sheets(*SHEETS, 2)
    assert [sheet.name for sheet in found] == list(NAMES)
    assert all("500 rpm" in sheet.conditions for sheet in found)
    assert [list(sheet.released) for sheet in found] == [["free"], []]


def test_a_sheet_that_fails_costs_no_other(monkeypatch):
    def broken(linkage, *rest):
        if linkage.name == "juki-mf7923d":
            raise ZeroDivisionError("a fault of the suite")
        return usual_sheet(linkage, *rest)

    monkeypatch.setattr(module, "usual_sheet", broken)
    whole, lost = sheets(*SHEETS, 0)
    assert "a fault of the suite" in lost.missing["values"]
    assert (lost.name, lost.linkage) == ("juki-mf7923d", LINKAGES[1])
    assert whole.values


# Swings, torques over time or angle, and cylinders: engines within their limits, and refusals with the reach.


REGIMES = """
[regimes.rocking]
from = 65
to = -10
time = 0.3
law = "cycloidal"
back = true
dwell = 0.1

[regimes.servo]
time  = [0, 0.05, 0.1, 0.15, 0.2, 0.25, 0.3]
angle = [40, 41, 45, 52, 59, 63, 64]
"""
OTHERS = [name for name in own_names() if name != "direct" and why_unavailable(engine(name)) is None]
ENGINES = ["direct", *(pytest.param(name, marks=pytest.mark.nightly) for name in OTHERS)]


def _own(path, engine_name, *regimes, quantity=()):
    """The runs of a linkage file in an engine under its own regimes."""
    return request([load(path)], Motion(regime=regimes), engine=(engine_name,), quantity=quantity)


@pytest.fixture
def rocker(tmp_path):
    path = tmp_path / "rocker.toml"
    path.write_text(double_rocker_text(regimes=REGIMES))
    return str(path)


@pytest.mark.parametrize("name", ENGINES)
def test_a_rocker_that_cannot_turn_swings_within_the_limits(rocker, name):
    results = list(compare(_own(rocker, name, "rocking", "servo"), pool=LocalPool(0)))
    assert [result.regime for result in results] == ["rocking", "servo"]
    for result in results:
        verdicts = {record.quantity: record.outcome for record in (*result.errors, *result.invariants)}
        assert {verdicts[quantity] for quantity in ("S", "v", "a", "Mkr", "Jeq")} == {Verdict.PASSED}
        assert not set(verdicts.values()) & {Outcome.DIVERGED, Verdict.OVER_LIMIT}
        shared = {record.quantity: record.shared for record in result.errors}
        assert shared["S"] == ""


RELEASED = """
[regimes.timed]
torque = [0.0, 1.0, -1.0]
time = [0.004, 0.008, 0.016]
start_angle = 30
duration = 0.02

[regimes.angled]
torque = [1.5, 2.5, 1.0]
angle = [-60, 0, 60]
start_angle = 30
duration = 0.02
"""


@pytest.mark.parametrize(
    "name",
    [pytest.param(name, marks=() if name == "mujoco" else pytest.mark.nightly) for name in ("direct", *OTHERS)],
)
def test_a_torque_over_time_or_angle_moves_every_engine_that_takes_it(tmp_path, name):
    path = tmp_path / "rocker.toml"
    path.write_text(double_rocker_text(regimes=RELEASED))
    asked = _own(path, name, "own", quantity=("phi", "omega", "S", "a"))
    for result in compare(asked, pool=LocalPool(0)):
        outcomes = {record.outcome for record in result.errors}
        if outcomes == {Verdict.UNSUPPORTED}:
            assert result.regime == "angled" or not engine(name).abilities.timed_torque
        else:
            assert outcomes == {Verdict.PASSED}


LINEAR = """
[regimes.lift]
from = 260
to = 500
speed = 800
law = "modified-sine"
back = true

[regimes.too-far]
from = 260
to = 600
time = 1
"""


def test_a_cylinder_follows_a_law_in_millimetres(tmp_path):
    path = tmp_path / "boom.toml"
    path.write_text((FOLDER / "drives" / "boom.toml").read_text() + LINEAR)
    (lift,) = compare(_own(path, "direct", "lift"), pool=LocalPool(0))
    assert lift.conditions.startswith("modified-sine from 260 mm to 500 mm and back, at most 800 mm/s, gravity on")
    assert {record.outcome for record in (*lift.errors, *lift.invariants)} == {Verdict.PASSED}
    with pytest.raises(AssemblyError, match="its drive reaches 232 mm to 572 mm"):
        list(compare(_own(path, "direct", "too-far"), pool=LocalPool(0)))
