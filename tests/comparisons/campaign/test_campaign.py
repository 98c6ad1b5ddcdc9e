"""A campaign judges what engines return and survives what they do."""

import dataclasses
import sys

import numpy as np
import pytest

from analytic.description.crank_motion import crank_motion
from analytic.description.linkage import ReleasedRegime
from analytic.description.loading import load
from analytic.errors import AssemblyError, LinkproofError, UnknownNameError
from analytic.kinematics.mechanism import Mechanism
from comparisons.campaign import campaign
from comparisons.campaign.campaign import CampaignRequest, compare, tasks
from comparisons.judging import deviations
from comparisons.judging.baseline import Baseline, Place
from comparisons.judging.limits import shipped_limits
from comparisons.judging.records import Verdict
from comparisons.judging.verdicts import Standard, shipped_standard
from comparisons.runs import worker_pool
from comparisons.runs.failures import GIB
from comparisons.runs.journal import Journal
from comparisons.runs.workers import Bounds, LocalPool
from engines.contract import Abilities, Origin, Outcome, ReadOut, Run, Setting, Signal
from engines.scene import Channel
from tests.comparisons.faults import PATIENCE, Clock, announce_engines, fail
from tests.comparisons.perfect_engine import perfect_motion
from tests.comparisons.true_motions import cut

JUKI = load("juki-mf7923d")
MOTION = crank_motion("run-up-quintic")
HISTORY = perfect_motion(Mechanism(JUKI), MOTION).history


TAKEUP = load("slotted-takeup")
PARALLELOGRAM = load("tests/linkages/parallelogram.toml")
# Its coupler is too short for a full turn.
COUPLER = dataclasses.replace(JUKI.links["coupler"], points={"A": (0.0, 0.0), "D": (0.0100, 0.0)})
SHORT = dataclasses.replace(JUKI, links={**JUKI.links, "coupler": COUPLER}, sketch_angle=np.pi / 2)
RAISED = (
    "the adapter of raising raised ValueError: first line second line (tests/comparisons/faults.py, line "
    f"{fail.__code__.co_firstlineno + 1})"
)
BRIEF = tuple(crank_motion(name, ramp_time=0.05, hold_time=0.02) for name in ("run-up", "run-up-cubic"))


class Scripted:
    """An engine that does as it is told."""

    name = "scripted"
    work_unit = "steps"

    is_control = False

    def __init__(self, act, version="1.0", channels=tuple(Channel)):
        self.act, self._version = act, version
        self.abilities = Abilities(
            {channel: ReadOut("as told") for channel in channels}, frozenset(), frozenset(), frozenset()
        )
        self.scenes = []

    def version(self):
        return self._version

    def run(self, scene, setting):
        self.scenes.append(scene)
        return self.act(scene)


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


def _finished(scene, **changes):
    return Run(Outcome.FINISHED, history=dataclasses.replace(HISTORY, **changes), seconds=0.5, steps=1400)


def test_a_perfect_engine_passes_everything(with_engine):
    with_engine(Scripted(_finished))
    (result,) = compare(_request())
    assert {r.outcome for r in (*result.records, *result.invariants)} == {"passed"}
    assert {"Jeq", "Teq", "Mkr", "Peq", "S", "v", "a", "joint_force:A"} <= {r.quantity for r in result.records}
    assert all(r.limit is not None and r.seconds == 0.5 and r.steps == 1400 for r in result.records)


def test_a_wrong_motion_that_claims_success_is_over_its_limit(with_engine):
    slow = Signal(HISTORY.velocity.time, 0.99 * HISTORY.velocity.values)
    with_engine(Scripted(lambda scene: _finished(scene, velocity=slow)))
    (result,) = compare(_request())
    outcomes = {r.quantity: r.outcome for r in (*result.records, *result.invariants)}
    assert outcomes["Teq"] == outcomes["v"] == outcomes["energy_balance"] == Verdict.OVER_LIMIT
    assert outcomes["S"] == Verdict.PASSED
    assert "over its limit" in next(r.detail for r in result.records if r.quantity == "Teq")


def test_nan_is_divergence_with_its_time(with_engine):
    values = HISTORY.torque.values.copy()
    values[700:] = np.nan
    with_engine(Scripted(lambda scene: _finished(scene, torque=Signal(HISTORY.torque.time, values))))
    (result,) = compare(_request())
    assert {r.outcome for r in result.records} == {"diverged"}
    assert result.records[0].detail == "torque is not finite from 0.35 s on"


