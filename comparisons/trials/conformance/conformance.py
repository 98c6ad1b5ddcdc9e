"""The conformance test of an engine: checks of its conduct and channels, then every mutant, in a report's order."""

from __future__ import annotations

import math
import pickle
import tempfile
from collections.abc import Callable, Mapping
from contextlib import redirect_stderr, redirect_stdout, suppress
from dataclasses import replace
from functools import lru_cache, partial
from itertools import groupby
from typing import Any, Final, get_args

import numpy as np

from analytic.description.law import FULL_TURN
from comparisons.trials.conformance.slips import MUTANT, MUTANT_CHECKS, likeliest_misreading
from comparisons.trials.conformance.trial import (
    PLAIN,
    SAMPLES,
    CheckResult,
    EngineCheck,
    EngineTrial,
    Finding,
    NotTestedError,
    case,
    scene_of,
)
from comparisons.trials.judging.limits import limit
from comparisons.trials.judging.signal_errors import SignalError, readings, signal_errors
from comparisons.trials.observed_motion import DENSE
from comparisons.trials.runs.run_engine import AdapterError, Failure, Lost, RunBounds, blamed_on, run_engine
from comparisons.trials.runs.workers import LocalPool
from engines.contract import Engine, Origin, Outcome, Setting, signal_words
from engines.registry import Unusable, check_adapter, silenced
from engines.scene import GUIDES, Channel, Drive, Load, Prescribed, Scene

# Whose limit a channel of every body and joint has: that of the quantity read from it.
LIMIT_QUANTITIES = {
    Channel.POSITION: "S",
    Channel.VELOCITY: "v",
    Channel.ACCELERATION: "a",
    Channel.TORQUE: "Mkr",
    Channel.JOINT_FORCE: "joint_force",
}
ROUNDING_FACTOR = 1.0 + 1e-6
CAUSES = "a mass, a load, a geometry, the drive's phase, too long a step, or too few iterations of the solver"
FEW = 0.02  # of all samples: an error of so few is of a place in the motion, not of a mass or a sign
BESIDE = 4  # samples from the start, or from where two parts meet


def check_channel(channel: Channel, trial: EngineTrial) -> None:
    """Raise AssertionError where a channel of a sample is off the closed form by more than the limit of ``tuned``.

    So too where a sample's run does not finish or has not recorded it. Raises NotTestedError if the engine does not
    offer it or take the plain sample, or no sample has it, AdapterError where the adapter raises.
    """
    if channel not in trial.engine.abilities.readouts:
        raise NotTestedError(f"{trial.engine.name} offers no {channel.value}")
    is_compared = False
    for sample, scene, history in trial.histories():
        if channel is Channel.TORQUE and not isinstance(scene.drive, Prescribed):
            continue
        errors = [error for error in signal_errors(case(sample), scene, history) if error.read.channel is channel]
        assert errors, f"expected a {channel.value} in sample '{sample}', got none: record it, its abilities offer it"
        is_compared = True
        regime = case(sample).motion.regime
        bound = limit(LIMIT_QUANTITIES[channel], Setting.TUNED, regime, trial.engine.name).value
        worst = max(errors, key=lambda error: error.largest)
        if not worst.largest <= bound:
            raise AssertionError(
                f"{worst.read.words}, sample '{sample}': expected the closed form within {bound:.0e} "
                f"{worst.scale_words}, got {_error_words(worst, bound)}"
            )
    if not is_compared:
        raise NotTestedError(f"no sample of the conformance test has a {channel.value} for {trial.engine.name}")


def _error_words(worst: SignalError, bound: float) -> str:
    """Words on a signal's largest error, its time, the samples over the ``bound``, and the likeliest cause.

    ``bound`` is a share of the error's scale.
    """
    reading, time, over = worst.read, worst.read.time, np.flatnonzero(~(worst.sizes <= bound))
    words = f"{worst.largest:.2g} off at t = {worst.worst_time:.4g} s"
    if len(over) > FEW * len(time):
        cause = likeliest_misreading(worst.true, reading.values) or CAUSES
        return f"{words}, {len(over)} of {len(time)} samples over it; {cause}"
    drive, first, last = reading.scene.drive, time[over[0]], time[over[-1]]
    starts = [segment.start for segment in drive.motion.segments[1:]] if isinstance(drive, Prescribed) else []
    if over[-1] < BESIDE:
        cause = "look at the start velocities, and at what the first step leaves out"
    elif any(abs(first - start) + abs(last - start) <= 2 * BESIDE * np.max(np.diff(time)) for start in starts):
        cause = "two parts of the motion meet there: look at what the loop does where a part begins"
    else:
        cause = "look at these instants: parts may meet there, or a solver give up"
    return f"{words}, {len(over)} of {len(time)} samples over it; the rest is within; {cause}"


