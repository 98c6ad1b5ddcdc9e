"""Designs of a sweep simulated in engines: their choice, and each engine's success over them."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from analytic.errors import AssemblyError, LinkproofError
from analytic.kinematics.mechanism import Mechanism
from comparisons.designs.parameters import design_file
from comparisons.designs.sweep import SweepRequest, sweep_block
from comparisons.judging.records import Record, Verdict

Array = NDArray[np.float64]

TRIES: Final = 20  # hypercubes drawn before designs that assemble are given up
MOST_CHANCE: Final = 0.05  # probability by chance above which a pattern is ignored


@dataclass(frozen=True)
class SimulatedDesigns:
    """``files`` of designs by name, and their ``numbers`` (designs,): parameters and figures, by name with unit.

    ``places`` count each design in its sweep.
    """

    files: Mapping[str, str]
    numbers: Mapping[str, Array]
    places: tuple[int, ...] = ()


@dataclass(frozen=True)
class TellingNumber:
    """The number by whose ``value`` failing designs are separated best: they lie ``below`` it, or at it, or above.

    ``failing`` and ``others`` have how many lie there, and of how many. ``chance`` is the likelihood of it by chance.
    """

    name: str
    below: bool
    value: float
    failing: tuple[int, int]
    others: tuple[int, int]
    chance: float


@dataclass(frozen=True)
class EngineOverDesigns:
    """An engine over the designs: names of those that it fails, and of those without a verdict.

    ``worst`` is the record with the largest share of its limit, or without a result.
    """

    engine: str
    designs: tuple[str, ...]
    failing: tuple[str, ...]
    not_judged: tuple[str, ...]
    worst: Record | None
    telling: TellingNumber | None

    @property
    def judged(self) -> int:
        """How many designs were judged."""
        return len(self.designs) - len(self.not_judged)

    @property
    def bound(self) -> float | None:
        """Upper bound, 95 % certain, of the share of failures: the rule of three; None where it failed, or for few."""
        return 3.0 / self.judged if self.judged > 3 and not self.failing else None


def simulated_designs(request: SweepRequest, count: int, seed: int) -> SimulatedDesigns:
    """So many designs of a sweep that assemble, fewer where it has no more: those of Latin hypercubes over its space.

    Raises LinkproofError if no design assembles.
    """
    from scipy.stats.qmc import LatinHypercube  # noqa: PLC0415 - a second that only a sample pays for

    space, mechanism = request.space, Mechanism(request.linkage)
    cube = LatinHypercube(len(space.shape), rng=seed)
    files: dict[str, str] = {}
    columns: list[Array] = []
    chosen: list[int] = []
    tried: set[int] = set()
    for _ in range(TRIES):
        places = (cube.random(min(count, space.count)) * space.shape).astype(int)
        numbers = np.ravel_multi_index(tuple(places.T), space.shape).tolist()
        numbers = range(space.count) if space.count <= count else dict.fromkeys(numbers)
        for number in [entry for entry in numbers if entry not in tried]:
            tried.add(number)
            figures = sweep_block(request, number, number + 1)
            design = {name: float(values[0]) for name, values in space.block(number, number + 1).items()}
            if len(files) == count or np.all(np.isnan(figures)):
                continue
            try:
                text = design_file(mechanism, design, f"design {number}")
            except AssemblyError:
                continue
            files[f"{request.linkage.name}-d{number}"] = text
            chosen.append(number)
            columns.append(np.concatenate([space.file_values(number, number + 1), figures])[:, 0])
    if not files:
        raise LinkproofError(
            f"--simulate: expected designs that assemble, got none among {len(tried)} drawn; vary less"
        )
    names = [parameter.shown for parameter in space.parameters] + [figure.shown for figure in request.figures]
    return SimulatedDesigns(files, dict(zip(names, np.array(columns).T, strict=True)), tuple(chosen))


def engines_over_designs(designs: SimulatedDesigns, records: Iterable[Record]) -> list[EngineOverDesigns]:
    """The success of every engine and setting, from judged records of the designs as ``compare`` makes them."""
    engines: dict[str, list[Record]] = {}
    for record in records:
        engines.setdefault(f"{record.engine} {record.setting}", []).append(record)
    trusted = []
    for engine, records_of in engines.items():
        judged = [record for record in records_of if Verdict(record.outcome).judged]
        failing = {record.mechanism for record in judged if Verdict(record.outcome).failed}
        silent = tuple(name for name in designs.files if name not in {record.mechanism for record in judged})
        worst = max(judged, key=share_of_limit, default=None)
        telling = telling_number(designs.numbers, np.array([name in failing for name in designs.files]))
        names = tuple(name for name in designs.files if name in failing)
        trusted.append(EngineOverDesigns(engine, tuple(designs.files), names, silent, worst, telling))
    return trusted


def share_of_limit(record: Record) -> float:
    """The error over its limit; of a run that failed without a result infinite."""
    if record.error_max is None or not record.limit:
        return math.inf if Verdict(record.outcome).failed else 0.0
    return record.error_max / record.limit


def shares_of_limits(designs: SimulatedDesigns, records: Iterable[Record], count: int) -> dict[str, Array]:
    """By engine and setting the largest error over its limit of each of ``count`` designs; nan of one not judged."""
    numbers = dict(zip(designs.files, designs.places, strict=True))
    engines: dict[str, Array] = {}
    for record in records:
        if Verdict(record.outcome).judged:
            shares = engines.setdefault(f"{record.engine} {record.setting}", np.full(count, math.nan))
            number = numbers[record.mechanism]
            shares[number] = np.fmax(shares[number], share_of_limit(record))
    return engines


def telling_number(numbers: Mapping[str, Array], fails: NDArray[np.bool_]) -> TellingNumber | None:
    """The number (designs,) that best separates failing designs from others, by the Kolmogorov-Smirnov test.

    Its chance is that of the test times the count of numbers tried. None where none or all fail, or none tells more
    than chance.
    """
    from scipy.stats import ks_2samp  # noqa: PLC0415

    if not np.any(fails) or np.all(fails):
        return None
    complete = {name: values for name, values in numbers.items() if np.all(np.isfinite(values))}
    tests = {name: ks_2samp(values[fails], values[~fails]) for name, values in complete.items()}
    name = min(tests, key=lambda key: float(tests[key].pvalue))
    chance = min(1.0, float(tests[name].pvalue) * len(tests))
    if chance >= MOST_CHANCE:
        return None
    below, value = bool(tests[name].statistic_sign > 0), float(tests[name].statistic_location)
    side = (complete[name] <= value) == below
    failing, others = (int(np.sum(side & values)) for values in (fails, ~fails))
    return TellingNumber(name, below, value, (failing, int(np.sum(fails))), (others, int(np.sum(~fails))), chance)
