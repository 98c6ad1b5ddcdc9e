"""Saved records for pages, tables and the terminal: by mechanism, beside recorded ones, and where they come from."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Container, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import groupby
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from analytic.description.crank_motion import CrankMotion
from analytic.description.linkage import Linkage, PrescribedRegime
from analytic.description.written import change
from comparisons.trials.campaign.results import CampaignResults
from comparisons.trials.conformance.slips import MUTANT
from comparisons.trials.conformance.trial import CheckResult, Finding
from comparisons.trials.judging.changes import CLOSED_FORM, Change, ChangeKind
from comparisons.trials.judging.limits import LimitTable, grouped
from comparisons.trials.judging.quantities import QUANTITIES, near_jumps
from comparisons.trials.judging.records import CONTROL, IMPORTED, Error, Verdict
from engines.contract import Origin, Setting
from reports.document.numbers import ABSENT, bound, error
from reports.document.parts import Table, TableCell, Words
from reports.document.templates import plain, worded
from reports.document.terminal import Printout

Array = NDArray[np.float64]
SYMBOLS = {"phi": "φ", "omega": "ω", "epsilon": "ε"}
SETTINGS = tuple(setting.value for setting in Setting)


@dataclass(frozen=True)
class Regime:
    """A regime that a mechanism ran in, its conditions in words; ``motion`` is None for a released crank."""

    name: str
    conditions: str
    motion: CrankMotion | None = None


@dataclass(frozen=True)
class Trace:
    """One quantity of one run: ``time``, true crank ``angle``, ``observed``, ``reference``, all (n,), SI.

    Of a vector, ``observed`` and ``reference`` are magnitudes.
    ``error`` is |observed − reference| over the reference's peak, NaN where the comparison left a sample out.
    """

    record: Error
    time: Array
    angle: Array
    observed: Array
    reference: Array
    error: Array


@dataclass(frozen=True)
class View:
    """One mechanism in one variant, with its part of the results."""

    results: CampaignResults
    linkage: Linkage

    @cached_property
    def records(self) -> tuple[Error, ...]:
        """Records and invariants of this mechanism, by regime, engine, setting and quantity."""
        mine = (self.linkage.name, self.linkage.variant)
        return tuple(record for record in every_record(self.results) if record.run[:2] == mine)

    @cached_property
    def regimes(self) -> tuple[Regime, ...]:
        """The regimes this mechanism ran through, in the order of ``records``, prescribed ones with their motion."""
        motions = {motion.regime: motion for motion in self.results.motions}
        motions |= {own.name: own.motion for own in self.linkage.regimes if isinstance(own, PrescribedRegime)}
        conditions = {record.regime: record.conditions for record in self.records}
        return tuple(Regime(name, words, motions.get(name)) for name, words in conditions.items())

    def of(self, regime: Regime) -> tuple[Error, ...]:
        """Records and invariants of a regime, in the order of ``records``."""
        return tuple(record for record in self.records if record.regime == regime.name)

    def runs(self, regime: Regime) -> list[list[Error]]:
        """Records and invariants of every run of a regime, a list per run, in the order of ``records``.

        Runs of the control, which is the reference computed another way, are last.
        """
        groups = [list(run) for _, run in groupby(self.of(regime), key=lambda record: record.run)]
        return sorted(groups, key=lambda run: any(record.origin == CONTROL for record in run))

    def quantities(self, regime: Regime) -> tuple[str, ...]:
        """Names of the quantities, then of the invariants, of a regime."""
        names = dict.fromkeys(record.quantity for record in self.of(regime))
        return tuple(sorted(names, key=self.invariants.__contains__))

    @cached_property
    def invariants(self) -> frozenset[str]:
        """Names of the checks without the closed form, of all mechanisms of the campaign."""
        return frozenset(record.quantity for record in self.results.invariants)

    def title(self, quantity: str) -> str:
        """The title of a quantity or an invariant: its symbol, if it has one, then its words.

        A linear drive has words of its own for some.
        """
        known = QUANTITIES.get(quantity) if self.linkage.is_linear else None
        words = known.linear_title if known else ""
        symbol = short_title(quantity) if quantity in QUANTITIES and "_" not in quantity else ""
        return " ".join(filter(None, (symbol, words or title(quantity))))

    def curved(self, regime: Regime, quantity: str) -> list[Error]:
        """The records of a quantity under a regime that have an error, whose runs stored a curve.

        [] for an invariant.
        """
        mine = self.of(regime) if quantity not in self.invariants else ()
        return [record for record in mine if record.quantity == quantity and record.error_max is not None]

    def shown_setting(self, regime: Regime) -> str:
        """The setting shown first: tuned if any run of the regime at it has an error, else the finest.

        "" without any.
        """
        ran = {record.setting for record in self.of(regime) if record.error_max is not None}
        return next((name for name in (Setting.TUNED.value, *reversed(SETTINGS), *sorted(ran)) if name in ran), "")

    def traces(self, regime: Regime, quantity: str) -> list[Trace]:
        """The curves of a quantity under a regime, of every run that gave one; [] without any.

        Raises KeyError for one that was not stored.
        """
        return [self._read_trace(regime, record) for record in self.curved(regime, quantity)]

    def _read_trace(self, regime: Regime, record: Error) -> Trace:
        """The curve of a record under a regime, as stored; its error is NaN at jumps that the quantity follows.

        These are jumps of the crank's acceleration. Without a peak the error is absolute. Raises KeyError without a
        curve.
        """
        time, angle, reference, beyond = self.results.curve(record.run, record.quantity).astype(float)
        error = np.abs(beyond) / (record.peak or 1.0)
        if regime.motion and holds_acceleration(record.quantity):
            error = np.where(near_jumps(time, regime.motion), np.nan, error)
        return Trace(record, time, angle, reference + beyond, reference, error)


def views(results: CampaignResults) -> tuple[View, ...]:
    """One view per mechanism and variant, in the campaign's order."""
    return tuple(View(results, linkage) for linkage in results.linkages)


