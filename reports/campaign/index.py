"""A campaign's verdict on its engines, and the first page of its report, with cards and tables."""

from __future__ import annotations

import statistics
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property, partial
from typing import Any, Final
from urllib.parse import urlencode

from analytic.description.linkage import ReleasedRegime
from comparisons.designer.sheet import Sheet
from comparisons.trials.campaign.results import CampaignResults
from comparisons.trials.judging.limits import deciding, grouped
from comparisons.trials.judging.records import CONTROL, Error, RunRecord, Verdict
from engines.contract import Setting
from reports.charts.scheme import card_figure
from reports.document import numbers
from reports.document.parts import (
    Bullets,
    Card,
    Cards,
    Command,
    Facts,
    Fold,
    Mono,
    Page,
    PageFigure,
    PageLink,
    Paragraph,
    Part,
    Section,
    Table,
    TableCell,
    Widget,
    Words,
)
from reports.document.templates import lines, sentence
from reports.mechanism.engines import reasons
from reports.mechanism.page import file_of
from reports.mechanism.shown import key_figures
from reports.records import (
    LOOKS,
    anchor,
    appeared_note,
    changes_table,
    columns,
    computed_or_shared,
    concurrency_note,
    environment_facts,
    every_record,
    family_title,
    limit_table,
    looks,
    origin_words,
    readout_table,
    share,
)

# Which engine to trust for which quantity: a campaign's records by engine, setting and family of quantities.


# Families of their own beside those of the quantities under a prescribed motion.
RELEASED: Final = "a released crank"
CHECKS: Final = "checks of the motion"
MOST_PERCENT: Final = 100.0  # peaks that are given in per cent
SHIFT: Final = 0.01  # s that is added to times for their geometric mean, lest the shortest decide it
# The setting that decides, the first of these that ran; what an engine does untuned is shown and decides nothing.
DECISIVE: Final = (Setting.TUNED.value, Setting.BEST.value, Setting.NAIVE.value)


@dataclass(frozen=True)
class EngineRecords:
    """The records of one engine at one setting in one family of quantities, judged or not."""

    records: tuple[Error, ...] = ()

    @cached_property
    def judged(self) -> tuple[Error, ...]:
        """The records with a verdict, passed or failed."""
        return tuple(record for record in self.records if Verdict(record.outcome).judged)

    @property
    def worst(self) -> Error | None:
        """The judged record whose error is the largest multiple of its limit; None if none has an error."""
        return max((r for r in self.judged if r.error_max is not None), key=share, default=None)

    @property
    def error(self) -> float | None:
        """The largest error over the peak of the judged records; None if none has an error."""
        return max((r.error_max for r in self.judged if r.error_max is not None), default=None)

    @property
    def failed(self) -> bool:
        """Whether any of the judged records failed."""
        return any(Verdict(record.outcome).failed for record in self.judged)

    @property
    def reason(self) -> str:
        """The first reason that a record gives; "" without any."""
        return next((record.detail for record in self.records if record.detail), "")

    def style(self, *, is_idle: bool) -> str:
        """The style class of a cell: "pass", "over", or "failed" and "absent" without an error.

        It is "muted" for an error if ``is_idle``: an idle setting decides nothing.
        """
        if self.error is None:
            return "failed" if self.failed else "absent"
        return "muted" if is_idle else "over" if self.failed else "pass"


