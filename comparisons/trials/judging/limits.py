"""Tables of limits: the one that comes with the suite, and rows of a user's own that go before it."""

from __future__ import annotations

import tomllib
from collections.abc import Callable, Hashable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Annotated, Any, Final, TypeVar

from pydantic import Field

from analytic.description.crank_motion import LAWS, REGIMES
from analytic.description.loading import read_document
from analytic.description.schema import Positive, Tables, TomlTable
from analytic.errors import UnknownNameError
from comparisons.trials.judging.records import Error, Verdict
from engines.contract import Origin, Setting
from engines.registry import engine_names

OWN = "own"  # stands in the table for every regime of a linkage's own
SWING = "swing"  # stands there for every law from one crank angle to another but constant speed, which is one law
TABLE = Path(__file__).with_name("limits.toml")
LISTS: Final = ("quantities", "settings", "regimes", "mechanisms", "engines")
USER_REASON: Final = "set by the user"


class Limit(TomlTable):
    """The largest error_max allowed, why, and what for; no settings, regimes, mechanisms or engines: all of them.

    ``value`` is a share of the reference's peak.
    """

    value: Positive
    reason: str = USER_REASON
    quantities: Annotated[frozenset[str], Field(min_length=1)]
    settings: frozenset[str] = frozenset()
    regimes: frozenset[str] = frozenset()
    mechanisms: frozenset[str] = frozenset()
    engines: frozenset[str] = frozenset()

    def fits(self, quantity: str, setting: str, regime: str, mechanism: str, engine: str) -> bool:
        """Whether this row of the table covers a record with these names; the regime counts by its kind, too.

        ``quantity`` is without a joint's name. The kinds are ``SWING`` and ``OWN``.
        """
        kind = regime if regime in REGIMES else SWING if regime in LAWS else OWN
        return (
            quantity in self.quantities
            and (not self.settings or setting in self.settings)
            and (not self.regimes or bool({regime, kind} & self.regimes))
            and (not self.mechanisms or mechanism in self.mechanisms)
            and (not self.engines or engine in self.engines)
        )


@dataclass(frozen=True)
class LimitTable:
    """Rows of which the first that fits a record holds."""

    rows: tuple[Limit, ...]

    def limit(self, quantity: str, setting: str, regime: str, mechanism: str = "", engine: str = "") -> Limit:
        """The row of the table that covers a record; raises LookupError for a quantity that no row covers.

        The first that fits counts. Forces of all joints share a limit, and so do all regimes that linkages define for
        themselves. With "" for the mechanism or the engine only rows that hold for all of them fit.
        """
        name = quantity.partition(":")[0]
        for row in self.rows:
            if row.fits(name, setting, regime, mechanism, engine):
                return row
        raise LookupError(f"limits.toml has no row for {name}, {setting}, {regime}: add one with its reason")

    def judge(self, record: Error) -> Error:
        """A copy of the record with limit and verdict, by comparing its error with its limit.

        ``error_at_jumps``, the error beyond the jump of samples at an acceleration jump, has the same limit; if it
        alone is over it, ``error_max`` becomes it. A figure that is the adapter's own says nothing of the engine: its
        verdict is COMPUTED. What has no error, or was left undecided, comes back as it is. Raises LookupError for a
        quantity without a limit.
        """
        error = record.error_max
        if error is None or not (record.outcome == Verdict.COMPUTED or Verdict(record.outcome).judged):
            return record
        bound = self.limit(record.quantity, record.setting, record.regime, record.mechanism, record.engine).value
        record = record._replace(limit=bound, outcome=Verdict.PASSED.value, detail="")
        if record.origin == Origin.COMPUTED:
            detail = "computed by the adapter from the linkage's data, not read from the engine"
            return record._replace(outcome=Verdict.COMPUTED.value, detail=detail)
        if not error <= bound:
            detail = f"error {error:.2g} of peak is over its limit {bound:.2g}"
        elif not record.error_at_jumps <= bound:
            detail = (
                f"error {record.error_at_jumps:.2g} of peak at an acceleration jump, besides the jump itself, is over "
                f"its limit {bound:.2g}"
            )
            record = record._replace(error_max=record.error_at_jumps)
        else:
            return record
        return record._replace(outcome=Verdict.OVER_LIMIT.value, detail=detail)

    @property
    def as_dict(self) -> list[dict[str, Any]]:
        """The rows as a file of limits has them, a list, JSON-ready; ``table_from_rows`` reads them back."""
        return [
            {**{name: sorted(getattr(row, name)) for name in LISTS}, "value": row.value, "reason": row.reason}
            for row in self.rows
        ]

    @property
    def quantities(self) -> tuple[str, ...]:
        """Every quantity that has a limit, without joints' names, sorted."""
        return tuple(sorted({name for row in self.rows for name in row.quantities}))