PEAK = np.max(np.abs(HISTORY.torque.values))


@pytest.mark.parametrize("quantities", [(), ("Mkr",)])
@pytest.mark.parametrize(
    ("kept", "where"),
    [
        (lambda t: t < 0.0058, "from 0.0055 to 0.7 s"),
        (lambda t: t < 0.35, "from 0.3495 to 0.7 s"),
        (lambda t: t > 0.05, "from 0 to 0.0505 s"),
        (lambda t: np.abs(t - 0.65) > 0.012, "from 0.638 to 0.662 s"),  # 144 degrees
        (lambda t: np.abs(np.interp(t, HISTORY.torque.time, HISTORY.torque.values)) < 0.98 * PEAK, "from 0.6"),
    ],
    ids=["twelve samples", "half of it", "a late start", "most of half a turn", "all but its peaks"],
)
def test_a_part_of_a_motion_is_not_the_motion_whatever_is_asked_of_it(with_engine, kept, where, quantities):
    with_engine(Scripted(lambda scene: Run(Outcome.FINISHED, history=cut(HISTORY, kept))))
    (result,) = compare(_request(quantities=quantities, with_invariants=not quantities))
    assert {r.outcome for r in result.records} == {"diverged"}
    assert f"has no samples {where}" in result.records[0].detail
    assert result.records[0].detail.endswith("where its own step is 0.0005 s")


@pytest.mark.parametrize(("offered", "outcome"), [(True, "adapter-error"), (False, "not-provided")])
def test_a_channel_that_was_not_recorded_costs_its_own_rows(with_engine, offered, outcome):
    """Of an engine that offers it, that is the adapter's error; of one that does not, nothing it has to answer for."""
    left = [channel for channel in Channel if offered or channel is not Channel.ACCELERATION]
    with_engine(Scripted(lambda scene: _finished(scene, acceleration=None), channels=left))
    (result,) = compare(_request())
    outcomes = {r.quantity: r.outcome for r in (*result.records, *result.invariants)}
    assert outcomes.pop("a") == outcome
    for name in ("closure", "torque_two_routes", "force_balance"):
        assert outcomes.pop(name) == "not-provided"
    assert set(outcomes.values()) == {"passed"}
    assert "acceleration" in next(r.detail for r in result.records if r.quantity == "a")


def test_a_joint_force_that_is_a_magnitude_is_judged_as_one(with_engine):
    sizes = {name: Signal(s.time, np.hypot(*s.values.T)) for name, s in HISTORY.joint_force.items()}
    with_engine(Scripted(lambda scene: _finished(scene, joint_force=sizes)))
    (result,) = compare(_request())
    outcomes = {r.quantity: r.outcome for r in (*result.records, *result.invariants)}
    assert outcomes.pop("force_balance") == "not-provided"
    assert set(outcomes.values()) == {"passed"}


@pytest.mark.parametrize("wrong", [1.0, 2.0])
def test_what_an_adapter_computes_itself_is_compared_and_not_judged(with_engine, wrong):
    own = dataclasses.replace(HISTORY.torque, values=wrong * HISTORY.torque.values, origin=Origin.COMPUTED)
    with_engine(Scripted(lambda scene: _finished(scene, torque=own)))
    (result,) = compare(_request())
    outcomes = {r.quantity: r.outcome for r in (*result.records, *result.invariants)}
    computed = {"Mkr", "Peq", "energy_balance", "torque_two_routes"}
    assert {name for name, outcome in outcomes.items() if outcome == "computed"} == computed
    assert {outcome for name, outcome in outcomes.items() if name not in computed} == {"passed"}
    assert next(r.error_max for r in result.records if r.quantity == "Mkr") == pytest.approx(wrong - 1.0, abs=1e-9)


def test_a_derived_quantity_has_the_weakest_origin_of_its_parts(with_engine):
    several = dataclasses.replace(HISTORY.velocity, origin=Origin.EXTRAPOLATED)
    with_engine(Scripted(lambda scene: _finished(scene, velocity=several)))
    (result,) = compare(_request())
    origins = {r.quantity: r.origin for r in result.records}
    assert {name for name, origin in origins.items() if origin == "extrapolated"} == {"Jeq", "Teq", "Peq", "v", "a"}
    assert {origins["Mkr"], origins["S"], origins["joint_force:A"]} == {"read"}


