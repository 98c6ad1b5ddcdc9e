"""The end of an exported script: the engine's figures beside those of the closed form."""

from math import inf, nan  # noqa: F401 - numbers of the data below that have no literal
from typing import Any

import numpy as np


def show_figures(engine: str, samples: dict[str, Any], figures: list[tuple[Any, ...]]) -> None:
    """Print where the engine is furthest from the closed form, in SI units."""
    print(f"{'':44}{'time, s':>9}{engine:>20}{'when exported':>20}{'closed form':>20}{'difference':>12}")  # noqa: T201
    for what, unit, (channel, *joint), element, at, exported, true, factor in figures:
        time, values = map(np.asarray, samples[channel][joint[0]] if joint else samples[channel])
        read = float(values[(np.argmin(np.abs(time - at)), *element)]) * factor
        row = f"{what + ', ' + unit:44}{at:9.6f}{read:20.12g}{exported:20.12g}{true:20.12g}{read - true:12.1e}"
        print(row)  # noqa: T201
