"""From the words of the command line to a campaign's request, every name checked before anything runs."""

from __future__ import annotations

import math
import shlex
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from analytic.compiled.choice import cores
from analytic.description.changes import without
from analytic.description.linkage import Linkage
from analytic.description.loading import LinkageFile, catalogue, read
from analytic.errors import LinkproofError, UnknownNameError, printable
from comparisons.campaign.campaign import CampaignRequest
from comparisons.runs.failures import GIB
from comparisons.runs.workers import DEFAULT_BOUNDS, Bounds
from engines.contract import Setting
from engines.registry import engine, engine_names, why_unavailable
from reports.command_line.linear_drive import prescribed
from reports.command_line.motion_choice import EVERYTHING, MotionChoice, own_regimes


@dataclass(frozen=True)
class CampaignChoice(MotionChoice):
    """What was asked for, in the user's words: names, rpm, seconds and degrees; empty means the default."""

    mechanisms: tuple[str, ...] = ()
    engines: tuple[str, ...] = ()
    settings: tuple[str, ...] = ()
    quantities: tuple[str, ...] = ()
    gravity: bool = True
    full: bool = False

    @property
    def command(self) -> str:
        """The command that asks for the same."""
        return self.written("compare")

    def written(self, command: str) -> str:
        """The same by another command."""
        lists = {
            **{"variant": (), "regime": ()},  # which stand first
            "engine": self.engines,
            "setting": self.settings,
            "quantity": self.quantities,
            **self.words,
        }
        return command_line(command, self.mechanisms, lists, self.flags)

    @property
    def flags(self) -> dict[str, bool]:
        """Options without a value, and whether they are set."""
        return {"clockwise": self.clockwise, "no-gravity": not self.gravity, "full": self.full}


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
    files = _told_apart(names, [read(name) for name in names])
    if choice.variant is not None and not choice.mechanisms:
        files = [file for file in files if choice.variant in file.linkage().variants] or files
    chosen = [file.linkage(choice.variant) for file in files]
    _check_names_differ(chosen)
    return tuple(chosen if choice.gravity else [without(linkage, "gravity") for linkage in chosen])


def _told_apart(names: Sequence[str], files: list[LinkageFile]) -> list[LinkageFile]:
    """Files of one name from different folders, each with its folder's name before its own."""
    counts = Counter(file.name for file in files)
    return [
        replace(file, name=printable(f"{Path(name).resolve().parent.name}-{file.name}"))
        if counts[file.name] > 1 and Path(name).suffix
        else file
        for name, file in zip(names, files, strict=True)
    ]


def _check_names_differ(chosen: list[Linkage]) -> None:
    seen: set[str] = set()
    for linkage in chosen:
        if linkage.name in seen:
            raise LinkproofError(f"two linkage files are both called '{linkage.name}': rename one of them")
        seen.add(linkage.name)


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
    motions, conditions = prescribed(choice, found)
    return CampaignRequest(
        linkages=found,
        motions=motions,
        conditions=conditions,
        engines=_engines(choice),
        settings=_settings(choice),
        quantities=tuple(dict.fromkeys(choice.quantities)),
        own_regimes=own_regimes(choice, found),
        own_settings=_own_settings(choice),
        with_invariants=not choice.quantities,
    )