@dataclass(frozen=True)
class EngineRanking:
    """The ranking of a campaign's engines."""

    results: CampaignResults

    @cached_property
    def cells(self) -> Mapping[tuple[str, str], Mapping[str, EngineRecords]]:
        """Records and invariants by (engine, setting), and of each by the title of the family of quantities."""
        every = (*self.results.records, *self.results.invariants)
        runs = grouped(((record.engine, record.setting), record) for record in every)
        families = {run: grouped((self._family_of_record(record), record) for record in of) for run, of in runs.items()}
        return {
            run: {name: EngineRecords(tuple(records)) for name, records in groups.items()}
            for run, groups in families.items()
        }

    @cached_property
    def families(self) -> tuple[str, ...]:
        """The titles of the families in which any engine was judged, in the order of the table.

        After those of quantities come ``RELEASED`` and ``CHECKS``.
        """
        some = {name for cells in self.cells.values() for name, cell in cells.items() if cell.judged}
        names = (*map(family_title, columns(self.results)[0]), RELEASED, CHECKS)
        return tuple(name for name in names if name in some)

    @cached_property
    def settings(self) -> tuple[str, ...]:
        """The names of the settings that ran, the decisive one first, unknown ones last, sorted."""
        ran = {setting for _, setting in self.cells}
        return (*(name for name in DECISIVE if name in ran), *sorted(ran - {*DECISIVE}))

    def is_idle(self, setting: str) -> bool:
        """Whether a setting decides nothing, as naive does beside other settings."""
        return setting == Setting.NAIVE.value and setting in self.settings[1:]

    @cached_property
    def controls(self) -> frozenset[str]:
        """Names of the engines that are the reference's second derivation."""
        return frozenset(record.engine for record in self.results.records if record.origin == CONTROL)

    @cached_property
    def engines(self) -> tuple[str, ...]:
        """Names of the engines, sorted, those of controls last."""
        return tuple(sorted({engine for engine, _ in self.cells}, key=lambda name: (name in self.controls, name)))

    def runs(self, engine: str, setting: str) -> list[RunRecord]:
        """All runs of an engine at a setting."""
        return [run for run in self.results.runs if (run.engine, run.setting) == (engine, setting)]

    def cell(self, engine: str, setting: str, family_name: str) -> EngineRecords:
        """The records of an engine at a setting in a family of quantities, called by its title; empty without any."""
        return self.cells.get((engine, setting), {}).get(family_name, EngineRecords())

    def row(self, engine: str, setting: str) -> dict[str, EngineRecords]:
        """The records of each family in which an engine was judged at a setting, by the family's title."""
        cells = {name: self.cell(engine, setting, name) for name in self.families}
        return {name: cell for name, cell in cells.items() if cell.judged}

    def most_accurate(self, setting: str, family_name: str) -> str:
        """The engine with the least maximum error in a family, of those that never failed.

        "" without one, or where it has no rivals; controls are none.
        """
        cells = {
            engine: self.cell(engine, setting, family_name) for engine in self.engines if engine not in self.controls
        }
        errors = {engine: cell.error for engine, cell in cells.items() if cell.error is not None and not cell.failed}
        return min(errors, key=lambda engine: errors[engine] or 0.0, default="") if len(cells) > 1 else ""

    def seconds(self, engine: str, setting: str) -> float | None:
        """Set-up and stepping of a run, s, as the shifted geometric mean of all that made steps; None without any."""
        runs = [run.setup_seconds + run.seconds for run in self.runs(engine, setting) if run.steps]
        return statistics.geometric_mean(time + SHIFT for time in runs) - SHIFT if runs else None

    def _family_of_record(self, record: Error) -> str:
        """The title of a record's family: ``CHECKS``, ``RELEASED``, or that of its quantity."""
        if record.quantity in self.checks:
            return CHECKS
        if (record.mechanism, record.variant, record.regime) in self._released_regimes:
            return RELEASED
        return family_title(record.quantity)

    @cached_property
    def checks(self) -> frozenset[str]:
        """Names of the invariants, which need no reference."""
        return frozenset(record.quantity for record in self.results.invariants)

    @cached_property
    def _released_regimes(self) -> frozenset[tuple[str, str, str]]:
        """Mechanism, variant and name of every regime in which the crank is released."""
        return frozenset(
            (linkage.name, linkage.variant, regime.name)
            for linkage in self.results.linkages
            for regime in linkage.regimes
            if isinstance(regime, ReleasedRegime)
        )


def ratio(record: Error) -> str:
    """An error divided by its limit as text, to two digits; "< 0.001" below a thousandth."""
    value = share(record)
    return "< 0.001" if value < 1e-3 else numbers.figure(value, 2)


