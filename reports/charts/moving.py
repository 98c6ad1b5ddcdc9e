"""A scheme that moves: an inline drawing whose parts follow their bodies by rules of the style sheet alone.

All parts move together over the same ``SECONDS``, once along the axis of the positions; a script can stop them all, and
set the time they are at, through ``element.getAnimations({subtree: true})``.
"""

from __future__ import annotations

import re
from typing import Final

import numpy as np
from markupsafe import Markup, escape
from matplotlib.figure import Figure

from analytic.description.linkage import Linkage
from analytic.description.written import fixed
from comparisons.designer.sheet import Positions
from reports.charts import draw
from reports.charts.draw import GHOST, INK, MUTED, PALETTE, PAPER, PLATE, Array
from reports.charts.scheme import KinematicScheme, draw_paths, draw_position

SECONDS: Final = 6.0
# Of a drawing, and of a small one without mass centres: its size, its rim and a pin's radius, points, and the steps
# that its motion is written in.
LARGE: Final = ((330, 300), 18.0, 3.15, 120)
SMALL: Final = ((156, 112), 12.0, 2.25, 60)
DECIMALS: Final = (3, 3, 3, 3, 1, 1)  # of a turn's matrix and of its place in pixels
NOT_A_NAME: Final = re.compile(r"[^\w-]")
ELEMENT: Final = re.compile(r'<g id="([^"]+)">\s*<path ([^>]*?)(?: clip-path="[^"]*")?([^>]*)/>')
COLOURS = {INK: "ink", MUTED: "muted", GHOST: "reference", PAPER: "paper", PLATE: "line"} | {
    colour: f"c{number}" for number, colour in enumerate(PALETTE)
}


def moving_scheme(linkage: Linkage, positions: Positions, key: str, *, is_small: bool = False) -> Markup:
    """The scheme in motion as inline SVG of class "moving"; ``key`` makes its names its own on the page."""
    size, rim, pin, frames = SMALL if is_small else LARGE
    scheme, key = KinematicScheme(linkage, positions), NOT_A_NAME.sub("-", key)
    low, high = scheme.extent
    unit = float(np.min((np.array(size) - 2.0 * rim) / np.maximum(high - low, 1e-9)))
    width, height = np.ceil((high - low) * unit + 2.0 * rim)
    movers = {name: scheme.path(name, [(0.0, 0.0), (1.0, 0.0)]) for name in linkage.links} | scheme.stretches
    names = {name: f"{key}-{number}" for number, name in enumerate(movers)}

    def place(figure: Figure) -> None:
        """Draw paths and the first position, each artist named after the body it moves with."""
        axes = figure.add_axes((0.0, 0.0, 1.0, 1.0))
        axes.set_axis_off()
        left, top = low[0] - rim / unit, high[1] + rim / unit
        axes.set(xlim=(left, left + width / unit), ylim=(top - height / unit, top))
        draw_paths(axes, scheme)
        draw_position(axes, scheme, pin / unit, masses=not is_small)
        for artist in (*axes.lines, *axes.patches):
            artist.set_gid(names.get(str(artist.get_label()), ""))

    text = draw.svg(draw.drawn(width / 72.0, height / 72.0, place, placed=False))
    shapes = "".join(_shape(result, set(names.values())) for result in ELEMENT.findall(text))
    shift = np.array([low[0], high[1]])[:, None]
    rules = "".join(
        _rules(
            key, names[name], (ends - shift) * [[unit], [-unit]] + rim, scheme.shown_indices[scheme.clearest], frames
        )
        for name, ends in movers.items()
    )
    shared = (
        f"#{key} [class]{{animation:{SECONDS:g}s linear infinite{'' if positions.closed else ' alternate'};"
        f"transform-box:view-box}}"
        f"@media (prefers-reduced-motion:reduce){{#{key} [class]{{animation-play-state:paused}}}}"
    )
    return Markup(
        f'<svg id="{key}" class="moving" role="img" aria-label="{escape(linkage.title)} in motion" '
        f'viewBox="0 0 {width:g} {height:g}" width="{width / 0.75:.0f}" height="{height / 0.75:.0f}" fill="none">'
        f"<style>{shared}{rules}</style>{shapes}</svg>"
    )


def _rules(key: str, name: str, ends: Array, at: int, frames: int) -> str:
    """CSS that moves an element with two ends (2, 2, n), the first its origin, beginning at position ``at``."""
    last = ends.shape[2] - 1
    origin, span = ends[0], np.array([1.0, 1.0j]) @ (ends[1] - ends[0])
    stretch, along, before = np.abs(span / span[at]), span / np.abs(span), span[at] / abs(span[at])
    x, y = ((stretch * q.real + 1j * q.imag) * along for q in (before.conjugate(), 1j * before.conjugate()))
    rows = np.array([x.real, x.imag, y.real, y.imag, *(origin - origin[:, at : at + 1])])
    steps = "".join(
        f"{100.0 * n / last:.4g}%{{transform:matrix({','.join(map(fixed, rows[:, n], DECIMALS))})}}"
        for n in np.unique(np.rint(np.linspace(0, last, min(frames, last) + 1)).astype(int))
    )
    centre = f"{fixed(origin[0, at], 1)}px {fixed(origin[1, at], 1)}px"
    return f"#{key} .{name}{{transform-origin:{centre};animation-name:{name}}}@keyframes {name}{{{steps}}}"


def _shape(names: tuple[str, str, str], movers: set[str]) -> str:
    """An SVG element of matplotlib's, recoloured for the page, and marked as moving if it belongs to a mover."""
    name, before, after = names
    inked = re.sub("#[0-9a-f]{6}", lambda ink: f"var(--{COLOURS[ink[0]]})", f"{before}{after}")
    moves = f'class="{name}" ' if name in movers else ""
    return f"<path {moves}{' '.join(inked.split())}/>"
