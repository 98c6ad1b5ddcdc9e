"""The differences of two folders of campaigns: records, key figures, times and facts."""

from __future__ import annotations

from collections.abc import Container, Iterable, Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from typing import Any, Final

from analytic.errors import LinkproofError
from comparisons.campaign.campaign import CampaignRequest, cases
from comparisons.campaign.key_figures import KeyFigure, compared
from comparisons.campaign.project import checksum
from comparisons.campaign.results import Results
from comparisons.judging.baseline import Baseline, regime_key
from comparisons.judging.baseline import Place as BaselinePlace
from comparisons.judging.limits import deciding
from comparisons.judging.records import Record, Verdict
from comparisons.reference.case import Case

# The cases of a saved campaign, made anew from its texts, and its key figures.


Place = tuple[str, str, str]  # mechanism, variant and regime


def saved_cases(results: Results) -> dict[Place, Case]:
    """The case of every record; raises LinkproofError where a text cannot be read, or its linkage cannot move."""
    table = {record.run[:3]: None for record in results.records}
    prescribed = {motion.regime for motion in results.motions}
    own_regimes = tuple(dict.fromkeys(regime for _, _, regime in table if regime not in prescribed))
    conditions = results.document["conditions"]
    request = CampaignRequest(results.linkages, results.motions, conditions, engines=(), own_regimes=own_regimes)
    result = {(c.mechanism.linkage.name, c.mechanism.linkage.variant, c.motion.regime): c for c in cases(request)}
    for place in table.keys() - result.keys():
        raise LinkproofError(f"expected the motion of {'/'.join(place)} in the folder, got none: it is damaged")
    return {place: result[place] for place in table}


def saved_figures(results: Results) -> dict[Place, dict[str, float]]:
    """The key figures of a folder, SI, by name; empty for results of another tool."""
    groups: dict[Place, dict[str, float]] = {}
    for figure in results.figures:
        if figure.now is not None:
            groups.setdefault((figure.mechanism, figure.variant, figure.regime), {})[figure.figure] = figure.now
    return groups


def as_baseline(
    results: Results, figures: Mapping[Place, Mapping[str, float]], records: Iterable[Record] = ()
) -> Baseline:
    """Key figures, and records where there are any, of a campaign as a baseline for others."""
    conditions = {record.run[:3]: record.conditions for record in results.records}
    places = {linkage.name: BaselinePlace(linkage.name, checksum(linkage.text)) for linkage in results.linkages}
    keyed = {(p[0], p[1], regime_key(p[2], conditions[p])): values for p, values in figures.items() if p in conditions}
    return Baseline({}, places).recorded(records, keyed)


# Relative changes of an error and of a peak that are reported; and the size of rounding.
LEAST_SHARE: Final = 0.01
PEAK_SHARE: Final = 1e-3
ROUNDING: Final = 1e-12

Name = tuple[str, str]  # of a linkage: mechanism and variant


@dataclass(frozen=True)
class MovedRecord:
    """A record in both folders; ``is_beyond`` is true for a new failure or an error over the ``allowed`` one.

    Allowed is three times the error before, at least round-off; None where other designs or variants are compared.
    """

    before: Record
    after: Record
    allowed: float | None
    is_beyond: bool

    @property
    def factor(self) -> float | None:
        """Ratio of the second error to the first; None if either is missing or the first is zero."""
        old, new = self.before.error_max, self.after.error_max
        return new / old if old and new is not None else None

    @property
    def peak_share(self) -> float | None:
        """By what share of the one before the truth's peak over the samples has moved."""
        old, new = self.before.peak, self.after.peak
        return new / old - 1.0 if old and new is not None else None


@dataclass(frozen=True)
class RunPair:
    """A run in both folders: seconds of stepping and steps, each before and after."""

    run: tuple[str, ...]
    versions: tuple[str, str]
    seconds: tuple[float, float]
    steps: tuple[int, int]


@dataclass(frozen=True)
class FolderDifference:
    """The differences of two folders; records and figures bear the second folder's names.

    ``linkages`` are pairs of those that are compared, ``compared`` counts the records in both folders. ``facts`` are
    name, before and after of what the folders were made on. Changed key figures count only
    where linkage and variant are the same in both folders.
    """

    linkages: tuple[tuple[Name, Name], ...]
    compared: int
    moves: tuple[MovedRecord, ...]
    runs: tuple[RunPair, ...]
    figures: tuple[KeyFigure, ...]
    only_before: tuple[str, ...]
    only_after: tuple[str, ...]
    facts: tuple[tuple[str, str, str], ...]
    same_machine: bool

    @property
    def beyond_count(self) -> int:
        """How many records and figures of the same linkage moved by more than is allowed."""
        same = {after for before, after in self.linkages if before == after}
        return sum(move.is_beyond for move in self.moves) + sum((f.mechanism, f.variant) in same for f in self.figures)

    @property
    def as_dict(self) -> dict[str, Any]:
        """The whole comparison, JSON-ready."""
        moves = [
            {
                "before": asdict(move.before),
                "after": asdict(move.after),
                "allowed": move.allowed,
                "beyond": move.is_beyond,
                "factor": move.factor,
                "peak_share": move.peak_share,
            }
            for move in self.moves
        ]
        figures = [{**asdict(figure), "sentence": figure.sentence} for figure in self.figures]
        return {**asdict(self), "moves": moves, "figures": figures, "beyond": self.beyond_count}


