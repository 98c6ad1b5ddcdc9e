"""What ``linkproof engines`` does: tell what each engine can do and where its figures come from."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from rich.console import RenderableType

from engines.registry import engine, engine_names
from reports.command_line.destination import Destination
from reports.facts.readouts import abilities_told, readout_table
from reports.text.screen import line


def list_engines(names: Sequence[str], destination: Destination) -> None:
    """Print or write the abilities and read-outs of these engines, of all by default."""
    told = [abilities_told(engine(name)) for name in names or engine_names()]
    destination.print(*(part for one in told for part in _shown(one)))
    destination.write_json({"records": told})


def _shown(told: Mapping[str, Any]) -> list[RenderableType]:
    version = told["version"] or "not installed"
    control = ", the reference's control, no engine" if told["control"] else ""
    kinds = ("drives", "joints", "loads", "settings")
    return [
        line(f"{told['engine']} ({version}{control})", "bold"),
        *(line(f"  {kind}: {', '.join(told[kind])}") for kind in kinds),
        readout_table(told["engine"], told["readouts"]),
        line(""),
    ]