def check_samples(trial: EngineTrial) -> None:
    """Raise AssertionError unless sample times increase, none beyond the motion's end, densely enough to read between.

    That is ``DENSE`` samples per turn of the peak speed. Raises NotTestedError where the engine does not take the plain
    sample, AssertionError also where a run does not finish, AdapterError where the adapter raises.
    """
    for sample, scene, history in trial.histories():
        motion = case(sample).motion
        for reading in readings(scene, history):
            words, gaps = f"{reading.words}, sample '{sample}'", np.diff(reading.time)
            assert np.all(gaps > 0.0), (
                f"{words}: expected increasing times, got {reading.time[int(np.argmin(gaps))]:g} s twice: leave out "
                "what a fresh start repeats"
            )
            turn, longest = FULL_TURN / motion.peak_speed, float(gaps.max())
            assert longest * DENSE <= turn * ROUNDING_FACTOR, (
                f"{words}: expected {DENSE} samples per turn or more, got {turn / longest:.0f}: give the recipe more "
                "steps per turn"
            )
            assert reading.time[-1] <= motion.duration * ROUNDING_FACTOR, (
                f"{words}: expected samples up to {motion.duration:g} s, got {reading.time[-1]:g} s"
            )


def check_identity(trial: EngineTrial) -> None:
    """Raise AssertionError unless name, version and abilities are as the contract requires.

    Raises AdapterError where these are of other types or the adapter raises.
    """
    with blamed_on(trial.engine):
        check_adapter(trial.engine)
    can = trial.engine.abilities
    assert can.readouts, "expected the channels that are offered, got none: state what each is called in the engine"
    for channel, readout in can.readouts.items():
        assert all((readout.source, readout.frame, readout.instant)), (
            f"expected a ReadOut of {channel.value} with source, frame and instant, got {readout!r}: give all of them"
        )
    for name, known in (("drives", get_args(Drive)), ("joints", GUIDES), ("loads", get_args(Load))):
        surplus = getattr(can, name) - frozenset(known)
        assert not surplus, f"expected {name} of the contract in the abilities, got {surplus}: name none but those"


def check_installed(trial: EngineTrial) -> None:
    """Raise AssertionError unless the engine finishes the plain sample, on which all other checks rest.

    Raises NotTestedError where it is not installed, AdapterError where the adapter raises.
    """
    trial.finished_history(PLAIN, trial.setting)


def check_refusals(trial: EngineTrial) -> None:
    """Raise AssertionError unless a scene beyond the engine's abilities is refused as unsupported, with a reason.

    Nor may it have a history. Raises NotTestedError where its abilities cover everything, AdapterError where the
    adapter raises.
    """
    unsupported = [(sample, trial.setting) for sample in SAMPLES if trial.obstacle(sample) is not None]
    unsupported += [(PLAIN, setting) for setting in Setting if setting not in trial.engine.abilities.settings]
    if not unsupported:
        raise NotTestedError("its abilities cover every sample and setting")
    for sample, setting in unsupported:
        with blamed_on(trial.engine):
            run = trial.engine.run(scene_of(sample), setting)
        words = f"sample '{sample}' in setting '{setting}', which is beyond its abilities"
        assert run.outcome is Outcome.UNSUPPORTED, f"{words}: expected 'unsupported', got '{run.outcome}': refuse it"
        assert run.reason.strip(), f"{words}: expected a reason, got none: state in one sentence what is not supported"
        assert run.history is None, f"{words}: expected no history, got one: a refused scene is not stepped"


def check_claims(trial: EngineTrial) -> None:
    """Raise AssertionError unless every sample within its abilities is run to its end.

    Raises NotTestedError, with the reasons, if it refuses some for reasons that its abilities cannot state,
    AdapterError where the adapter raises.
    """
    refused = []
    for sample in SAMPLES:
        try:
            trial.finished_history(sample)
        except NotTestedError as reason:
            refused += [] if trial.obstacle(sample) else [str(reason)]
    if refused:
        raise NotTestedError("; ".join(refused))