def verdict(trust: EngineRanking) -> tuple[str, ...]:
    """Sentences on changes, on the engines to trust, and on the naive settings; those without occasion are left out.

    Nobody is to be trusted where the campaign has not passed. The quickest is not named: a campaign times each run
    once, which cannot tell times from noise; a benchmark can. Raises IndexError where nothing ran.
    """
    setting, results = trust.settings[0], trust.results
    engines = [name for name in trust.engines if name not in trust.controls] or list(trust.engines)
    count = sum(entry.fails for entry in results.changes)
    lines = (
        sentence("verdict_changes", count=count) if count else "",
        _trust_sentence(trust, engines, setting),
        _naive_sentence(trust, engines) if trust.is_idle(Setting.NAIVE.value) else "",
    )
    return tuple(line for line in lines if line)


def _trust_sentence(trust: EngineRanking, engines: Sequence[str], setting: str) -> str:
    """Sentences, as one text, on the engines to trust in all families, in some, and in none, at a setting.

    ``engines`` are the names of those to speak of.
    """
    judged = {name: trust.row(name, setting) for name in engines}
    wrong = {name: [f for f, cell in cells.items() if cell.failed] for name, cells in judged.items()}
    lacking = {name: [f for f in trust.families if f not in judged[name]] for name in engines}
    right = [name for name in engines if judged[name] and not wrong[name]]
    return sentence(
        "verdict_trust",
        setting=setting,
        whole=[name for name in right if not lacking[name]],
        part=_engines_by_families({name: lacking[name] for name in right}),
        wrong=_engines_by_families(wrong),
        silent=[name for name in engines if not judged[name]],
        red=_has_failed(trust.results),
        count=sum(len(cell.judged) for name in right for cell in judged[name].values()),
    )


def _has_failed(results: CampaignResults) -> bool:
    """Whether a deciding record failed, linkproof itself was at fault, or a change since the recorded results fails."""
    decided = deciding((*results.records, *results.invariants))
    failed = any(Verdict(record.outcome).failed or record.outcome == Verdict.SUITE_ERROR for record in decided)
    return failed or any(entry.fails for entry in results.changes)


def _naive_sentence(trust: EngineRanking, engines: Sequence[str]) -> str:
    """Sentences, as one text, on which of these engines are within limits at naive settings, which decide nothing."""
    ran = {name: trust.row(name, Setting.NAIVE.value).values() for name in engines}
    over = {name: max(h.error or 0.0 for h in cells) for name, cells in ran.items() if any(h.failed for h in cells)}
    within = [name for name, cells in ran.items() if cells and name not in over]
    rows = [(name, _share_of_peak(error)) for name, error in sorted(over.items(), key=lambda item: item[1])]
    return sentence("verdict_untuned", within=within, over=rows)


def _share_of_peak(error: float) -> str:
    """An error over the peak as text in per cent, two digits; from 100 peaks on as a number of peaks."""
    if error < MOST_PERCENT:
        return f"{float(f'{100.0 * error:.2g}'):g} %"
    return f"{numbers.printed(float(f'{error:.2g}'))} peaks"


def _engines_by_families(families: Mapping[str, Sequence[str]]) -> dict[tuple[str, ...], list[str]]:
    """Engines by their families, those with the same families together; engines without any are left out."""
    return grouped((tuple(names), engine) for engine, names in families.items() if names)


# A card of a mechanism: its scheme and the figures it is chosen by.


FIGURES: Final = ("peak torque", "peak force", "peak power", "mean Jeq", "stroke")


def card(sheet: Sheet) -> Card:
    """The card of a sheet's mechanism with a link to its page: scheme, if it has positions, and its ``FIGURES``.

    The scheme is drawn when the page is written.
    """
    linkage = sheet.linkage
    words = linkage.title + (f", {sheet.variant}" if len(linkage.variants) > 1 else "")
    facts = Facts(tuple((what, value) for what, value, _ in key_figures(sheet) if what in FIGURES))
    if sheet.positions is None:
        return Card(PageLink(words, file_of(sheet)), (facts,))
    drawing = partial(card_figure, linkage, sheet.positions)
    picture = PageFigure(anchor(sheet.name, sheet.variant), "", f"Scheme of {linkage.title}", drawing)
    return Card(PageLink(words, file_of(sheet)), (picture, facts))


