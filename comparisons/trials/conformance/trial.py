"""An engine under test: its runs of the samples, each made once, and the rows of the suite that they fail."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from enum import StrEnum
from functools import cache
from pathlib import Path
from typing import Final

from analytic.description.crank_motion import CONSTANT_SPEED, RPM, crank_motion
from analytic.description.linkage import ReleasedRegime
from analytic.description.loading import load
from analytic.kinematics.mechanism import Mechanism
from comparisons.motion.case import Case, case_of_file_regime
from comparisons.trials.campaign.campaign import compared
from comparisons.trials.judging.quantities import all_quantities
from comparisons.trials.judging.records import Verdict, run_of
from comparisons.trials.observed_motion import ObservedMotion
from comparisons.trials.runs.run_engine import AdapterError, blamed_on, run_engine
from engines.contract import Engine, History, Outcome, Run, Setting
from engines.mechanics.start_check import ability_obstacle
from engines.registry import why_unavailable
from engines.scene import Channel, Scene

LINKAGES = Path(__file__).with_name("linkages")
PLAIN: Final = "four-bar"  # what every engine has to take: pins, gravity and a prescribed crank
AT_SPEED: Final = "four-bar at speed"
SLIDER_AT_SPEED: Final = "slider-crank at speed"
SPEED: Final = 20.0  # rad/s: the loads by inertia are a few times those by gravity
RAMP, HOLD = 0.3, 0.33  # s: half a turn to reach the speed, one full turn at it
FAST: Final = 1000.0 * RPM  # at which the samples turn that do not start at rest: where motors are limited, it shows


@dataclass(frozen=True)
class Sample:
    """A variant of a linkage's file under one motion of its crank, in the file's own regime if it has one.

    ``start`` is the crank angle, degrees. ``released``: the crank is free under a torque. ``at_speed``: the crank
    starts at FAST and keeps it for a turn, while the other links accelerate from the first instant on.
    """

    linkage: str
    start: float = 0.0  # degrees
    variant: str | None = None
    clockwise: bool = False
    released: bool = False
    at_speed: bool = False

    @property
    def case(self) -> Case:
        """The case that the sample describes, made anew."""
        linkage, start = load(str(LINKAGES / f"{self.linkage}.toml"), self.variant), math.radians(self.start)
        if self.released or linkage.regimes:
            released = ReleasedRegime("released", 1.5, start, 6.0, 0.8)
            return case_of_file_regime(Mechanism(linkage), released if self.released else linkage.regimes[0])
        regime, speed, ramp = (CONSTANT_SPEED, FAST, 0.0) if self.at_speed else ("run-up-quintic", SPEED, RAMP)
        motion = crank_motion(
            regime,
            speed=speed,
            ramp_time=ramp,
            hold_time=HOLD * SPEED / speed,
            clockwise=self.clockwise,
            start_angle=start,
        )
        return Case(Mechanism(linkage), motion)


SAMPLES: Final[Mapping[str, Sample]] = {
    PLAIN: Sample("four-bar", 40.0),
    AT_SPEED: Sample("four-bar", at_speed=True),
    "four-bar clockwise": Sample("four-bar", -200.0, clockwise=True),
    "slider-crank": Sample("slider-crank", 20.0, clockwise=True),
    SLIDER_AT_SPEED: Sample("slider-crank", 20.0, at_speed=True),
    "quick return": Sample("quick-return", 75.0),
    **{
        load: Sample("four-bar", 40.0, load)
        for load in ("force", "force over the angle", "torque", "spring", "damper", "friction")
    },
    "driven slider": Sample("driven-slider"),
    "cylinder": Sample("cylinder"),
    "released": Sample("four-bar", 40.0, released=True),
}


@cache
def case(name: str) -> Case:
    """The case of a sample by name, shared by all callers, so that its closed form is computed once.

    Raises KeyError for another name.
    """
    return SAMPLES[name].case


# A check of the conformance test and its result.


class NotTestedError(Exception):
    """A check that cannot be made: the engine lacks a feature, or a hook for the test; the message gives the reason."""


class Finding(StrEnum):
    """Result of a check."""

    PASSED = "passed"
    FAILED = "failed"
    EXPECTED = "expected failure"
    NOT_TESTED = "not tested"


@dataclass(frozen=True)
class CheckResult:
    """A check's finding, with a sentence, ``detail``, wherever it did not pass."""

    check: str
    finding: Finding
    detail: str = ""