def _with_first_body(scene: Scene, **changes: object) -> Scene:
    """A copy of a scene with other fields of its first body; ``changes`` are their values by name."""
    return replace(scene, bodies=(replace(scene.bodies[0], **changes), *scene.bodies[1:]))  # type: ignore[arg-type]


def _with_first_pin(scene: Scene, **changes: object) -> Scene:
    """A copy of a scene with other fields of the pin that is last in it, which is moved to the front.

    ``changes`` are their values by name.
    """
    return replace(scene, pins=(replace(scene.pins[-1], **changes), *scene.pins[:-1]))  # type: ignore[arg-type]


# By fault in words: the change of a scene that no engine may run.
NAN: Final = float("nan")
BAD_SCENES: Final[Mapping[str, Callable[[Scene], Scene]]] = {
    "a mass that is nan": partial(_with_first_body, mass=NAN),
    "a negative mass": partial(_with_first_body, mass=-1.0),
    "an inertia that is nan": partial(_with_first_body, inertia=NAN),
    "a position that is nan": partial(_with_first_body, position=(NAN, 0.0)),
    "a velocity that is infinite": partial(_with_first_body, velocity=(0.0, math.inf)),
    "a pin that is open by half a metre": partial(_with_first_pin, first_anchor=(0.5, 0.5)),
    "a pin on a body that is not there": partial(_with_first_pin, first="nobody"),
    "gravity that is nan": lambda scene: replace(scene, gravity=(NAN, 0.0)),
    "a crank that is not there": lambda scene: replace(scene, crank="nobody"),
}


def check_bad_data(trial: EngineTrial) -> None:
    """Raise AssertionError unless unusable data give an outcome with a reason, without an exception or a crash.

    Raises AdapterError for an exception of the adapter.
    """
    for words, spoil in BAD_SCENES.items():
        run = run_engine(trial.engine, spoil(scene_of(PLAIN)), trial.setting)
        assert run.outcome is not Outcome.FINISHED, (
            f"{words}: expected an outcome with a reason, got a finished run: look at the data before the engine does "
            "(engines.mechanics.start_check.data_obstacle)"
        )
        assert run.reason.strip(), f"{words}: expected a reason, got none: state in one sentence what is wrong"


def check_recording(trial: EngineTrial) -> None:
    """Raise AssertionError unless exactly the requested and offered channels are recorded, and this changes no step.

    Each channel is requested alone, of the plain sample in ``tuned``. Raises AdapterError where the adapter raises.
    """
    steps = trial.run(PLAIN).steps
    for channel in Channel:
        scene = case(PLAIN).scene(frozenset({channel}))
        run = run_engine(trial.engine, scene, Setting.TUNED)
        words = f"only {channel.value} requested"
        assert run.history is not None, f"{words}: expected a finished run, got {run.outcome}: {run.reason}"
        recorded = {reading.channel for reading in readings(scene, run.history)}
        expected = {channel} & trial.engine.abilities.readouts.keys()
        surplus = ", ".join(sorted(recorded - expected))
        assert not surplus, f"{words}: expected no {surplus}, got it: leave it out"
        assert recorded == expected, f"{words}: expected it, got none: record it"
        assert run.steps == steps, (
            f"{words}: expected the {steps} steps of a run with every channel, got {run.steps}: choose the steps by "
            "the scene alone"
        )


def check_repetition(trial: EngineTrial) -> None:
    """Raise AssertionError unless two runs of the plain sample in ``tuned`` agree to the last bit.

    Raises NotTestedError where the engine has no such run, AdapterError where the adapter raises.
    """
    first, second = trial.finished_history(PLAIN), run_engine(trial.engine, scene_of(PLAIN), Setting.TUNED).history
    assert second is not None, "expected a second run to finish, as the first one does: build the world anew"
    pairs = zip(readings(scene_of(PLAIN), first), readings(scene_of(PLAIN), second), strict=True)
    for reading, other in pairs:
        assert np.array_equal(reading.time, other.time) and np.array_equal(reading.values, other.values), (  # noqa: PT018
            f"{reading.words}: expected the same values from a second run, got others: build the world anew, without "
            "random numbers, threads or what a former run left"
        )


