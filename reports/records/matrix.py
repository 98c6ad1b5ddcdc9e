"""The matrix mechanisms × engines × settings × quantities in tables, and what it comes to."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import groupby

from comparisons.campaign.results import Results
from comparisons.judging.limits import limit
from comparisons.judging.records import CONTROL, IMPORTED, Record, Verdict
from reports.document.numbers import ABSENT, bound, steady_error
from reports.document.parts import Table
from reports.document.signs import RUNS
from reports.document.templates import plain
from reports.records.origins import control_last, exceptions, origin_words
from reports.records.views import SETTINGS, columns, family, ordered, worst


def blocks(results: Results) -> Iterator[tuple[str, str, Table]]:
    """Of each mechanism under each regime a heading, its conditions and a table: runs down, families across."""
    names = [name for part in columns(results) for name in part]
    head = ("engine", "setting", "figures of", *map(plain, names))
    for (mechanism, variant, regime), part in groupby(every_record(results), key=lambda record: record.run[:3]):
        records = list(part)
        runs = control_last([list(run) for _, run in groupby(records, key=lambda record: record.run)])
        table = Table("", head, tuple(_row(run, names) for run in runs), align="l")
        yield f"{mechanism} ({variant}), {regime}", records[0].conditions, table


def every_record(results: Results) -> tuple[Record, ...]:
    """Records and invariants in stable order."""
    return ordered(results, (*results.records, *results.invariants))


def _row(records: Sequence[Record], names: Sequence[str]) -> tuple[str, ...]:
    """Of a run the worst error of each family; where there is none at all, why."""
    first = records[0]
    if all(record.error_max is None for record in records):
        sign = RUNS[first.outcome]
        failure = f"{sign.symbol} {sign.word}" + (f": {first.detail}" if first.detail else "")
        return (first.engine, first.setting, "", failure, *[""] * (len(names) - 1))
    families: dict[str, list[Record]] = {}
    for record in records:
        families.setdefault(family(record.quantity), []).append(record)
    origin = "; ".join(filter(None, (origin_words(records), exceptions(records))))
    return (first.engine, first.setting, origin, *(_cell(families.get(name, ())) for name in names))


def _cell(records: Sequence[Record]) -> str:
    """The worst of a family: of the forces in all joints, say."""
    if not records:
        return ABSENT
    record = worst(records)
    return f"{RUNS[record.outcome].symbol} {steady_error(record.error_max)}"


def caught_by_baseline(record: Record) -> bool:
    """Whether a record is within its limit but has grown too far over its recorded value."""
    if record.outcome != Verdict.OVER_LIMIT.value or record.error_max is None or not record.limit:
        return False
    return record.baseline is not None and record.error_max <= record.limit


@dataclass(frozen=True)
class EngineStanding:
    """How an engine at a setting came out over all it ran; ``nearest`` is the record that uses most of its limit.

    ``total`` counts what was judged, ``computed`` what is the adapter's own. ``origin`` is as of ``origin_words``.
    """

    engine: str
    setting: str
    origin: str
    passed: int
    total: int
    computed: int
    nearest: Record | None
    failures: tuple[str, ...]

    @property
    def share(self) -> float:
        """Largest deviation over its limit."""
        one = self.nearest
        return 0.0 if one is None or not one.limit or one.error_max is None else one.error_max / one.limit


def standings(results: Results) -> tuple[EngineStanding, ...]:
    """One standing per engine and setting; the reference's control comes last."""
    records = sorted(every_record(results), key=_by_engine)
    found = [_standing(list(part)) for _, part in groupby(records, key=_by_engine)]
    return tuple(sorted(found, key=lambda one: one.origin == CONTROL))


def _by_engine(record: Record) -> tuple[str, int]:
    place = SETTINGS.index(record.setting) if record.setting in SETTINGS else len(SETTINGS)
    return record.engine, place


def _standing(records: list[Record]) -> EngineStanding:
    judged = [record for record in records if Verdict(record.outcome).judged]
    measured = [record for record in judged if record.error_max is not None and record.limit]
    nearest = max(measured, key=lambda r: (r.error_max or 0.0) / (r.limit or 1.0), default=None)
    failures = dict.fromkeys(f"{RUNS[r.outcome].word}: {r.detail}" for r in records if r.error_max is None)
    passed = sum(record.outcome == Verdict.PASSED.value for record in records)
    computed = sum(record.outcome == Verdict.COMPUTED.value for record in records)
    return EngineStanding(
        engine=records[0].engine,
        setting=records[0].setting,
        origin=origin_words(records),
        passed=passed,
        total=len(judged),
        computed=computed,
        nearest=nearest,
        failures=tuple(failures),
    )


def past_baseline(results: Results) -> tuple[str, ...]:
    """Records that are within their limit and were caught by the recorded baseline, each in one sentence."""
    return tuple(
        f"{r.mechanism} ({r.variant}), {r.regime}, {r.engine} {r.setting}, {r.quantity}: {r.detail}"
        for r in every_record(results)
        if caught_by_baseline(r)
    )


def _limit(record: Record) -> tuple[float, str]:
    """The limit of a record and its reason; that of another tool's results is what the user asked for."""
    if record.origin == IMPORTED and record.limit is not None:
        return record.limit, "as asked for, or of a check the rounding of its columns"
    table = limit(record.quantity, record.setting, record.regime)
    value = record.limit if record.limit is not None else table.value
    return value, table.reason if value == table.value else "as the table of limits stood when the campaign ran"


def limit_table(results: Results) -> Table:
    """The limits these records are held against, largest first within the order of the quantities."""
    names = [name for part in columns(results) for name in part]
    groups: dict[tuple[float, str], list[Record]] = {}
    for record in every_record(results):
        value, reason = _limit(record)
        groups.setdefault((value, reason), []).append(record)
    rows = []
    for (value, reason), records in groups.items():
        held = {family(record.quantity) for record in records}
        settings, regimes = {r.setting for r in records}, {r.regime for r in records}
        quantities = [name for name in names if name in held]
        cells = (
            plain(", ".join(quantities)),
            ", ".join(s for s in SETTINGS if s in settings),
            ", ".join(sorted(regimes)),
            bound(value),
            reason,
        )
        rows.append((names.index(quantities[0]), -value, cells))
    ordered_rows = tuple(cells for _, _, cells in sorted(rows, key=lambda entry: entry[:2]))
    caption = "What a largest error over the reference's peak may be, and why."
    return Table(caption, ("Quantities", "Settings", "Regimes", "Limit", "Reason"), ordered_rows, align="lllrl")
