"""A mapping as text: all that was recognised in result files, to be looked through, changed and given back."""

from __future__ import annotations

import json
import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass

from analytic.errors import printable
from comparisons.faults.fault import Correction
from comparisons.imported.columns import NO_CORRECTION, keys

TO_FILL_IN = '""  # fill in'


@dataclass(frozen=True)
class MappingLine:
    """A column in a mapping: its header, where it stands if that does not tell it, what it is or why it is nothing."""

    header: str
    file: str = ""
    table: int = 0
    signal: str = ""
    unit: str = ""
    reason: str = ""
    correction: Correction = NO_CORRECTION
    scale: float = 1.0


def mapping_text(linkage: str, axis: str, lines: Iterable[MappingLine], ignored: Iterable[str]) -> str:
    """The text of a mapping; a unit that is not known is left to be filled in, what is not judged is a comment."""
    head = [
        f"# Columns of result files as signals of {printable(linkage)}: correct what is wrong, and give this file",
        "# to judge with --mapping. Corrections that a [[column]] has are applied as they stand here, as",
        "# the value sign * factor * value + offset (in the column's unit) at the time time + time_shift (s).",
    ]
    head += [f'axis = "{axis}"'] if axis else []
    ignored = list(ignored)
    head += [f"ignore = [{', '.join(map(_quoted, ignored))}]"] if ignored else []
    return "\n".join([*head, *(entry for line in lines for entry in ("", *_entry(line)))]) + "\n"


def _entry(line: MappingLine) -> list[str]:
    entry = ["[[column]]", f"header = {_quoted(line.header)}"]
    entry += [f"file = {_quoted(line.file)}"] if line.file else []
    entry += [f"table = {line.table}"] if line.table else []
    if line.reason:
        return [
            f"# not judged: {printable(line.reason)}",
            *(f"# {part}" for part in (*entry, 'signal = ""', 'unit = ""')),
        ]
    unit = _quoted(line.unit) if line.unit else TO_FILL_IN
    return [*entry, f"signal = {_quoted(line.signal)}", f"unit = {unit}", *keys(line.correction, line.scale)]


def _quoted(text: str) -> str:
    """A TOML string."""
    return json.dumps(printable(text), ensure_ascii=False).replace("\x7f", "\\u007f")


def with_proposals(text: str, proposals: Mapping[str, Correction], units: Mapping[str, float]) -> str:
    """A mapping with corrections that are not agreed to yet, by the names of signals, as comments to take away.

    ``units`` are the SI values of the units in which their offsets are written.
    """
    for signal, correction in proposals.items():
        lines = "".join(
            f"\n# {line}  # estimated: remove the first # to accept"
            for line in keys(correction, units.get(signal, 1.0), 9)
        )
        pattern = rf"(?m)^(signal = {re.escape(_quoted(signal))}\nunit = .*)$"
        text = re.sub(pattern, lambda entry, added=lines: entry[1] + added, text)  # type: ignore[misc]
    return text