FIRST_SHOWN: Final = "Mkr"  # of the picture
LEAST, OUTLINE = 1e-16, 1.5  # of an error that is drawn; px, of a symbol
LAYOUT: Final[Mapping[str, Any]] = {
    "height": 420,
    "legend": {"orientation": "h", "y": 1.02, "yanchor": "bottom", "x": 0},
    "hovermode": "closest",
    "margin": {"l": 70, "r": 20, "t": 8, "b": 48},
    "xaxis": {"type": "log", "title": {"text": "time of a run, s"}, "exponentformat": "power", "dtick": 1},
    "yaxis": {
        "type": "log",
        "title": {"text": "largest error / peak", "standoff": 12},
        "exponentformat": "power",
        "dtick": 2,
    },
}
FILE, TITLE = "index.html", "Overview"


def index(
    results: CampaignResults | None,
    sheets: Sequence[Sheet],
    studies: tuple[Words, ...] = (),
    cost: tuple[Paragraph, ...] = (),
) -> Page:
    """The first page of a folder: campaign, mechanisms, ``studies`` (a link and a sentence each), their ``cost``.

    What there is not is left out. ``results`` is None without a campaign; ``cost``, paragraphs on the cheapest engines,
    follows the verdict.
    """
    trust = EngineRanking(results) if results is not None and results.records else None
    cards = Cards(tuple(map(card, sheets)))
    return Page(
        file=FILE,
        title=TITLE,
        heading="Planar linkages in closed form" if results is None else "Which engine to trust for which quantity?",
        subtitle=sentence("index_subtitle", results=results, mechanisms=len({sheet.name for sheet in sheets})),
        parts=(*_verdict(trust, cost), *((Bullets(studies),) if studies else ())),
        charts=trust is not None,
        sections=(
            *((_engines_section(trust),) if trust is not None else ()),
            *((Section("mechanisms", "The mechanisms", (cards,)),) if sheets else ()),
            *((_run_section(results, sheets),) if results is not None else ()),
        ),
    )


def _verdict(trust: EngineRanking | None, cost: tuple[Paragraph, ...]) -> Iterator[Part]:
    """Yield the parts on the verdict on the engines, with its picture, and the ``cost``.

    Only the cost without records.
    """
    if trust is not None:
        first, *others = verdict(trust)
        yield Paragraph(first, "verdict")
        yield picture(trust)
        yield from (Paragraph(line, "lead") for line in others)
    yield from cost


def _engines_section(trust: EngineRanking) -> Section:
    """The section of the engines' results: settings, families, and what has changed."""
    appeared, changes = appeared_note(trust.results.changes), changes_table(trust.results.changes)
    return Section(
        "engines", "The engines", (settings_table(trust), families_table(trust), *map(Paragraph, appeared), *changes)
    )


def picture(trust: EngineRanking) -> Widget:
    """A widget of error over the peak against time, with a dot for every engine and setting; its family can be chosen.

    Released cranks and checks are left out.
    """
    names = sorted((name for name in trust.families if name not in (RELEASED, CHECKS)), key=FIRST_SHOWN.__ne__)
    figures = [{"name": name, "data": list(_traces(trust, name)), "layout": LAYOUT} for name in names]
    words = sentence("index_picture", settings=[(n, LOOKS[n]) for n in trust.settings if n in LOOKS])
    data = {"what": "Quantity", "figures": figures, "words": words}
    return Widget("figures", "picture", "Largest error against the time of a run", data, instead=())