def anchor(*names: str) -> str:
    """Names joined by dashes to an identifier that links within the page point to.

    A dash replaces signs other than letters, digits and underscores.
    """
    return re.sub(r"\W+", "-", "-".join(names))


def family(quantity: str) -> str:
    """A quantity's name up to its first ":", without the part it belongs to: forces of all joints are one family."""
    return quantity.partition(":")[0]


def family_title(quantity: str) -> str:
    """The symbol of a quantity's family, φ, ω or ε, or its name with spaces for underscores."""
    name = family(quantity)
    return SYMBOLS.get(name, plain(name))


def title(quantity: str) -> str:
    """A quantity's title in words; for a name outside the table of quantities the name made readable.

    A name with "=" in it is unchanged.
    """
    known = QUANTITIES.get(quantity)
    return known.title if known else quantity if "=" in quantity else worded(quantity)


def short_title(quantity: str) -> str:
    """A quantity's symbol, φ, ω or ε, or else its name in a few words, "force" for "joint force"."""
    return SYMBOLS.get(quantity, worded(quantity).replace("joint force", "force"))


def holds_acceleration(quantity: str) -> bool:
    """Whether a quantity jumps with the crank's acceleration; quantities outside the table are forces, and do."""
    known = QUANTITIES.get(quantity)
    return known.holds_acceleration if known else True


def engines(results: CampaignResults) -> tuple[str, ...]:
    """Names of all engines with records, sorted: an engine keeps its colour within a report."""
    return tuple(sorted({record.engine for record in results.records}))


# Of an engine: its symbol by Plotly's name, the sign of it in words.
SHAPES: Final = (
    *(("circle", "●"), ("square", "■"), ("diamond", "◆"), ("triangle-up", "▲"), ("triangle-down", "▼")),
    *(("cross", "✚"), ("x", "✖")),
)
COLOURS: Final = 9  # of the palette
# How a symbol looks at a setting; ``linkproof.controls.marker`` of the scripts draws it so.
LOOKS: Final = {Setting.NAIVE.value: "open", Setting.TUNED.value: "filled", Setting.BEST.value: "outlined"}