def check_settings(trial: EngineTrial) -> None:
    """Raise AssertionError unless every setting that is claimed runs to its end under every drive that is claimed.

    The drives are those of the plain and of the released sample. Raises AdapterError where the adapter raises.
    """
    for sample in (sample for sample in (PLAIN, "released") if trial.obstacle(sample) is None):
        for setting in sorted(trial.engine.abilities.settings):
            run = trial.run(sample, setting)
            assert run.outcome is Outcome.FINISHED, (
                f"setting '{setting}' of sample '{sample}': expected a finished run, got {run.outcome}: {run.reason}; "
                "correct it, or leave it out of the abilities"
            )


def check_origins(trial: EngineTrial) -> None:
    """Raise AssertionError unless ``naive`` and ``tuned`` are one run each, with origins to match, on the plain sample.

    Values of several runs must not be labelled as read, nor those of one as extrapolated. Raises AdapterError where the
    adapter raises.
    """
    for setting in sorted(trial.engine.abilities.settings):
        run, is_single = trial.run(PLAIN, setting), setting is not Setting.BEST
        assert not is_single or len(run.passes) <= 1, (
            f"setting '{setting}': expected one run of the engine, got {len(run.passes)}: extrapolate in 'best' alone"
        )
        signals = run.history.signals if run.history is not None else {}
        for key, signal in signals.items():
            words, origin = signal_words(*key), signal.origin
            assert not is_single or origin is not Origin.EXTRAPOLATED, (
                f"{words} in setting '{setting}': expected 'read' or 'computed', got '{origin}': nothing can be "
                "extrapolated from one run"
            )
            assert len(run.passes) <= 1 or origin is not Origin.READ, (
                f"{words} in setting '{setting}': expected 'extrapolated' of what {len(run.passes)} runs make, got "
                "'read': label it so"
            )


def check_silence(trial: EngineTrial) -> None:
    """Raise AssertionError if a run, made or refused, writes to standard output or error, be it by C code.

    What it writes is caught and not shown. The made one is of the plain sample; raises AdapterError where the adapter
    raises in it.
    """
    with tempfile.NamedTemporaryFile("a+") as written:
        with silenced(written.name), redirect_stdout(written), redirect_stderr(written):
            run_engine(trial.engine, scene_of(PLAIN), trial.setting)
            with suppress(AdapterError):  # which another check names
                run_engine(trial.engine, BAD_SCENES["a mass that is nan"](scene_of(PLAIN)), trial.setting)
        written.seek(0)
        text = written.read().strip()
    assert not text, f"expected silence, got {text[:80]!r}: chatters = True has a SteppedEngine's C output sent nowhere"


# The test: every check in a worker process.


INSTALLED: Final = "installed"
FIRST: Final = ("identity", INSTALLED)  # without a name and one finished run no other check has a meaning
BOUNDS = RunBounds(seconds=120.0)
_CHECKS: Final = (
    EngineCheck("identity", "name, version and abilities", check_identity),
    EngineCheck("installed", "the engine can be used, and finishes a run", check_installed),
    EngineCheck("bad data", "an outcome with a reason, nothing raised, no process dead", check_bad_data),
    EngineCheck("refusals", "a scene beyond its abilities is unsupported, with a reason", check_refusals),
    EngineCheck("claims", "every sample within its abilities is run", check_claims),
    EngineCheck("settings", "every setting it claims runs", check_settings),
    EngineCheck(
        "origins", "naive and tuned are one run; a value from several runs is not labelled as read", check_origins
    ),
    EngineCheck("recording", "only the requested channels are recorded; recording changes no step", check_recording),
    EngineCheck("repetition", "two runs are the same", check_repetition),
    EngineCheck("silence", "nothing is written to the terminal", check_silence),
    EngineCheck("samples", "sample times increase and cover the motion densely", check_samples),
    *(
        EngineCheck(name, f"the closed form's: {about}", partial(check_channel, channel))
        for name, channel, about in (
            ("positions", Channel.POSITION, "mass centres and angles in the ground frame"),
            ("velocities", Channel.VELOCITY, "at the stated instants"),
            ("accelerations", Channel.ACCELERATION, "at the stated instants, without subtracting gravity"),
            ("drive torque", Channel.TORQUE, "the torque of the drive on the crank"),
            ("joint forces", Channel.JOINT_FORCE, "on each joint's first body, in the ground frame"),
        )
    ),
    *MUTANT_CHECKS,
)
CHECKS: Final[Mapping[str, EngineCheck]] = {check.name: check for check in _CHECKS}