def _traces(trust: EngineRanking, name: str) -> Iterator[dict[str, Any]]:
    """Yield a trace of Plotly for every engine in the family ``name``, a dot for each setting, JSON-ready.

    A setting has one if it has an error and a run that made steps; "x" is the time, s, "y" the error over the peak.
    Its "customdata" are the addresses of the worst curves.
    """
    for engine, look in looks(trust.engines, trust.controls).items():
        cells = {setting: trust.cell(engine, setting, name) for setting in trust.settings}
        known = {setting: cell for setting, cell in cells.items() if cell.error is not None and cell.worst is not None}
        times = {setting: trust.seconds(engine, setting) or 0.0 for setting in known}
        shown = [setting for setting in known if times[setting]]
        symbols = [look.symbol + "-open" * (LOOKS.get(setting) == "open") for setting in shown]
        edges = [OUTLINE * (LOOKS.get(setting) == "outlined") for setting in shown]
        yield {
            "type": "scatter",
            "mode": "lines+markers",
            "name": engine,
            "x": [times[setting] for setting in shown],
            "y": [max(known[setting].error or 0.0, LEAST) for setting in shown],
            "line": {"color": f"ink:{look.ink}", "width": 0.6},
            "marker": {
                "color": f"ink:{look.ink}",
                "size": 11,
                "symbol": symbols,
                "line": {"color": "ink:ink", "width": edges},
            },
            "hovertext": [
                f"<b>{engine} {setting}</b><br>{numbers.error(known[setting].error)} of the peak at most in "
                f"{numbers.seconds(times[setting])}"
                for setting in shown
            ],
            "hoverinfo": "text",
            "customdata": [leads_to(trust, known[setting].worst) for setting in shown],
        }


def leads_to(trust: EngineRanking, record: Error | None) -> str:
    """The address of an error's curve on the page of its mechanism; "" for None and for a check, which has no curve.

    It is within the report's folder. Raises KeyError for a mechanism that is not the campaign's.
    """
    if record is None or record.quantity in trust.checks:
        return ""
    linkages = {(linkage.name, linkage.variant): linkage for linkage in trust.results.linkages}
    return f"{file_of(linkages[record.run[:2]])}#{urlencode({'curve': f'{record.regime}/{record.quantity}'})}"


def settings_table(trust: EngineRanking) -> Table:
    """The table of engines and settings: share within limits, largest error over its limit, and time of a run."""
    rows: list[tuple[TableCell | str, ...]] = [
        (engine, *(cell for setting in trust.settings for cell in _share_error_and_time(trust, engine, setting)))
        for engine in trust.engines
    ]
    beside = "".join(f", {words}" for words in (concurrency_note(trust.results.document["environment"]),) if words)
    return Table(
        f"All comparisons of an engine at a setting: the share within limits, the worst, and a run's time{beside}.",
        ("engine", *(("within limits", "error / limit", "time") * len(trust.settings))),
        rows,
        groups=(("", 1), *((setting + " (decides nothing)" * trust.is_idle(setting), 3) for setting in trust.settings)),
        note=sentence("index_settings", has_control=bool(trust.controls), shift=SHIFT),
        style="standings",
    )


def _share_error_and_time(trust: EngineRanking, engine: str, setting: str) -> tuple[TableCell | str, ...]:
    """Three cells: the share of deviations from the closed form within limits, the worst one, and the time of a run.

    One cell over all three, with the reason, without any.
    """
    cells = trust.cells.get((engine, setting), {})
    own = EngineRecords(tuple(record for name, cell in cells.items() if name != CHECKS for record in cell.records))
    style = own.style(is_idle=trust.is_idle(setting))
    if own.worst is None:
        return (TableCell(numbers.ABSENT, style, tooltip=own.reason, note=own.reason, span=3),)
    within = sum(not Verdict(record.outcome).failed for record in own.judged)
    share = TableCell(f"{100.0 * within / len(own.judged):.3g} %", note=f"{within} of {len(own.judged)}")
    place = f"{family_title(own.worst.quantity)}, {own.worst.mechanism}"
    largest = TableCell(ratio(own.worst), style, note=place, tooltip=sentence("index_worst", record=own.worst))
    computed = [words for words in computed_or_shared(own.records).split("; ") if not words.startswith("shared")]
    runs = max(run.runs for run in trust.runs(engine, setting))
    origin = "; ".join(filter(None, (origin_words(own.records, runs), *computed)))
    time = trust.seconds(engine, setting)
    return share, largest, TableCell(numbers.ABSENT if time is None else numbers.seconds(time), note=origin)