class Look(NamedTuple):
    """How an engine is drawn on every page: a colour of the style sheet, "c0" to "c8" or "muted", and a symbol.

    ``symbol`` is its name in Plotly, ``sign`` the same as a letter.
    """

    ink: str
    symbol: str
    sign: str


def looks(names: Iterable[str], controls: Container[str] = ()) -> dict[str, Look]:
    """The look of each engine, by name: sorted, the ``controls`` last, muted. Up to 63 differ."""
    return {
        name: Look("muted" if name in controls else f"c{n % COLOURS}", *SHAPES[n % len(SHAPES)])
        for n, name in enumerate(sorted(names, key=lambda name: (name in controls, name)))
    }


def setting_rank(setting: str) -> int:
    """The rank of a setting in the order of settings; a setting that no engine has comes last."""
    return SETTINGS.index(setting) if setting in SETTINGS else len(SETTINGS)


def columns(results: CampaignResults) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """A pair: families of quantities, in the table's order and then as they come; names of invariants as they come."""
    table = dict.fromkeys(family(record.quantity) for record in results.records)
    known = [name for name in QUANTITIES if name in table]
    quantities = (*known, *(name for name in table if name not in known))
    return quantities, tuple(dict.fromkeys(record.quantity for record in results.invariants))


def worst(records: Iterable[Error]) -> Error:
    """The record that uses most of its limit; one without an error is worst. Raises ValueError without records."""
    return max(records, key=lambda record: np.inf if record.error_max is None else share(record))


def share(record: Error) -> float:
    """An error divided by its limit, or by 1 without a limit; 0 without an error."""
    return (record.error_max or 0.0) / (record.limit or 1.0)


def every_record(results: CampaignResults) -> tuple[Error, ...]:
    """Records and invariants by mechanism, variant and regime in the campaign's order, engine, setting, quantity.

    Raises KeyError for a record of another mechanism than the campaign's.
    """
    mechanisms = {(linkage.name, linkage.variant): number for number, linkage in enumerate(results.linkages)}
    names = [*(motion.regime for motion in results.motions), *(record.regime for record in results.records)]
    regimes = {name: number for number, name in enumerate(dict.fromkeys(names))}
    families = {name: number for number, name in enumerate(name for part in columns(results) for name in part)}

    def rank(record: Error) -> tuple[int, int, str, int, int, str]:
        """The sort key of a record: mechanism and variant, regime, engine, setting, family, quantity."""
        run = mechanisms[record.run[:2]], regimes[record.regime], record.engine, setting_rank(record.setting)
        return *run, families[family(record.quantity)], record.quantity

    return tuple(sorted((*results.records, *results.invariants), key=rank))


def blank_repeats(rows: Iterable[tuple[TableCell | str, ...]], heads: int = 1) -> Iterator[tuple[TableCell | str, ...]]:
    """Yield rows; each of their first ``heads`` cells is "" if it and all cells left of it are as in the row before."""
    before: tuple[TableCell | str, ...] = ()
    for row in rows:
        words = ("" if row[: n + 1] == before[: n + 1] else word for n, word in enumerate(row[:heads]))
        yield (*words, *row[heads:])
        before = row[:heads]


# The limits of a campaign's records.


def remedy(run: Iterable[Error]) -> str:
    """Advice on a run with errors over their limits, by its setting, as a clause without full stop.

    "" if no error is over its limit, or the results are another tool's.
    """
    over = [record for record in run if record.error_max is not None and Verdict(record.outcome).failed]
    if not over or over[0].origin == IMPORTED:
        return ""
    if over[0].setting == Setting.NAIVE:
        return "the engine's default step or softness leaves this error: use the setting tuned"
    check = f"run 'linkproof engines {over[0].engine} --check'"
    return f"{check}, and if it passes shorten the step or give its solver more iterations"


