"""From the words of the command line to a campaign's request, every name checked before anything runs."""

from __future__ import annotations

import math
import shlex
from collections import Counter
from collections.abc import Mapping, Sequence
from contextlib import AbstractContextManager
from dataclasses import dataclass, replace
from pathlib import Path

from analytic.description.changes import without
from analytic.description.linkage import Linkage
from analytic.description.loading import LinkageFile, catalogue, load, read
from analytic.errors import LinkproofError, UnknownNameError, printable
from analytic.machine_code.compiling import cores
from comparisons.campaign.campaign import CampaignRequest
from comparisons.runs.cluster.connecting import check_scheduler, opened
from comparisons.runs.failures import GIB
from comparisons.runs.plugins import engines as adapters
from comparisons.runs.workers import DEFAULT_BOUNDS, Bounds, LocalPool, Pool
from engines.contract import Setting
from engines.registry import engine_names, why_unavailable
from reports.command_line.linear_drive import prescribed
from reports.command_line.motion_choice import MotionChoice
from reports.command_line.motions import EVERYTHING, own_regimes

DEEPEST_FOLDER = 5  # by which files of one name are told apart


@dataclass(frozen=True)
class CampaignChoice(MotionChoice):
    """What was asked for, in the user's words: names, rpm, seconds and degrees; empty means the default."""

    mechanisms: tuple[str, ...] = ()
    engines: tuple[str, ...] = ()
    settings: tuple[str, ...] = ()
    quantities: tuple[str, ...] = ()
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
        return {**super().flags, "full": self.full}


def command_line(
    command: str, words: Sequence[str], options: Mapping[str, Sequence[str]], flags: Mapping[str, bool]
) -> str:
    """A command as a user types it: its words, options with their values, and the flags that are set."""
    told = [word for name, values in options.items() for value in values for word in (f"--{name}", value)]
    return shlex.join(["linkproof", command, *words, *told, *(f"--{name}" for name, given in flags.items() if given)])


@dataclass(frozen=True)
class RunLimits:
    """What each run may take, s and GiB, and in how many worker processes runs are made; None means the default.

    A ``scheduler`` of Dask, as ``comparisons.runs.cluster.connecting.opened`` takes it, has its workers make them.
    """

    time_limit: float | None = None
    memory_limit: float | None = None
    jobs: int | None = None
    scheduler: object = None

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
                    f"{option} applies to worker processes, but --jobs 0 starts none: leave one of the two out"
                )
        if self.jobs is not None and self.jobs < 0:
            raise LinkproofError(f"--jobs: expected a number of processes, or 0 for none, got {self.jobs}")
        if self.jobs is not None and self.scheduler is not None:
            raise LinkproofError("--jobs and --scheduler exclude each other: leave one of them out")
        check_scheduler(self.scheduler)

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

    def pool(self) -> AbstractContextManager[Pool]:
        """Where runs are made; raises LinkproofError where they cannot be."""
        return opened(self.scheduler, LocalPool(self.processes))

    @property
    def words(self) -> str:
        """The options that results may depend on, as they follow a command."""
        limits = (("--time-limit", self.time_limit), ("--memory-limit", self.memory_limit))
        return "".join(f" {option} {value:g}" for option, value in limits if value is not None)


def files(choice: CampaignChoice) -> list[LinkageFile]:
    """The files of the linkages asked for; all of the catalogue that have the variant, where none is named.

    Files of one name from different folders have the names of folders before theirs, as many as tell them apart.
    """
    names = tuple(dict.fromkeys(choice.mechanisms or having(catalogue(), choice.variant)))
    found = [read(name) for name in names]
    own = [file.name for file in found]
    for depth in range(1, DEEPEST_FOLDER + 1):
        counts = Counter(file.name for file in found)
        found = [
            replace(file, name=printable("-".join((*Path(path).resolve().parent.parts[-depth:], name))))
            if counts[file.name] > 1 and Path(path).suffix
            else file
            for path, name, file in zip(names, own, found, strict=True)
        ]
    return found


def having(names: Sequence[str], variant: str | None) -> tuple[str, ...]:
    """Of several linkages those that have a variant; all of them where none has."""
    return tuple(name for name in names if variant is None or variant in load(name).variants) or tuple(names)


def linkages(choice: CampaignChoice) -> tuple[Linkage, ...]:
    """The linkages of ``files``, in the variant and under the gravity asked for."""
    chosen = [file.linkage(choice.variant) for file in files(choice)]
    _check_names_differ(chosen)
    return tuple(chosen if choice.gravity else [without(linkage, "gravity") for linkage in chosen])


def _check_names_differ(chosen: list[Linkage]) -> None:
    seen: set[str] = set()
    for linkage in chosen:
        if linkage.name in seen:
            raise LinkproofError(f"two linkage files are both called '{linkage.name}': rename one of them")
        seen.add(linkage.name)


def installed(engines: Sequence[str]) -> list[str]:
    """Those of the engines that are installed."""
    return [name for name, one in zip(engines, adapters(engines), strict=True) if why_unavailable(one) is None]


def named(engines: Sequence[str]) -> tuple[str, ...]:
    """Engines that are asked for by name, each once; raises LinkproofError for one that cannot be used here."""
    for adapter in adapters(engines):
        absent = why_unavailable(adapter)
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


def request(choice: CampaignChoice, known: Sequence[Linkage] = ()) -> CampaignRequest:
    """The campaign's request; raises LinkproofError for anything that does not exist or cannot be.

    Regimes that other ``known`` linkages define may be asked for: those that do not define them are not run in them.
    """
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
        own_regimes=own_regimes(choice, (*found, *known)),
        own_settings=_own_settings(choice),
        with_invariants=not choice.quantities,
    )