def families_table(trust: EngineRanking, *, leads: bool = True) -> Table:
    """The table of engines and families: each largest error over the peak, a column's least marked.

    A cell ``leads`` to its curve if wanted. The naive setting is there only if no other ran.
    """
    rows: list[tuple[TableCell | str, ...]] = [
        (engine, setting, *(_family_cell(trust, engine, setting, name, leads=leads) for name in trust.families))
        for setting in [name for name in trust.settings if name != Setting.NAIVE.value] or trust.settings
        for engine in trust.engines
        if trust.row(engine, setting)
    ]
    lacking = [record for record in every_record(trust.results) if record.error_max is None]
    return Table(
        "The largest error over the peak, by quantity; the least of each column is marked.",
        ("engine", "setting", *trust.families),
        rows,
        align="llr",
        note=sentence("index_families", families=trust.families, reasons=reasons(lacking, lambda _: "")),
        style="families",
    )


def _family_cell(trust: EngineRanking, engine: str, setting: str, name: str, *, leads: bool) -> TableCell:
    """The cell of an engine in the family ``name``: its largest error, or a sign and the reason for its absence.

    It is a link to the curve if it ``leads`` there, and marked as the best of its column.
    """
    records, worst = trust.cell(engine, setting, name), trust.cell(engine, setting, name).worst
    style = records.style(is_idle=trust.is_idle(setting))
    if worst is None:
        return TableCell("✗" if records.failed else numbers.ABSENT, style, tooltip=records.reason)
    best = " best" if name != CHECKS and trust.most_accurate(setting, name) == engine else ""
    words = ("✗ " if records.failed else "") + numbers.steady_error(records.error)
    place = leads_to(trust, worst) if leads else ""
    tooltip = sentence("index_worst", record=worst)
    return TableCell(PageLink(words, place) if place else words, style + best, tooltip=tooltip)


def _run_section(results: CampaignResults, sheets: Sequence[Sheet]) -> Section:
    """The section, folded, on what was run: facts, limits, read-outs and limitations."""
    readouts = tuple(readout_table(name, words) for name, words in results.document["readouts"].items())
    sources = Section("sources", "Where the engines' figures come from", (Paragraph(sentence("readouts")), *readouts))
    says = Paragraph("Limits of these figures.")
    repeat = (Command(results.document["command"]), Paragraph(sentence("repeat")))
    parts = (
        Facts(_facts(results)),
        Section("limits", "Limits and their reasons", (limit_table(results),)),
        *((sources,) if readouts else ()),
        Section("limitations", "Known limitations", (says, Bullets(_limitation_sentences(results, sheets)))),
        Section("repeat", "Repeat this report", repeat),
    )
    summary = "Machine, versions, regimes, limits and their reasons, known limitations, the command that repeats it"
    return Section("run", "What was run", (Fold(summary, parts),))


def _facts(results: CampaignResults) -> tuple[tuple[str, str | Mono], ...]:
    """Name and value, in words, of everything that decides a figure or a time of the report, a pair each."""
    engines = {run.engine: run.engine_version for run in results.runs}
    regimes = dict.fromkeys((record.regime, record.conditions) for record in every_record(results))
    versions = ", ".join(f"{name} {engines[name] or 'not installed'}" for name in sorted(engines))
    return (
        ("Command", Mono(results.document["command"])),
        ("Mechanisms", ", ".join(f"{linkage.name} ({linkage.variant})" for linkage in results.linkages)),
        ("Regimes", "; ".join(f"{name}: {conditions}" for name, conditions in regimes)),
        ("Engines", versions),
        *environment_facts(results.document["environment"], leave_out=engines),
    )


def _limitation_sentences(results: CampaignResults, sheets: Sequence[Sheet]) -> tuple[str, ...]:
    """The known limitations of a campaign, a sentence each; some are about the ``sheets`` of its linkages."""
    released = {regime for sheet in sheets for regime in sheet.released}
    return tuple(
        lines(
            "limitations",
            closure=max((sheet.facts.get("closure_error") or 0.0 for sheet in sheets), default=0.0),
            released=sorted(released),
            left_out=sum(record.left_out for record in results.records),
            samples=sum(record.samples for record in results.records),
            noted=[sheet.linkage.title for sheet in sheets if sheet.linkage.notes],
        )
    )