def _limit_and_reason(record: Error, limits: LimitTable) -> tuple[float, str]:
    """The limit of a record, its own before the table's, and the reason for it in words.

    For another tool's results it is the user's own. Raises LookupError for a quantity that no row of ``limits`` covers.
    """
    if record.origin == IMPORTED and record.limit is not None:
        return record.limit, "your --limit, or for a check the rounding of its columns"
    table = limits.limit(record.quantity, record.setting, record.regime, record.mechanism, record.engine)
    value = record.limit if record.limit is not None else table.value
    return value, table.reason if value == table.value else "as the table of limits stood when the campaign ran"


def limit_table(results: CampaignResults) -> Table:
    """The table of the records' limits, by quantity, the largest first, a row per limit and reason.

    Raises LookupError for a quantity without a limit.
    """
    names = [name for part in columns(results) for name in part]
    groups = grouped((_limit_and_reason(record, results.limits), record) for record in every_record(results))
    rows = []
    for (value, reason), records in groups.items():
        families = {family(record.quantity) for record in records}
        settings, regimes = {r.setting for r in records}, {r.regime for r in records}
        quantities = [name for name in names if name in families]
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


# What has changed since results were recorded, in a table and in a line.


CAPTION = "What is not as it was recorded: errors over the peak, and figures of the closed form in SI."
HEAD = ("mechanism", "regime", "engine", "quantity", "", "before", "now", "unit", "change")


def changes_table(changes: Sequence[Change]) -> tuple[Table, ...]:
    """The table with a row for every change that fails, as the only member; () without any.

    Quantities of a run that have no value any more share a row.
    """
    rows = [_change_row(entry) for entry in changes if entry.fails and entry.after is not None]
    gone = grouped(((entry.run, entry.kind), entry) for entry in changes if entry.fails and entry.after is None)
    rows += [_change_row(entries[0], len(entries)) for entries in gone.values()]
    return (Table(CAPTION, HEAD, rows, align="lllllrrlr"),) if rows else ()


def _change_row(entry: Change, count: int = 1) -> tuple[str, ...]:
    """The row of a change, 9 texts in the order of ``HEAD``.

    With a ``count`` over 1 it is of so many quantities of a run that changed alike, the last four texts "".
    """
    mechanism, variant, regime, _, engine, setting, quantity = entry.place
    place = (f"{mechanism} ({variant})", regime, f"{engine} {setting}".rstrip())
    is_figure = engine == CLOSED_FORM
    what = f"{entry.kind}: {entry.outcome}" if entry.kind is ChangeKind.FAILING else entry.kind.value
    if count > 1:
        return (*place, f"{count} quantities", what, "", "", "", "")
    values = (ABSENT if v is None else f"{v:.9g}" if is_figure else error(v) for v in (entry.before, entry.after))
    share = entry.share
    words = ABSENT if share is None else change(share, ".2g") if is_figure else f"{1.0 + share:.1f} times"
    return (*place, quantity, what, *values, entry.unit, words)


def appeared_note(changes: Sequence[Change]) -> tuple[str, ...]:
    """A line on results that were not recorded before, which is no failure, as the only member; () without any."""
    new = [entry for entry in changes if not entry.fails]
    if not new:
        return ()
    runs = list(dict.fromkeys(entry.run for entry in new))
    more = f", and {len(runs) - 1} more" if len(runs) > 1 else ""
    what = "1 result" if len(new) == 1 else f"{len(new)} results"
    return (f"not recorded, which is no failure: {what} of {runs[0]}{more}",)


# Where figures come from: those of a run in words, those of an engine in the table of its read-outs.


READOUTS = ("channel", "in the engine", "frame", "instant", "drive's share")


