"""A released crank in words and beside the articles' integrator."""

from dataclasses import asdict, replace

import numpy as np
import pytest

from analytic.description.loading import find, load, parse
from analytic.kinematics.mechanism import Mechanism
from comparisons.campaign.campaign import RunResult
from comparisons.campaign.results import Results, dataset
from comparisons.judging.deviations import Deviation
from engines.contract import Setting
from reports.charts import run_up
from reports.charts.released import last_turn_figure
from reports.facts.released import Released, released, sentences
from reports.records.views import Regime, views
from tests.reports.made_up_results import made_up_results

TWO_CRANK, SLOTTED = "two-crank-takeup", "slotted-takeup"


def view_of(name):
    return views(made_up_results([load(name)], samples=21, quantities=("Jeq",)))[0]


def regime_of(name):
    return Regime(name, "released", None)


@pytest.fixture(scope="module")
def driven():
    found = released(view_of(TWO_CRANK), regime_of("driven"))
    assert isinstance(found, Released)
    return found


def test_only_a_regime_of_the_linkages_own_releases_the_crank():
    view = view_of(SLOTTED)
    assert released(view, view.regimes[0]) is None
    assert released(view, regime_of("run-up")) is None
    assert released(view, regime_of("free")) is released(view_of(SLOTTED), regime_of("free"))


def test_a_free_crank_rests_at_two_angles_one_of_them_stable():
    rest, own, coarse = sentences(released(view_of(SLOTTED), regime_of("free")))
    assert "92.06° (unstable) and 268.77° (stable)" in rest
    assert "within 1e-13 rad" in own
    assert "1000 Runge-Kutta steps" in coarse


def test_a_driven_crank_is_held_against_its_torque_over_damping(driven):
    rest, ending, settled, _, _ = sentences(driven)
    assert rest.endswith("can rest at no angle.")
    assert "605.584 over φ" in ending
    assert "5000.00 over φ, where M1/b is 5000.00" in settled


def test_the_articles_integrator_is_measured_at_its_own_steps(driven):
    time, error = driven.coarse_error("phi")
    assert len(time) == 1001
    assert error.max() == np.max(np.abs(driven.coarse.angle - driven.motion.angle(time)))
    assert error.max() > driven.motion.error_bound


def test_no_last_turn_without_a_torque():
    own = next(own for own in load(SLOTTED).regimes if own.name == "free")
    found = Released(Mechanism(load(SLOTTED)), own)
    assert found.ending is None
    assert found.settled is None


def test_the_last_turn_is_drawn_over_the_crank_angle(driven):
    speed, acceleration = last_turn_figure(view_of(TWO_CRANK), regime_of("driven"), driven).axes
    assert speed.get_xlim() == acceleration.get_xlim() == (0.0, 360.0)
    angle, rpm = speed.lines[0].get_data()
    assert np.all(np.diff(angle) >= 0.0)
    assert rpm.max() == pytest.approx(driven.ending.largest * 30.0 / np.pi, rel=1e-4)


@pytest.fixture(scope="module")
def ran(driven):
    """A campaign of the driven regime whose two engines were off by a thousandth."""
    made = made_up_results([load(TWO_CRANK)], samples=21, settings=[Setting.TUNED])
    time = np.linspace(0.0, driven.motion.duration, 201)
    truth = {"omega": driven.motion.speed(time), "epsilon": driven.motion.acceleration(time)}
    runs = []
    for engine in ("alpha", "beta"):
        first = next(record for record in made.records if record.engine == engine)
        found = {name: off_by_a_thousandth(time, driven.motion.angle(time), values) for name, values in truth.items()}
        records = tuple(
            replace(first, regime="driven", quantity=name, peak=one.peak, error_max=one.error_max)
            for name, one in found.items()
        )
        runs.append(RunResult(records, (), found))
    told = {"records": [asdict(r) for run in runs for r in run.records], "invariants": [], "motions": []}
    return Results({**made.document, **told}, dataset(runs, {**made.document, **told}))


def off_by_a_thousandth(time, angle, values):
    peak = float(np.max(np.abs(values)))
    return Deviation(
        time=time,
        angle=angle,
        observed=values + 1e-3 * peak,
        reference=values,
        peak=peak,
        error_max=1e-3,
        error_rms=1e-3,
        worst_time=0.0,
        samples=len(time),
        left_out=0,
    )


def test_the_coarse_integrator_stands_beside_the_engines(ran):
    (view,) = views(ran)
    upper, lower = run_up.history_figure(view, view.regimes[0], "omega").axes
    assert "1000 steps" in [text.get_text() for text in lower.texts]
    assert len(upper.lines) == 4  # the closed form, two engines, the integrator
    (scale,) = upper.child_axes
    assert scale.get_ylabel() == "n, rpm"


@pytest.mark.parametrize(("axis", "words"), [("time = [0, 1, 2]", "time"), ("angle = [0, 90, 180]", "the crank angle")])
def test_a_torque_that_changes_has_no_angle_of_rest_and_no_printed_integrator(axis, words):
    text = f"[regimes.mine]\ntorque = [0.01, 0.02, 0.01]\n{axis}\nstart_angle = 200\nduration = 0.05\n"
    linkage = parse(f"{find('juki-mf7923d').read_text()}\n{text}", "mine", "mine.toml", None)
    found = Released(Mechanism(linkage), linkage.released["mine"])
    told = sentences(found)
    assert told[0] == f"Its torque changes with {words}."
    assert not any("rest" in line or "fixed step" in line for line in told)