@cache
def shipped_limits() -> LimitTable:
    """The suite's own table of limits, read once and shared by all callers."""
    return table_from_rows(tomllib.loads(TABLE.read_text(encoding="utf-8"))["limit"])


def table_from_rows(rows: Iterable[Mapping[str, Any]]) -> LimitTable:
    """A table of limits from rows as a file of limits has them; raises ValueError for a wrong row."""
    return LimitTable(tuple(map(Limit.model_validate, rows)))


def limit(quantity: str, setting: str, regime: str, engine: str = "") -> Limit:
    """The row of the suite's own table, for no mechanism in particular; else as ``LimitTable.limit``, errors too."""
    return shipped_limits().limit(quantity, setting, regime, engine=engine)


LimitRows = Annotated[Tables[Limit], Field(min_length=1)]


class LimitDocument(TomlTable):
    """A user's file of limits."""

    limit: LimitRows


def read_limits(path: Path) -> LimitTable:
    """The suite's table behind the ``[[limit]]`` rows of a user's file; raises LinkproofError for a wrong file.

    That is one that is missing or no such TOML; UnknownNameError for a row with an unknown setting, quantity or engine.
    """
    return with_rows(read_document(path, "a TOML file of limits", LimitDocument).limit, str(path))


def with_rows(rows: Sequence[Limit], origin: str) -> LimitTable:
    """A table in which a user's rows precede the suite's; ``origin`` names their file in errors.

    Raises UnknownNameError for a row's setting, quantity or engine that does not exist.
    """
    ours = shipped_limits()
    for number, row in enumerate(rows, start=1):
        for name in sorted(row.settings - {*Setting}):
            raise UnknownNameError(f"setting of {origin}: limit {number}", name, Setting)
        for name in sorted(row.quantities - {*ours.quantities}):
            raise UnknownNameError(f"quantity of {origin}: limit {number}", name, ours.quantities)
        for name in sorted(row.engines - {*engine_names()}):
            raise UnknownNameError(f"engine of {origin}: limit {number}", name, engine_names())
    return LimitTable((*rows, *ours.rows))


def check_named(
    table: LimitTable, mechanisms: Callable[[], Iterable[str]], regimes: Callable[[], Iterable[str]]
) -> None:
    """Raise UnknownNameError for a user's row with an unknown mechanism or regime, which would never apply.

    ``table`` is from ``with_rows``. ``mechanisms()`` and ``regimes()`` give the names that the linkages at hand have;
    they are called only for a row with others than the suite's.
    """
    for number, row in enumerate(table.rows[: -len(shipped_limits().rows)], start=1):
        for kind, used, ours, known in (
            ("mechanism", row.mechanisms, (), mechanisms),
            ("regime", row.regimes, (*REGIMES, *LAWS, OWN, SWING), regimes),
        ):
            for name in sorted(used - {*ours}):
                if name not in (names := [*ours, *known()]):
                    raise UnknownNameError(f"{kind} of limit {number}", name, names)


# Judging a record: its error against its limit.

K = TypeVar("K", bound=Hashable)
V = TypeVar("V")


def judge(record: Error) -> Error:
    """The record with limit and verdict, by the suite's own limits, as from ``LimitTable.judge``.

    Raises LookupError for a quantity without a limit.
    """
    return shipped_limits().judge(record)


def deciding(records: Sequence[Error]) -> Sequence[Error]:
    """The records that decide whether a campaign has passed: all but naive ones, or these if no other setting ran."""
    return [record for record in records if record.setting != Setting.NAIVE] or records


def grouped(pairs: Iterable[tuple[K, V]]) -> dict[K, list[V]]:
    """The second members of pairs in lists by their first members, both in the order of the pairs.

    First members must be hashable.
    """
    groups: dict[K, list[V]] = {}
    for key, entry in pairs:
        groups.setdefault(key, []).append(entry)
    return groups