def examine(pickled: bytes, name: str) -> CheckResult:
    """The result of the check of this name, made with a pickled engine in this process, which keeps its runs.

    Raises KeyError for another name, and any exception that ``EngineCheck.result`` does not report.
    """
    return CHECKS[name].result(_unpickle_trial(pickled))


@lru_cache(maxsize=1)
def _unpickle_trial(engine: bytes) -> EngineTrial:
    """The trial of a worker's engine, the same object for all jobs with this pickle, so that they share its runs.

    Only the last one is kept.
    """
    return EngineTrial(pickle.loads(engine))


def run_in_workers(engine: Engine, names: list[str], processes: int | None = None) -> list[CheckResult]:
    """The results of checks by name, in their order, made in worker processes; a check that brings one down has failed.

    ``processes`` is their number, as many as cores by default, 0 for this process. Of an engine that cannot be pickled
    nothing is tested. Raises LinkproofError where no worker can start.
    """
    try:
        pickled = pickle.dumps(engine)
    except Exception:
        reason = "the engine cannot be sent to another process: let its class stand in a module of its own"
        return [CheckResult(name, Finding.NOT_TESTED, reason) for name in names]
    jobs: list[tuple[Any, ...]] = [(pickled, name) for name in names]
    results = dict(LocalPool(processes).run(examine, jobs, bounds=BOUNDS))
    return [_check_result(name, results[number]) for number, name in enumerate(names)]


def _check_result(name: str, result: CheckResult | Lost) -> CheckResult:
    """The result of a check made in a worker: a failure, with the cure, if the worker was lost."""
    if not isinstance(result, Lost):
        return result
    gives_up = "end every run with an outcome and a reason"
    what, cure = {
        Failure.TIMED_OUT: ("it ", f": take fewer or cheaper steps, and {gives_up}"),
        Failure.CRASHED: ("its process ", f": {gives_up}"),
    }.get(result.outcome, ("", ""))
    return CheckResult(name, Finding.FAILED, f"{what}{result.reason}{cure}")


def with_expected(result: CheckResult, expected: Mapping[str, str]) -> CheckResult:
    """The result, as an expected failure if its check is in ``expected``; one there that passes becomes a failure.

    ``expected`` has the reasons by the checks' names. Any other result, one not tested too, comes back itself.
    """
    reason = expected.get(result.check)
    if reason is None:
        return result
    if result.finding is Finding.FAILED:
        return replace(result, finding=Finding.EXPECTED, detail=f"{reason} ({result.detail})")
    if result.finding is Finding.PASSED:
        detail = f"it passes, though it is expected to fail ({reason}): take it from the expected failures"
        return replace(result, finding=Finding.FAILED, detail=detail)
    return result


def check_engine(engine: Engine, processes: int | None = None) -> list[CheckResult]:
    """The results of all checks, each made in a worker process; nothing an engine does brings this one down.

    All others wait for what they rest on, ``FIRST``, and mutants for all others: each is tried once those before it
    pass, or fail as expected, so that one cause is named once. Of an adapter that cannot be loaded the result of
    ``INSTALLED`` is the only one; of an engine that is not installed none is tested. A name among the engine's
    ``expected_failures`` that no check has is a failure, too. ``processes`` is the number of workers, as many as cores
    by default. Raises LinkproofError where none can start.
    """
    if isinstance(engine, Unusable):
        return [CHECKS[INSTALLED].result(EngineTrial(engine))]
    expected: Mapping[str, str] = getattr(engine, "expected_failures", {})
    results = [
        CheckResult(name, Finding.FAILED, f"expected a check, got '{name}' among the expected failures: correct it")
        for name in expected
        if name not in CHECKS
    ]
    wrong = ""
    for _, stage in groupby(CHECKS, lambda name: (name in FIRST, name.startswith(MUTANT))):
        if wrong:
            reason = f"'{wrong}' fails: correct the engine first"
            results += [CheckResult(name, Finding.NOT_TESTED, reason) for name in stage]
            continue
        done = [with_expected(result, expected) for result in run_in_workers(engine, [*stage], processes)]
        wrong = next((result.check for result in done if result.finding is Finding.FAILED), "")
        results += done
    return results
