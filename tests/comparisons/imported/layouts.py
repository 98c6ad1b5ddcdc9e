"""Writers of the layouts in which other tools export their results, for tests: from a small table to a file's text."""

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Channel:
    """A column to be written: what its tool would call it, its unit there, and values (n,) in that unit."""

    header: str
    unit: str
    values: np.ndarray


def csv(channels, *, delimiter=",", decimal=".", digits=6, quotes=False, title="", trailing=False):
    """A CSV with units in brackets behind the headers; numbers with ``digits`` significant digits."""
    headers = [f"{c.header} [{c.unit}]" if c.unit else c.header for c in channels]
    headers = [f'"{header}"' for header in headers] if quotes else headers
    rows = [
        [f"{x:.{digits}g}".replace(".", decimal) for x in row] for row in np.column_stack([c.values for c in channels])
    ]
    end = delimiter if trailing else ""
    lines = ([title] if title else []) + [delimiter.join(row) + end for row in [headers, *rows]]
    return "\n".join(lines) + "\n"


def solidworks(plots, *, digits=6):
    """SolidWorks Motion: every plot with a title line, quoted headers with the unit in round brackets."""
    parts = []
    for title, channels in plots:
        headers = ",".join(f'"{c.header} ({c.unit})"' for c in channels)
        rows = [",".join(f"{x:.{digits}g}" for x in row) for row in np.column_stack([c.values for c in channels])]
        parts.append("\n".join([f'"{title}"', headers, *rows]))
    return "\n\n".join(parts) + "\n"
