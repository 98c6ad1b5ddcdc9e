"""How every figure looks: colours that a colour-blind reader can tell apart, sizes that stay legible on paper.

Figures are drawn through matplotlib's object interface, with the fonts it brings along, so that two reports of the same
results are the same text. Nothing here knows an engine by name.
"""

from __future__ import annotations

from functools import cache
from typing import Any

import matplotlib
from matplotlib import colormaps
from matplotlib.colors import to_hex

from reports.document.chart import Ink
from reports.document.templates import FOLDER

# Okabe and Ito, dark enough for words; the closed form is always ink.
PALETTE = ("#0072b2", "#c75300", "#00855f", "#aa4499", "#5b45c9", "#8a6b00")
INK, MUTED, FAINT, REFERENCE = "#1d2733", "#5b6673", "#d8dde3", "#a9b3bf"
LIMIT_COLOUR = "#a02020"
PAPER, PLATE, GHOST = "#ffffff", "#e4e9ef", "#a8b8c8"  # behind a drawing, inside a link, what is faintly drawn

# Shades of a scale that grows evenly to the eye (viridis), for lines: none too pale on white, none too dark at night.
SHADES = 32
RAMP, NIGHT_RAMP = (
    tuple(to_hex(colormaps["viridis"](low + (high - low) * n / (SHADES - 1))) for n in range(SHADES))
    for low, high in ((0.0, 0.9), (0.3, 1.0))
)

# What each of a drawing's colours becomes where the reader's scheme is dark.
DARK = {
    INK: "#e4e8ed",
    MUTED: "#a3aebb",
    FAINT: "#37414d",
    REFERENCE: "#6f7b88",
    LIMIT_COLOUR: "#ff7b72",
    PAPER: "#12171e",
    PLATE: "#2b333d",
    GHOST: "#4d5a68",
    **dict(zip(PALETTE, ("#4aa8e8", "#f08a3c", "#33c79a", "#e08ad2", "#a99cf5", "#d9b93b"), strict=True)),
    **dict(zip(RAMP, NIGHT_RAMP, strict=True)),
}
NAMED = {"ink": INK, "muted": MUTED, "faint": FAINT, "reference": REFERENCE, "limit": LIMIT_COLOUR, "paper": PAPER}
FONT, FONT_SIZE = "DejaVu Sans", 9.0

# Inches of a figure that shares the page's width with another, and of one that has it to itself.
WIDTH, FULL_WIDTH = 5.4, 11.0
DOTS_PER_INCH = 160


def ink(name: Ink) -> str:
    """A colour of the palette by its number, one that has a name, or that of a share of the ramp."""
    if isinstance(name, float):
        return RAMP[round(name * (SHADES - 1))]
    return NAMED[name] if isinstance(name, str) else PALETTE[name % len(PALETTE)]


@cache
def house_style() -> Any:  # noqa: ANN401  which keys matplotlib's stubs know changes from release to release
    """How figures look, and how they are written: colours, sizes, fonts."""
    return matplotlib.rc_params_from_file(FOLDER / "figures.mplstyle", use_default_template=False)
