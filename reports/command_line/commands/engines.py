"""What ``linkproof engines``, ``check-engine`` and ``export`` do: tell of engines, check one, write its run down."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

from analytic.errors import LinkproofError
from comparisons.campaign.campaign import cases
from comparisons.conformance.conformance import INSTALLED, MUTANT, check_engine
from comparisons.conformance.findings import Finding, Found
from comparisons.exported_run import exported, exported_cell
from comparisons.runs.failures import blamed_on
from comparisons.runs.files import check_writable, write_text
from comparisons.runs.plugins import engine, engines
from comparisons.stress.cells import find_cell
from engines.contract import Engine, Setting
from engines.registry import Unusable, engine_names, why_unavailable
from reports.command_line import FAILED, PASSED
from reports.command_line.destination import Destination, write_out
from reports.command_line.requests import CampaignChoice, command_line, request
from reports.document.parts import Paragraph, Table, TableCell, Words
from reports.document.terminal import Printed, Printout
from reports.records.readouts import readout_table

UNTESTED = (Finding.NOT_APPLICABLE, Finding.NOT_TESTED)
STYLES = {Finding.PASSED: "green", Finding.FAILED: "bold red", Finding.EXPECTED: "yellow"}


def list_engines(names: Sequence[str], destination: Destination) -> None:
    """Print or write the abilities and read-outs of these engines, of all by default."""
    told = [_told(adapter) for adapter in engines(names or engine_names())]
    destination.print(*(part for one in told for part in _shown(one)))
    destination.write_json({"records": told})


def _told(adapter: Engine) -> dict[str, Any]:
    """What an engine takes and offers, and why it cannot be used here, where it cannot."""
    error = adapter.error if isinstance(adapter, Unusable) else None
    reason = why_unavailable(adapter) if error is None else str(error)
    able = adapter.abilities
    return {
        "engine": adapter.name,
        "version": adapter.version(),
        "control": adapter.is_control,
        "drives": _names(able.drives),
        "joints": ["PinJoint", *_names(able.joints)],
        "loads": ["gravity", *_names(able.loads)],
        "varying_loads": able.varying_loads,
        "massless_bodies": able.massless,
        "settings": [setting.value for setting in Setting if setting in able.settings],
        "readouts": able.told(),
        "unusable": reason or "",
    }


def _names(types: Iterable[type]) -> list[str]:
    return sorted(one.__name__ for one in types)


def _shown(told: Mapping[str, Any]) -> list[Printed]:
    version = told["unusable"] or told["version"]
    control = ", the reference's control, no engine" if told["control"] else ""
    kinds = ("drives", "joints", "loads", "settings")
    return [
        Paragraph(f"{told['engine']} ({version}{control})", colour="bold"),
        *(f"  {kind}: {', '.join(told[kind])}" for kind in kinds),
        readout_table(told["engine"], told["readouts"]),
        "",
    ]


def export(choice: CampaignChoice, cell: str | None, out: Path | None) -> None:
    """Write the run of one mechanism, or of one cell, in one engine and setting as a script of the engine's own.

    Raises LinkproofError for what does not exist or cannot be exported.
    """
    if out is not None:
        check_writable(out)
    if (cell is None) != bool(choice.mechanisms):
        raise LinkproofError("expected a mechanism with --engine, or a --cell, and not both: leave one out")
    if cell is not None:
        if choice != CampaignChoice():
            raise LinkproofError("--cell already defines the whole run: leave the other options out")
        text = exported_cell(find_cell(cell), command_line("export", (), {"cell": [cell]}, {}))
    else:
        wanted = request(choice)
        if len(choice.engines) != 1:
            raise LinkproofError(f"expected one --engine to export, got {len(choice.engines)}: name one")
        found = cases(wanted)
        settings = wanted.settings
        if len(found) != 1 or len(settings) != 1:
            raise LinkproofError(
                f"expected one regime and setting, got {len(found)} and {len(settings)}: name one each"
            )
        text = exported(found[0], choice.engines[0], settings[0], choice.written("export"))
    if out is None:
        write_out(text)  # Python reads UTF-8
    else:
        write_text(out, text)


def check(name: str, destination: Destination, processes: int | None = None) -> int:
    """Make every check of an engine, print a line of each; returns the exit code. Raises as ``findings``."""
    adapter = engine(name)
    found = findings(adapter, processes)
    destination.write_json({"engine": name, "version": adapter.version(), "checks": [asdict(each) for each in found]})
    destination.print_out(printout(name, found))
    return FAILED if any(each.finding is Finding.FAILED for each in found) else PASSED


def printout(name: str, checks: Sequence[Found]) -> Printout:
    """A line of every check, and how many came to what."""
    counts = Counter(each.finding for each in checks)
    closing = f"{name}: " + ", ".join(f"{counts[finding]} {finding}" for finding in Finding if counts[finding])
    return Printout([Table("", ("check", "", ""), _rows(checks), "l")], [closing])


def findings(adapter: Engine, processes: int | None = None) -> list[Found]:
    """What comes of every check of an engine.

    Raises LinkproofError where nothing could be checked, AdapterError for an engine that cannot be loaded.
    """
    if isinstance(adapter, Unusable):
        if adapter.error is None:
            raise LinkproofError(adapter.reason)
        with blamed_on(adapter):
            raise adapter.error
    found = check_engine(adapter, processes)
    absent = next((each.detail for each in found if each.check == INSTALLED and each.finding in UNTESTED), None)
    if absent is not None:
        raise LinkproofError(f"expected an engine to check, got none: {absent}")
    return found


def _rows(found: Sequence[Found]) -> list[Sequence[TableCell | Words]]:
    """A line of every check; of mutants that say the same, one line."""
    groups: dict[tuple[str, Finding, str], int] = {}
    for each in found:
        alike = each.check.startswith(MUTANT) and each.finding is not Finding.FAILED
        key = (MUTANT if alike else each.check, each.finding, each.detail)
        groups[key] = groups.get(key, 0) + 1
    return [
        (
            f"{count} mutant{'s' if count > 1 else ''}" if name == MUTANT else name,
            TableCell(finding.value, colour=STYLES.get(finding, "dim")),
            detail,
        )
        for (name, finding, detail), count in groups.items()
    ]
