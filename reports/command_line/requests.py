"""From the words of the command line to a campaign's request, every name checked before anything runs."""

from __future__ import annotations

import math
import shlex
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from analytic.compiled.choice import cores
from analytic.description.changes import without
from analytic.description.crank_motion import LARGEST, RAMPS, REGIMES, RPM, CrankMotion, crank_motion
from analytic.description.linkage import Linkage
from analytic.description.loading import catalogue, read
from analytic.errors import LinkproofError, UnknownNameError
from comparisons.campaign.campaign import CampaignRequest
from comparisons.runs.failures import GIB
from comparisons.runs.workers import DEFAULT_BOUNDS, Bounds
from engines.contract import Setting
from engines.registry import engine, engine_names, why_unavailable

EVERYTHING = "all"
OWN = "own"  # every regime that a linkage defines for itself


@dataclass(frozen=True)
class CampaignChoice:
    """What was asked for, in the user's words: names, rpm, seconds and degrees; empty means the default."""

    mechanisms: tuple[str, ...] = ()
    variant: str | None = None
    regimes: tuple[str, ...] = ()
    engines: tuple[str, ...] = ()
    settings: tuple[str, ...] = ()
    quantities: tuple[str, ...] = ()
    speed: float = 1000.0
    ramp_time: float = 0.6
    hold_time: float = 0.1
    start_angle: float = 0.0
    clockwise: bool = False
    gravity: bool = True
    full: bool = False

    @property
    def conditions(self) -> str:
        """Speed, direction, times and start angle in words; gravity is the linkages'."""
        direction = "clockwise" if self.clockwise else "counter-clockwise"
        return (
            f"{self.speed:g} rpm {direction}, {self.ramp_time:g} s + {self.hold_time:g} s, from {self.start_angle:g}°"
        )

    @property
    def command(self) -> str:
        """The command that asks for the same."""
        return self.written("compare")

    def written(self, command: str) -> str:
        """The same by another command."""
        lists = {
            "variant": [self.variant] if self.variant else [],
            "regime": self.regimes,
            "engine": self.engines,
            "setting": self.settings,
            "quantity": self.quantities,
        }
        default = CampaignChoice()
        for name in ("speed", "ramp_time", "hold_time", "start_angle"):
            if getattr(self, name) != getattr(default, name):
                lists[name.replace("_", "-")] = [repr(getattr(self, name)).removesuffix(".0")]
        flags = {"clockwise": self.clockwise, "no-gravity": not self.gravity, "full": self.full}
        return command_line(command, self.mechanisms, lists, flags)

    def check(self) -> None:
        """Raise LinkproofError for a speed, time or angle that cannot be, in the unit it is given in."""
        ramps = EVERYTHING in self.regimes or not self.regimes or {*self.regimes} & {*RAMPS}
        _check("--speed", self.speed, "rpm", 1.0 / LARGEST, LARGEST / RPM)
        _check("--ramp-time", self.ramp_time, "s", 1.0 / LARGEST if ramps else 0.0)
        _check("--hold-time", self.hold_time, "s", 0.0)
        _check("--start-angle", self.start_angle, "degrees", -LARGEST)
        if not ramps and "constant-speed" in self.regimes and self.ramp_time + self.hold_time <= 0.0:
            raise LinkproofError("--hold-time: expected a positive number of s without a ramp time, got 0; correct it")


def _check(option: str, value: float, unit: str, least: float, most: float = LARGEST) -> None:
    if least <= value <= most:  # nan is not
        return
    kind = "positive finite" if least > 0.0 else "finite" if least else "finite, not negative"
    bound = f" up to {most:.3g}" if most < value < math.inf else ""
    raise LinkproofError(f"{option}: expected a {kind} number of {unit}{bound}, got {value:g}; correct it")


def command_line(
    command: str, words: Sequence[str], options: Mapping[str, Sequence[str]], flags: Mapping[str, bool]
) -> str:
    """A command as a user types it: its words, options with their values, and the flags that are set."""
    told = [word for name, values in options.items() for value in values for word in (f"--{name}", value)]
    return shlex.join(["linkproof", command, *words, *told, *(f"--{name}" for name, given in flags.items() if given)])