def test_an_exception_in_an_engine_costs_its_own_row(with_engine):
    def fail(scene):
        raise RuntimeError("matrix is singular")

    with_engine(Scripted(fail))
    (result,) = compare(_request())
    assert {r.outcome for r in result.records} == {"adapter-error"}
    line = fail.__code__.co_firstlineno + 1
    assert result.records[0].detail == (
        "the adapter of scripted raised RuntimeError: matrix is singular "
        f"(tests/comparisons/campaign/test_campaign.py, line {line})"
    )


def test_an_engine_that_returns_what_cannot_be_read_is_its_adapters_error(with_engine):
    with_engine(Scripted(lambda scene: None))
    (result,) = compare(_request())
    assert {r.outcome for r in result.records} == {"adapter-error"}


def _raise_type_error(*_):
    raise TypeError("of our own making")


@pytest.mark.parametrize("function", ["checks", "deviation"])
@pytest.mark.parametrize("processes", [0, 1])
def test_an_exception_of_ours_is_no_fault_of_the_engine(with_engine, monkeypatch, function, processes):
    with_engine(Scripted(_finished))
    monkeypatch.setenv("LINKPROOF_WORKER_START", "fork")
    monkeypatch.setattr(campaign, function, _raise_type_error)
    (result,) = compare(_request(), pool=LocalPool(processes))
    assert {r.outcome for r in result.records} == {"suite-error"}
    assert result.records[0].detail.startswith(
        "this is a fault of linkproof: TypeError: of our own making (comparisons"
    )
    assert "report it with" in result.records[0].detail


@pytest.mark.parametrize("processes", [0, 1])
def test_the_whole_traceback_is_shown_where_it_is_asked_for(with_engine, monkeypatch, capfd, processes):
    with_engine(Scripted(_raise_type_error))
    monkeypatch.setenv("LINKPROOF_WORKER_START", "fork")
    monkeypatch.setenv("LINKPROOF_WORKER_OUTPUT", "1")
    list(compare(_request(), pool=LocalPool(processes)))
    assert "in _raise_type_error" in capfd.readouterr().err


def test_a_quantity_without_a_sample_is_undefined(with_engine, monkeypatch):
    with_engine(Scripted(_finished))
    monkeypatch.setattr(deviations, "at_jumps", lambda time, case: np.ones(len(time), dtype=bool))
    (result,) = compare(_request(quantities=("Mkr", "S"), with_invariants=False))
    assert {r.quantity: r.outcome for r in result.records} == {"Mkr": "undefined", "S": "passed"}
    assert "every sample of Mkr" in result.records[0].detail
    assert list(result.curves) == ["S"]


@pytest.mark.parametrize(
    ("engine", "outcome", "words"),
    [
        (Scripted(_finished, version=None), "unavailable", "is not installed"),
        (Scripted(lambda scene: Run(Outcome.UNSUPPORTED, "cannot hold springs")), "unsupported", "cannot hold springs"),
        (Scripted(lambda scene: Run(Outcome.DIVERGED, "crank ran away")), "diverged", "crank ran away"),
    ],
)
def test_what_an_engine_cannot_do_is_a_record(with_engine, engine, outcome, words):
    with_engine(engine)
    (result,) = compare(_request())
    assert {r.outcome for r in result.records} == {outcome}
    assert words in result.records[0].detail
    assert all(r.error_max is None for r in result.records)


def test_no_more_is_recorded_than_is_asked_for(with_engine):
    engine = with_engine(Scripted(_finished))
    for names in ("Jeq",), ("Mkr",), ("joint_force",):
        list(compare(_request(quantities=names, with_invariants=False)))
    assert [scene.channels for scene in engine.scenes] == [
        {Channel.VELOCITY},
        {Channel.TORQUE},
        {Channel.JOINT_FORCE},
    ]


def test_deviations_three_times_their_record_fail_within_the_limit(with_engine):
    off = Signal(HISTORY.torque.time, HISTORY.torque.values * (1.0 + 5e-5))
    with_engine(Scripted(lambda scene: _finished(scene, torque=off)))
    (free,) = compare(_request(quantities=("Mkr",), with_invariants=False))
    assert free.records[0].outcome == "passed"
    places = {free.records[0].mechanism: Place("press.toml", "0")}
    before = Baseline({}, places).recorded([dataclasses.replace(free.records[0], error_max=1e-5)], {})
    held = free.judged(Standard(shipped_limits(), before).judge)
    assert held.records[0].outcome == "over-limit"
    assert held.records[0].baseline == pytest.approx(3e-5)
    assert "three times its recorded value" in held.records[0].detail
    assert held.judged(shipped_standard().judge) == free