@dataclass(frozen=True)
class EngineCheck:
    """One property that an adapter must have; ``examine`` raises AssertionError, with a sentence, where it has not.

    ``about`` says in words what the property is.
    """

    name: str
    about: str
    examine: Callable[[EngineTrial], None]

    def result(self, trial: EngineTrial) -> CheckResult:
        """Result of the check, made in this process: passed, failed or not tested, with a sentence.

        An AssertionError and an AdapterError make it failed, a NotTestedError not tested; other exceptions are raised.
        """
        try:
            with blamed_on(trial.engine):
                reason = why_unavailable(trial.engine)
            if reason is not None:
                raise NotTestedError(reason)
            self.examine(trial)
        except AssertionError as failure:
            return CheckResult(self.name, Finding.FAILED, str(failure))
        except NotTestedError as reason:
            return CheckResult(self.name, Finding.NOT_TESTED, str(reason))
        except AdapterError as error:
            cure = ": correct it; a simulation that fails is a DivergedError, in a loop an ArithmeticError"
            return CheckResult(self.name, Finding.FAILED, f"{error}{cure if error.__cause__ else ''}")
        return CheckResult(self.name, Finding.PASSED)


ALL_CHANNELS: frozenset[Channel] = frozenset(Channel)


def scene_of(sample: str) -> Scene:
    """The scene of a sample by name, with all channels requested; raises KeyError for another name."""
    return case(sample).scene(ALL_CHANNELS)


class EngineTrial:
    """An engine under test, with its runs so far."""

    def __init__(self, engine: Engine) -> None:
        """An engine on trial; its runs are made on request and kept."""
        self.engine = engine
        self._runs: dict[tuple[str, Setting], Run] = {}
        self._rows: dict[tuple[str, Setting], Mapping[str, bool]] = {}

    @property
    def setting(self) -> Setting:
        """``tuned`` or, if the engine lacks it, the first of its settings by the alphabet."""
        settings = self.engine.abilities.settings
        return Setting.TUNED if Setting.TUNED in settings else min(settings, default=Setting.TUNED)

    def obstacle(self, sample: str) -> str | None:
        """The reason, by its abilities alone, why the engine cannot run a sample, named; None if it can."""
        return ability_obstacle(case(sample).scene(frozenset()), self.engine.abilities)

    def run(self, sample: str, setting: Setting = Setting.TUNED) -> Run:
        """The engine's run of a sample, by name, made once and kept, however it ended.

        Raises AdapterError where the adapter raises or violates the contract.
        """
        if (sample, setting) not in self._runs:
            self._runs[sample, setting] = run_engine(self.engine, scene_of(sample), setting)
        return self._runs[sample, setting]

    def finished_history(self, sample: str, setting: Setting = Setting.TUNED) -> History:
        """The history of a sample's run, which has to finish; the run is made once and kept.

        Raises NotTestedError where sample, setting or engine are not available, AssertionError for any other end,
        AdapterError where the adapter raises.
        """
        reason = self.obstacle(sample)
        if reason is None and setting not in self.engine.abilities.settings:
            reason = f"{self.engine.name} offers no setting '{setting}'"
        if reason is not None:
            raise NotTestedError(f"{sample}: {reason}")
        run = self.run(sample, setting)
        if run.outcome is Outcome.UNAVAILABLE or (run.outcome is Outcome.UNSUPPORTED and sample != PLAIN):
            raise NotTestedError(f"{sample}: {run.outcome}, {run.reason}")
        assert run.outcome is Outcome.FINISHED, (
            f"expected the run of sample '{sample}' in setting '{setting}' to finish, got {run.outcome}: {run.reason}; "
            "an adapter takes pins, gravity and a prescribed crank, and what its abilities name besides"
        )
        assert run.history is not None
        return run.history

    def histories(self) -> Iterator[tuple[str, Scene, History]]:
        """Yield name, scene and history of each sample that the engine takes, in ``tuned``.

        Raises NotTestedError where the plain one is not among them, AssertionError where a run does not finish,
        AdapterError where the adapter raises.
        """
        for sample in SAMPLES:
            try:
                yield sample, scene_of(sample), self.finished_history(sample)
            except NotTestedError:
                if sample == PLAIN:
                    raise

    def rows(self, sample: str, setting: Setting) -> Mapping[str, bool]:
        """Whether each judged row of the engine's run of a sample has failed, by quantity or check; joints in one row.

        The result is kept. Raises what ``finished_history`` raises.
        """
        if (sample, setting) not in self._rows:
            self._rows[sample, setting] = self.judged_rows(sample, setting, self.finished_history(sample, setting))
        return self._rows[sample, setting]

    def judged_rows(self, sample: str, setting: Setting, history: History) -> Mapping[str, bool]:
        """Whether each judged row of a ``history`` of a sample has failed, by quantity or invariant; joints in one row.

        Rows that share a part with the reference are left out. The limits are those of the setting.
        """
        of, motion = case(sample), ObservedMotion(scene_of(sample), history)
        run = compared(of, motion, all_quantities(of).values(), run_of(of, setting, self.engine.name), self.engine)
        failed: dict[str, bool] = {}
        for row in run.every:
            if Verdict(row.outcome).judged and row.error_max is not None and not row.shared:
                name = row.quantity.partition(":")[0]
                failed[name] = failed.get(name, False) or Verdict(row.outcome).failed
        return failed