def origin_words(records: Sequence[Error], runs: int) -> str:
    """The origin of a run's results in words: "1 run, read", "4 runs, extrapolated", "control"; "" without any.

    It is "read in part" where the adapter computes some. ``records`` are the run's, ``runs`` is the number of passes,
    extrapolated if there are several.
    """
    words = [record for record in records if record.origin]
    if not words:
        return ""
    if words[0].origin in (CONTROL, IMPORTED):
        return words[0].origin
    if runs > 1:
        return f"{runs} runs, {Origin.EXTRAPOLATED}"
    return "read in part" if any(r.origin != Origin.READ for r in words) else f"1 run, {Origin.READ}"


def computed_or_shared(records: Sequence[Error]) -> str:
    """The quantities that the adapter computes or shares with the reference, in words with "; "; "" without any."""
    families = {
        origin: ", ".join(dict.fromkeys(family(record.quantity) for record in records if record.origin == origin))
        for origin in (Origin.COMPUTED, Origin.PARTLY)
    }
    shared = dict.fromkeys(f"{r.shared} of {r.quantity.replace('_', ' ')}" for r in records if r.shared)
    words = [f"{origin} by its adapter: {names}" for origin, names in families.items() if names]
    return "; ".join([*words, *([f"shared with the reference: {', '.join(shared)}"] if shared else [])])


def readout_table(engine_name: str, groups: Mapping[str, Mapping[str, str]]) -> Table:
    """The table of an engine's read-outs, of which ``groups`` has source, frame, instant and drive, by channel.

    They are in the form of ``Abilities.as_dict``.
    """
    rows = tuple(
        (plain(channel), names["source"], names["frame"], names["instant"], names["drive"] or ABSENT)
        for channel, names in groups.items()
    )
    return Table(f"{engine_name}: where its figures come from.", READOUTS, rows, align="l")


# The environment of results: date, machine and commit, then all versions on one line.

CONCURRENT_RUNS: Final = "runs at a time"  # how many ran side by side, each on a share of the machine


def environment_facts(environment: Mapping[str, str], leave_out: Container[str] = ()) -> list[tuple[str, str]]:
    """Pairs of name and value: date, machine, hosts, commit and runs at a time, as far as known, then all else in one.

    This is "Versions", without the names in ``leave_out``, which are given elsewhere.
    """
    first = [name for name in ("date", "machine", "hosts", "commit", CONCURRENT_RUNS) if name in environment]
    rest = [f"{name} {version}" for name, version in environment.items() if name not in first and name not in leave_out]
    return [*((name.capitalize(), environment[name]) for name in first), ("Versions", ", ".join(rest))]


def concurrency_note(environment: Mapping[str, str]) -> str:
    """A clause on times: "while 4 ran" where runs were made side by side, else ""."""
    return f"while {environment[CONCURRENT_RUNS]} ran" if CONCURRENT_RUNS in environment else ""


# The checks of an engine's adapter, as the terminal and Python print them.

STYLES = {Finding.PASSED: "green", Finding.FAILED: "bold red", Finding.EXPECTED: "yellow"}


def printout(engine_name: str, checks: Sequence[CheckResult]) -> Printout:
    """The printed checks of an adapter: a line each, and how many ended in which way, with the engine's name."""
    counts = Counter(each.finding for each in checks)
    closing = f"{engine_name}: " + ", ".join(f"{counts[finding]} {finding}" for finding in Finding if counts[finding])
    return Printout([Table("", ("check", "", ""), _rows(checks), "l")], [closing])


def _rows(results: Sequence[CheckResult]) -> list[Sequence[TableCell | Words]]:
    """The rows of the checks: name, finding, detail; mutants of the same finding and detail share a row.

    That has their number. Each mutant that failed has a row of its own.
    """
    groups: Counter[tuple[str, Finding, str]] = Counter()
    for each in results:
        alike = each.check.startswith(MUTANT) and each.finding is not Finding.FAILED
        groups[MUTANT if alike else each.check, each.finding, each.detail] += 1
    return [
        (
            f"{count} mutant{'s' if count > 1 else ''}" if name == MUTANT else name,
            TableCell(finding.value, colour=STYLES.get(finding, "dim")),
            detail,
        )
        for (name, finding, detail), count in groups.items()
    ]