def test_unknown_engines_are_refused_before_any_run(with_engine):
    engine = with_engine(Scripted(_finished))
    with pytest.raises(UnknownNameError, match="scripted"):
        list(compare(_request(engines=("scripted", "scriptd"))))
    assert engine.scenes == []


def test_a_linkage_that_cannot_turn_is_refused_before_any_run(with_engine):
    engine = with_engine(Scripted(_finished))
    with pytest.raises(AssemblyError, match="cannot be assembled at"):
        list(compare(_request(linkages=(JUKI, SHORT))))
    assert engine.scenes == []


@pytest.mark.parametrize("linkage", [PARALLELOGRAM, dataclasses.replace(PARALLELOGRAM, output=None)])
def test_rest_on_a_change_point_is_refused_before_any_run(with_engine, linkage):
    engine = with_engine(Scripted(_finished))
    with pytest.raises(AssemblyError, match="at rest on a change point at 0°"):
        compare(_request(linkages=(linkage,), motions=(crank_motion("run-up", start_angle=0.0),)))
    assert engine.scenes == []
    (result,) = compare(
        _request(linkages=(linkage,), motions=(crank_motion("run-up", start_angle=1.5),), quantities=("joint_force",))
    )
    told = {record.outcome: record.detail for record in result.records}
    assert "no bound where the linkage passes its change point" in told[Verdict.UNDEFINED.value]


@pytest.mark.parametrize("linkage", [PARALLELOGRAM, SHORT])
def test_only_angles_that_the_crank_passes_matter(linkage):
    part = crank_motion("constant-speed", speed=1.0, ramp_time=0.2, hold_time=0.0, start_angle=1.4)
    request = _request(linkages=(linkage,), motions=(part,), engines=("direct",), quantities=("Mkr", "v", "Jeq"))
    (result,) = compare(request)
    assert {record.outcome for record in result.records} == {"passed"}


def test_the_output_is_compared_where_the_crank_cannot_turn_fully():
    swing = ReleasedRegime("swing", torque=0.0, start_angle=1.5, start_speed=1.0, duration=0.01)
    part = crank_motion("constant-speed", speed=1.0, ramp_time=0.2, hold_time=0.0, start_angle=1.4)
    linkage = dataclasses.replace(SHORT, regimes=(swing,))
    results = list(compare(_request(linkages=(linkage,), motions=(part,), engines=("direct",), own_regimes=("swing",))))
    assert [result.records[0].regime for result in results] == ["constant-speed", "swing"]
    for result in results:
        assert {r.outcome for r in result.records if r.quantity in ("S", "v", "a")} == {"passed"}


def test_no_regime_at_all_is_refused():
    with pytest.raises(LinkproofError, match="'juki-mf7923d' can run in, got none"):
        compare(_request(motions=(), own_regimes=("free",), engines=("direct",)))


def test_output_quantities_need_an_output(with_engine):
    with_engine(Scripted(_finished))
    with pytest.raises(LinkproofError, match="names no output"):
        list(compare(_request(linkages=(dataclasses.replace(JUKI, output=None),), quantities=("S",))))


def test_every_setting_is_run_in_order(with_engine):
    with_engine(Scripted(_finished))
    heard = []
    results = list(compare(_request(settings=tuple(Setting)), lambda *words: heard.append(words)))
    assert [r.records[0].setting for r in results] == ["naive", "tuned", "best"]
    assert heard[-1][1:] == (3, 3)


def _parallel(**changes):
    """A request of real runs: two mechanisms, two regimes and two settings of the direct engine."""
    settings = (Setting.NAIVE, Setting.TUNED)
    return dataclasses.replace(CampaignRequest((JUKI, TAKEUP), BRIEF, "brief", ("direct",), settings), **changes)


def _untimed(result):
    """All of a result but its timings; arrays as bytes, so that == means every bit."""
    curves = {name: curve.tobytes() for name, curve in result.curves.items()}
    return dataclasses.replace(result, seconds=0.0, setup_seconds=0.0), curves


def test_runs_in_workers_give_the_same_in_the_same_order():
    expected = [_untimed(result) for result in compare(_parallel(), pool=LocalPool(0))]
    assert [_untimed(result) for result in compare(_parallel(), pool=LocalPool(2))] == expected
    assert len(expected) == 8


