"""A mapping as text: all that was recognised in result files, to be looked through, changed and given back."""

from __future__ import annotations

import json
import re
from collections.abc import Iterable, Mapping, Sequence

from analytic.errors import printable
from comparisons.faults.fault import Correction
from comparisons.imported.columns import keys
from comparisons.imported.headers.meaning import Meaning

HEAD = """# Columns of result files as signals of {}: correct what is wrong, and give this file
# to judge with --mapping. Corrections that a [[column]] has are applied as they stand here, as
# the value sign * factor * value + offset (in the column's unit) at the time time + time_shift (s).
"""


def mapping_text(linkage: str, axis: str, entries: Iterable[Sequence[str]], ignored: Iterable[str]) -> str:
    """The text of a mapping with these entries, which leave out the headers that are ignored."""
    head = [f'axis = "{axis}"'] if axis else []
    headers = ", ".join(map(_quoted, ignored))
    head += [f"ignore = [{headers}]"] if headers else []
    lines = "\n".join([*head, *(line for entry in entries for line in ("", *entry))])
    return HEAD.format(printable(linkage)) + lines + "\n"


def entry(
    header: str, place: Mapping[str, str | int], meaning: Meaning | None, reason: str, correction: Correction
) -> list[str]:
    """The lines of a column: its header, where it stands if that does not tell it, and what it is.

    A unit that is not known is left to be filled in, what is not judged is a comment.
    """
    lines = ["[[column]]", f"header = {_quoted(header)}"]
    lines += [f"{key} = {_quoted(at) if isinstance(at, str) else at}" for key, at in place.items() if at]
    if meaning is None or reason:
        return [f"# not judged: {printable(reason)}", *(f"# {line}" for line in (*lines, 'signal = ""', 'unit = ""'))]
    unit = _quoted(meaning.printed) if meaning.printed else '""  # fill in'
    own = keys(correction, meaning.unit.factor if meaning.unit else 1.0)
    return [*lines, f"signal = {_quoted(meaning.signal)}", f"unit = {unit}", *own]


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