def difference(before: Results, after: Results) -> FolderDifference:
    """Compare two campaigns, run by run, under the same conditions.

    Linkages are pairs by name and variant; then by name, where each side has a single one of it left in any variant;
    then the last linkage left on each side.
    Raises LinkproofError where no run is in both.
    """
    names = _linkage_pairs(_linkage_names(before), _linkage_names(after))
    old, new = (
        _records_by_key(_rename_linkages(_records_and_invariants(before), names)),
        _records_by_key(_records_and_invariants(after)),
    )
    both = [key for key in new if key in old]
    if not both:
        raise LinkproofError(
            "expected runs under the same conditions in both folders, got none in common: give folders of the same "
            "linkages, regimes, speeds and engines, or of one linkage each"
        )
    places = {key[:3] for key in both}
    figures = {place: values for place, values in _renamed_figures(before, names).items() if place in places}
    baseline = as_baseline(after, figures, [old[key] for key in both])
    moves = _compare_records([(old[key], new[key]) for key in both], baseline, {p for p in names if names[p] == p})
    first, second = before.document["environment"], after.document["environment"]
    return FolderDifference(
        tuple(names.items()),
        len(both),
        tuple(filter(_has_moved, moves)),
        _run_pairs([(old[key], new[key]) for key in both]),
        tuple(figure for figure in _compare_figures(after, baseline) if figure.changed and figure.recorded is not None),
        _only_here(old, new),
        _only_here(new, old),
        tuple(
            (k, first.get(k, ""), second.get(k, ""))
            for k in {**first, **second}
            if first.get(k) != second.get(k) and k != "date"
        ),
        first["machine"] == second["machine"],
    )


def _linkage_names(results: Results) -> list[Name]:
    return list(dict.fromkeys((row["name"], row["variant"]) for row in results.document["descriptions"]))


def _linkage_pairs(before: Sequence[Name], after: Sequence[Name]) -> dict[Name, Name]:
    """The linkages to compare, from those before to those after."""
    matches = {name: name for name in before if name in after}
    for part in (lambda name: name[0], lambda _: ""):  # one left of a name, and then of all
        old, new = ([name for name in side if name not in known] for side, known in
                    ((before, matches.keys()), (after, set(matches.values()))))  # fmt: skip
        for name in old:
            alike = [[names for names in side if part(names) == part(name)] for side in (old, new)]
            if list(map(len, alike)) == [1, 1]:
                matches[name] = alike[1][0]
    return matches


def _records_and_invariants(results: Results) -> list[Record]:
    return [*results.records, *results.invariants]


def _rename_linkages(records: Iterable[Record], names: Mapping[Name, Name]) -> list[Record]:
    """Records by the names of the other folder, those of a pair alone."""
    pairs = [(record, names.get((record.mechanism, record.variant))) for record in records]
    return [replace(record, mechanism=name[0], variant=name[1]) if name else record for record, name in pairs]


def _records_by_key(records: Iterable[Record]) -> dict[tuple[str, ...], Record]:
    return {(*record.run, record.conditions, record.quantity): record for record in records}


def _only_here(records: Mapping[tuple[str, ...], Record], others: Mapping[tuple[str, ...], Record]) -> tuple[str, ...]:
    """Runs, or quantities of a run, that the other folder has not."""
    runs = {key[:-1] for key in others}
    lacking = [key for key in records if key not in others]
    words = (f"{'/'.join(k[:5])} ({k[5]})" if k[:-1] not in runs else f"{'/'.join(k[:5])}: {k[6]}" for k in lacking)
    return tuple(dict.fromkeys(words))


def _compare_records(
    pairs: Sequence[tuple[Record, Record]], baseline: Baseline, same: Container[Name]
) -> list[MovedRecord]:
    """Pairs of records; a failure that is new decides, and in the ``same`` linkages an error that has grown."""
    decides = {id(record) for record in deciding([after for _, after in pairs])}
    records = []
    for before, after in pairs:
        allowed = baseline.allowed(after) if after.run[:2] in same else None
        was, now = Verdict(before.outcome), Verdict(after.outcome)
        grown = allowed is not None and after.error_max is not None and not after.error_max <= allowed
        worse = (now.failed and not was.failed) or (grown and now.judged)
        records.append(MovedRecord(before, after, allowed, is_beyond=worse and id(after) in decides))
    return records


def differ(old: float, new: float) -> bool:
    """Whether one error differs from another by more than is worth a row."""
    return abs(new - old) > max(LEAST_SHARE * max(old, new), ROUNDING)


def _has_moved(move: MovedRecord) -> bool:
    old, new = move.before.error_max, move.after.error_max
    if move.is_beyond or move.before.outcome != move.after.outcome or (old is None) != (new is None):
        return True
    moved = old is not None and new is not None and differ(old, new)
    return moved or abs(move.peak_share or 0.0) > PEAK_SHARE


def _run_pairs(pairs: Iterable[tuple[Record, Record]]) -> tuple[RunPair, ...]:
    result = {
        new.run: RunPair(
            new.run, (old.engine_version, new.engine_version), (old.seconds, new.seconds), (old.steps, new.steps)
        )
        for old, new in pairs
    }
    return tuple(result.values())


def _renamed_figures(results: Results, names: Mapping[Name, Name]) -> dict[tuple[str, str, str], dict[str, float]]:
    """Key figures by the names of the other folder; empty for results of another tool."""
    groups = saved_figures(results)
    return {(*names[place[:2]], place[2]): figures for place, figures in groups.items() if place[:2] in names}


def _compare_figures(results: Results, baseline: Baseline) -> list[KeyFigure]:
    """The key figures of a folder's texts beside a baseline's."""
    return [] if "judgement" in results.document else compared(saved_cases(results).values(), baseline)
