"""``linkproof engines``, ``check-engine`` and ``export``: list engines, check an adapter, write a run as a script."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

from analytic.errors import LinkproofError
from comparisons.campaign.campaign import cases
from comparisons.conformance.trial import Finding
from comparisons.exported_run import exported, exported_cell
from comparisons.runs.files import check_writable, write_text
from comparisons.runs.plugins import engine, engines
from comparisons.stress.cells import find_cell
from engines.contract import Engine, Setting
from engines.registry import Unusable, engine_names, why_unavailable
from reports.command_line.destination import Destination, write_to_stdout
from reports.document.parts import Paragraph
from reports.document.terminal import Printed
from reports.records.origins import printout, readout_table
from reports.requests import FAILED, PASSED
from reports.requests.campaign import request
from reports.requests.campaign_options import CompareOptions, ExportOptions
from reports.requests.doctor import engine_findings
from reports.requests.options import command_line


def list_engines(names: Sequence[str], destination: Destination) -> None:
    """Print or write the abilities and read-outs of these engines, of all by default."""
    tables = [_describe_engine(adapter) for adapter in engines(names or engine_names())]
    destination.print(*(part for table in tables for part in _engine_parts(table)))
    destination.write_json({"records": tables})


def _describe_engine(adapter: Engine) -> dict[str, Any]:
    """The abilities and read-outs of an engine, and the reason if it cannot be used here."""
    error = adapter.error if isinstance(adapter, Unusable) else None
    reason = why_unavailable(adapter) if error is None else str(error)
    able = adapter.abilities
    return {
        "engine": adapter.name,
        "version": adapter.version(),
        "control": adapter.is_control,
        "drives": _type_names(able.drives),
        "joints": ["PinJoint", *_type_names(able.joints)],
        "loads": ["gravity", *_type_names(able.loads)],
        "varying_loads": able.varying_loads,
        "massless_bodies": able.massless,
        "settings": [setting.value for setting in Setting if setting in able.settings],
        "readouts": able.as_dict(),
        "unusable": reason or "",
    }


def _type_names(types: Iterable[type]) -> list[str]:
    return sorted(entry.__name__ for entry in types)


def _engine_parts(table: Mapping[str, Any]) -> list[Printed]:
    """What is printed of one engine: its name and version, its abilities, its read-outs."""
    version = table["unusable"] or table["version"]
    control = ", the reference's control, no engine" if table["control"] else ""
    kinds = ("drives", "joints", "loads", "settings")
    return [
        Paragraph(f"{table['engine']} ({version}{control})", colour="bold"),
        *(f"  {kind}: {', '.join(table[kind])}" for kind in kinds),
        readout_table(table["engine"], table["readouts"]),
        "",
    ]


def export(options: ExportOptions, out: Path | None) -> None:
    """Write the run of one mechanism, or of one cell, in one engine and setting as a script of the engine's own.

    Raises LinkproofError for what does not exist or cannot be exported.
    """
    if out is not None:
        check_writable(out)
    if (options.cell is None) != (options.mechanism is not None):
        raise LinkproofError("expected a mechanism with --engine, or a --cell, and not both: leave one out")
    text = _export_run(options) if options.cell is None else _export_cell(options, options.cell)
    if out is None:
        write_to_stdout(text)  # Python reads UTF-8
    else:
        write_text(out, text)


def _export_cell(options: ExportOptions, cell: str) -> str:
    if options != ExportOptions(cell=cell):
        raise LinkproofError("--cell already defines the whole run: leave the other options out")
    return exported_cell(find_cell(cell), command_line("export", options))


def _export_run(options: ExportOptions) -> str:
    """The script of the one run that the options name; raises LinkproofError for none or several."""
    named = (options.mechanism, options.engine, options.setting)
    mechanisms, engine, setting = ((name,) if name else () for name in named)
    wanted = request(CompareOptions(mechanisms=mechanisms, engine=engine, setting=setting, **vars(options.motion)))
    if not engine:
        raise LinkproofError("expected one --engine to export, got 0: name one")
    result, settings = cases(wanted), wanted.settings
    if len(result) != 1 or len(settings) != 1:
        raise LinkproofError(f"expected one regime and setting, got {len(result)} and {len(settings)}: name one each")
    return exported(result[0], engine[0], settings[0], command_line("export", options))


def check(name: str, destination: Destination, processes: int | None = None) -> int:
    """Make every check of an engine, print a line for each; returns the exit code. Raises as ``engine_findings``."""
    adapter = engine(name)
    results = engine_findings(adapter, processes)
    destination.write_json({"engine": name, "version": adapter.version(), "checks": [asdict(each) for each in results]})
    destination.print_out(printout(name, results))
    return FAILED if any(each.finding is Finding.FAILED for each in results) else PASSED