@dataclass(frozen=True)
class RunLimits:
    """What each run may take, s and GiB, and in how many worker processes runs are made; None means the default."""

    time_limit: float | None = None
    memory_limit: float | None = None
    jobs: int | None = None

    def check(self) -> None:
        """Raise LinkproofError for what cannot be."""
        for option, value, unit in (
            ("--time-limit", self.time_limit, "s"),
            ("--memory-limit", self.memory_limit, "GiB"),
        ):
            if value is not None and not 0.0 < value < math.inf:
                raise LinkproofError(f"{option}: expected a positive finite number of {unit}, got {value:g}")
            if value is not None and self.jobs == 0:
                raise LinkproofError(
                    f"{option} holds for worker processes, and --jobs 0 asks for none: leave one of the two out"
                )
        if self.jobs is not None and self.jobs < 0:
            raise LinkproofError(f"--jobs: expected a number of processes, or 0 for none, got {self.jobs}")

    @property
    def bounds(self) -> Bounds:
        """What each run may take."""
        return Bounds(
            DEFAULT_BOUNDS.seconds if self.time_limit is None else self.time_limit,
            DEFAULT_BOUNDS.memory if self.memory_limit is None else round(self.memory_limit * GIB),
        )

    @property
    def processes(self) -> int:
        """Worker processes; the cores by default, even for a single run, which is kept apart from the command too."""
        return cores() if self.jobs is None else self.jobs

    @property
    def words(self) -> str:
        """The options that results may depend on, as they follow a command."""
        limits = (("--time-limit", self.time_limit), ("--memory-limit", self.memory_limit))
        return "".join(f" {option} {value:g}" for option, value in limits if value is not None)


def linkages(choice: CampaignChoice) -> tuple[Linkage, ...]:
    """The linkages asked for; all of the catalogue that have the variant, where none is named."""
    names = tuple(dict.fromkeys(choice.mechanisms or catalogue()))
    files = [read(name) for name in names]
    if choice.variant is not None and not choice.mechanisms:
        files = [file for file in files if choice.variant in file.linkage().variants] or files
    chosen = [file.linkage(choice.variant) for file in files]
    _check_names_differ(chosen)
    return tuple(chosen if choice.gravity else [without(linkage, "gravity") for linkage in chosen])


def _check_names_differ(chosen: list[Linkage]) -> None:
    seen: set[str] = set()
    for linkage in chosen:
        if linkage.name in seen:
            raise LinkproofError(f"two linkage files are both called '{linkage.name}': rename one of them")
        seen.add(linkage.name)


def motions(choice: CampaignChoice) -> tuple[CrankMotion, ...]:
    """The prescribed crank motions asked for."""
    names = REGIMES if EVERYTHING in choice.regimes else choice.regimes or ("run-up",)
    return tuple(
        crank_motion(
            name,
            speed=choice.speed * RPM,
            ramp_time=choice.ramp_time,
            hold_time=choice.hold_time,
            clockwise=choice.clockwise,
            start_angle=math.radians(choice.start_angle),
        )
        for name in dict.fromkeys(names)
        if name in REGIMES
    )


def own_regimes(choice: CampaignChoice, found: tuple[Linkage, ...]) -> tuple[str, ...]:
    """Regimes asked for that the linkages define for themselves; ``own`` and ``all`` ask for every one of them."""
    known = sorted({regime.name for linkage in found for regime in linkage.regimes})
    for name in choice.regimes:
        if name not in (*REGIMES, *known, OWN, EVERYTHING):
            raise UnknownNameError("regime", name, [*REGIMES, *known, OWN, EVERYTHING])
    if {OWN, EVERYTHING} & set(choice.regimes):
        return tuple(known)
    return tuple(name for name in known if name in choice.regimes)


def installed(engines: Sequence[str]) -> list[str]:
    """Those of the engines that are installed."""
    return [name for name in engines if why_unavailable(engine(name)) is None]


def named(engines: Sequence[str]) -> tuple[str, ...]:
    """Engines that are asked for by name, each once; raises LinkproofError for one that cannot be used here."""
    for name in engines:
        absent = why_unavailable(engine(name))
        if absent is not None:
            raise LinkproofError(f"{absent}; or leave it out")
    return tuple(dict.fromkeys(engines))


def _engines(choice: CampaignChoice) -> tuple[str, ...]:
    """Engine names; one that is named and cannot be used is an error, one of the default set is a record."""
    return named(choice.engines) or engine_names()


def _settings(choice: CampaignChoice) -> tuple[Setting, ...]:
    if EVERYTHING in choice.settings:
        return tuple(Setting)
    for name in choice.settings:
        if name not in list(Setting):
            raise UnknownNameError("setting", name, [*Setting, EVERYTHING])
    return tuple(Setting(name) for name in dict.fromkeys(choice.settings)) or (Setting.TUNED,)


def _own_settings(choice: CampaignChoice) -> tuple[Setting, ...]:
    """Settings of the linkages' own regimes: those named; of all, tuned alone unless all of them are asked for."""
    return _settings(choice) if choice.full or EVERYTHING not in choice.settings else (Setting.TUNED,)


def request(choice: CampaignChoice) -> CampaignRequest:
    """The campaign's request; raises LinkproofError for anything that does not exist or cannot be."""
    choice.check()
    found = linkages(choice)
    return CampaignRequest(
        linkages=found,
        motions=motions(choice),
        conditions=choice.conditions,
        engines=_engines(choice),
        settings=_settings(choice),
        quantities=tuple(dict.fromkeys(choice.quantities)),
        own_regimes=own_regimes(choice, found),
        own_settings=_own_settings(choice),
        with_invariants=not choice.quantities,
    )