def test_a_released_crank_is_the_same_in_a_worker():
    own = _parallel(linkages=(TAKEUP,), motions=(), own_regimes=("free",))
    (here,), (there,) = compare(own, pool=LocalPool(0)), compare(own, pool=LocalPool(1))
    assert _untimed(there) == _untimed(here)
    assert {record.outcome for record in here.records} == {"passed"}


def test_every_run_begun_and_every_run_finished_is_announced():
    heard = []
    list(compare(_parallel(), lambda *words: heard.append(words), pool=LocalPool(2)))
    labels = {f"{k.name}, {m.regime}: direct {s}" for k in (JUKI, TAKEUP) for m in BRIEF for s in ("naive", "tuned")}
    assert {label for label, *_ in heard} == labels
    assert sorted({finished for _, finished, _ in heard}) == list(range(9))
    assert {total for *_, total in heard} == {8}


@pytest.mark.parametrize("processes", [0, 2])
def test_a_journal_keeps_what_is_finished_and_spares_it(tmp_path, processes):
    expected = [_untimed(result) for result in compare(_parallel(), pool=LocalPool(0))]
    journal = Journal(tmp_path, "as tested")
    begun = compare(_parallel(), pool=LocalPool(processes), journal=journal)
    some = iter(begun)
    next(some)
    some.close()
    kept = journal.records.keys
    assert 1 <= len(kept) < 8
    heard = []
    results = compare(_parallel(), lambda *words: heard.append(words), pool=LocalPool(processes), journal=journal)
    assert [_untimed(result) for result in results] == expected
    assert min(finished for _, finished, _ in heard) == len(kept)
    assert set(journal.records.keys) == {task.key for task in tasks(_parallel())}
    # no run left: nothing is begun, and what was kept is what comes, timings and all
    heard.clear()
    again = list(compare(_parallel(), lambda *words: heard.append(words), pool=LocalPool(processes), journal=journal))
    assert heard == []
    assert [_untimed(result) for result in again] == expected


def test_a_journal_of_another_request_is_refused_before_any_run(tmp_path, with_engine):
    engine = with_engine(Scripted(_finished))
    Journal(tmp_path, "one").keep("key", {})
    with pytest.raises(LinkproofError, match="leave out --resume"):
        compare(_request(), journal=Journal(tmp_path, "another"))
    assert engine.scenes == []


def test_an_engine_that_swells_is_said_to_have(with_engine):
    def swell(scene):
        raise MemoryError

    with_engine(Scripted(swell))
    (result,) = compare(_request())
    assert {(r.outcome, r.detail) for r in result.records} == {("crashed", "needed more than 4 GiB of memory")}


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="bounds on memory are Linux's")
def test_faulty_engines_cost_their_own_rows(tmp_path, monkeypatch, capfd):
    announce_engines(tmp_path)
    monkeypatch.syspath_prepend(tmp_path)
    faulty = ("aborting", "hanging", "leaving", "raising", "swelling", "writing")
    request = _parallel(linkages=(JUKI,), motions=BRIEF[:1], engines=("direct", *faulty), settings=(Setting.TUNED,))
    clock = Clock()
    monkeypatch.setattr(worker_pool, "time", clock)
    monkeypatch.setattr(worker_pool, "_EXIT_TIMEOUT", PATIENCE)

    def begun(label, *_):
        if "hanging" in label and not clock.ahead:
            clock.put_forward()

    results = list(compare(request, begun, bounds=Bounds(memory=GIB // 4), pool=LocalPool(1)))
    told = {result.records[0].engine: {(r.outcome, r.detail) for r in result.records} for result in results}
    assert list(told) == list(request.engines)
    assert told == {
        "direct": {("passed", "")},
        "aborting": {("crashed", "died by signal 6 (SIGABRT)")},
        "hanging": {("timed-out", "took longer than 600 s")},
        "leaving": {("crashed", "exited with code 3")},
        "raising": {("adapter-error", RAISED)},
        "swelling": {("crashed", "needed more than 0.25 GiB of memory")},
        "writing": {("diverged", "did nothing")},
    }
    assert {record.engine_version for result in results[1:] for record in result.records} == {"1.0"}
    assert len({len(result.records) for result in results}) == 1
    assert capfd.readouterr() == ("", "")
