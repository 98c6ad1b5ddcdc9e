"""A scheme that moves: an inline drawing whose parts follow their bodies by rules of the style sheet alone.

All parts move together over the same ``SECONDS``, once along the axis of the positions; a script can stop them all, and
set the time they are at, through ``element.getAnimations({subtree: true})``.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import starmap
from typing import Any

import numpy as np
from markupsafe import Markup, escape
from matplotlib.artist import Artist
from matplotlib.colors import to_hex, to_rgba
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Circle, Patch
from matplotlib.path import Path
from numpy.typing import NDArray

from analytic.description.linkage import Linkage
from comparisons.datasheet.sheet import Positions
from reports.charts.kinematic_scheme import KinematicScheme
from reports.charts.scheme import draw_paths, draw_position
from reports.charts.style import GHOST, INK, MUTED, PALETTE, PAPER, PLATE

Array = NDArray[np.float64]

SECONDS = 6.0
# Pixels: of the drawing, of its rim, of a pin's radius, and the last two of a small drawing, without mass centres.
SIZE, RIM, PIN, SMALL_RIM, SMALL_PIN, SMALL = (440, 400), 24.0, 4.2, 16.0, 3.0, 250
POINT = 4.0 / 3.0  # pixels of a typographic point
DASHES = "4 3"
NOT_A_NAME = re.compile(r"[^\w-]")
LETTERS = {Path.MOVETO: "M", Path.LINETO: "L", Path.CURVE3: "Q", Path.CURVE4: "C", Path.CLOSEPOLY: "Z"}
COLOURS = {INK: "ink", MUTED: "muted", GHOST: "reference", PAPER: "paper", PLATE: "line"} | {
    colour: f"c{number}" for number, colour in enumerate(PALETTE)
}


def moving_scheme(
    linkage: Linkage, positions: Positions, key: str, *, size: tuple[int, int] = SIZE, frames: int = 120
) -> Markup:
    """The scheme in motion as inline SVG of class "moving" and at most ``size``, pixels.

    ``key`` makes its names its own on the page; ``frames`` is how many steps its motion is written in.
    """
    return _Moving(KinematicScheme(linkage, positions), NOT_A_NAME.sub("-", key), size, frames).markup()


@dataclass(frozen=True)
class _Moving:
    """A moving scheme in the making; places are in pixels of the drawing, y down."""

    scheme: KinematicScheme
    key: str
    size: tuple[int, int]
    frames: int

    @property
    def is_small(self) -> bool:
        """Whether there is no room for details."""
        return min(self.size) <= SMALL

    @property
    def rim(self) -> float:
        """Pixels around all places."""
        return SMALL_RIM if self.is_small else RIM

    @property
    def pixels(self) -> float:
        """Pixels of a unit of the scheme."""
        low, high = self.scheme.extent
        return float(np.min((np.array(self.size) - 2.0 * self.rim) / np.maximum(high - low, 1e-9)))

    @property
    def box(self) -> Array:
        """Width and height in use."""
        return (self.scheme.extent[1] - self.scheme.extent[0]) * self.pixels + 2.0 * self.rim

    def placed(self, places: Array) -> Array:
        """Places of the scheme, (n, 2), on the drawing."""
        low, high = self.scheme.extent
        shifted: Array = np.asarray(places) - (low[0], high[1])
        return shifted * (self.pixels, -self.pixels) + self.rim

    def markup(self) -> Markup:
        """All of it."""
        axes = Figure().add_axes((0.0, 0.0, 1.0, 1.0))
        draw_paths(axes, self.scheme)
        pin = (SMALL_PIN if self.is_small else PIN) / self.pixels
        draw_position(axes, self.scheme, pin, masses=not self.is_small)
        artists: list[Line2D | Patch] = sorted((*axes.lines, *axes.patches), key=Artist.get_zorder)
        movers = [*self.scheme.linkage.links, *self.scheme.stretches]
        rules = "".join(self._rules(name, f"{self.key}-{number}") for number, name in enumerate(movers))
        numbers = {name: f"{self.key}-{number}" for number, name in enumerate(movers)}
        shapes = "".join(self._shape(artist, numbers.get(str(artist.get_label()), "")) for artist in artists)
        width, height = np.ceil(self.box).astype(int)
        back = "" if self.scheme.positions.closed else " alternate"
        shared = (
            f"#{self.key} [class]{{animation:{SECONDS:g}s linear infinite{back};transform-box:view-box}}"
            f"@media (prefers-reduced-motion:reduce){{#{self.key} [class]{{animation-play-state:paused}}}}"
        )
        name = escape(f"{self.scheme.linkage.title} in motion")
        return Markup(
            f'<svg id="{self.key}" class="moving" role="img" aria-label="{name}" viewBox="0 0 {width} {height}" '
            f'width="{width}" height="{height}" stroke-linecap="round" stroke-linejoin="round" fill="none">'
            f"<style>{shared}{rules}</style>{shapes}</svg>"
        )

    def _rules(self, mover: str, name: str) -> str:
        """The motion of what moves with a body, or is stretched between two points, from the position drawn out."""
        last = len(self.scheme.positions.axis) - 1
        kept = np.unique(np.rint(np.linspace(0, last, min(self.frames, last) + 1)).astype(int))
        (places, angles, lengths), is_stretched = self._course(mover), mover in self.scheme.stretches
        drawn = self.scheme.few[self.scheme.clearest]
        origin = places[drawn]
        turns, angle = -np.degrees(angles - angles[drawn]), math.degrees(angles[drawn])
        steps = "".join(
            f"{100.0 * n / last:.4g}%{{transform:translate({shift[0]:.1f}px,{shift[1]:.1f}px) rotate({turns[n]:.2f}deg)"
            + (f" rotate({-angle:.2f}deg) scale({stretch:.3f},1) rotate({angle:.2f}deg)}}" if is_stretched else "}")
            for n, shift, stretch in zip(
                kept, (places - places[drawn])[kept], (lengths / lengths[drawn])[kept], strict=True
            )
        )
        origin = places[drawn]
        return (
            f"#{self.key} .{name}{{transform-origin:{origin[0]:.1f}px {origin[1]:.1f}px;animation-name:{name}}}"
            f"@keyframes {name}{{{steps}}}"
        )

    def _course(self, mover: str) -> tuple[Array, Array, Array]:
        """Origin on the drawing, (n, 2), angle and length, (n,), of a body's frame or of a line between two points."""
        if mover in self.scheme.stretches:
            start, end = self.scheme.stretches[mover]
            span = end - start
            return self.placed(start.T), np.unwrap(np.arctan2(span[1], span[0])), np.hypot(*span)
        pose = self.scheme.pose(mover)
        return self.placed(self.scheme.scale * pose[:2].T), pose[2], np.ones(pose.shape[1])

    def _shape(self, artist: Line2D | Patch, name: str) -> str:
        """An artist as one element."""
        moves = f' class="{name}"' if name else ""
        if isinstance(artist, Circle):
            (x, y), style = self.placed(np.array(artist.center)), _style(artist)
            return f'<circle cx="{x:.1f}" cy="{y:.1f}" r="{artist.radius * self.pixels:.1f}"{moves}{style}/>'
        return f'<path d="{"".join(starmap(self._stroke, _segments(artist)))}"{moves}{_style(artist)}/>'

    def _stroke(self, points: Any, code: Any) -> str:  # noqa: ANN401  matplotlib's
        places = self.placed(np.asarray(points).reshape(-1, 2)) if code != Path.CLOSEPOLY else np.zeros((0, 2))
        return LETTERS[Path.code_type(code)] + " ".join(f"{x:.1f} {y:.1f}" for x, y in places)


def _segments(artist: Line2D | Patch) -> Iterator[tuple[Any, Any]]:
    """The strokes of an artist, in the units of its axes."""
    path = artist.get_path()
    turned = path.transformed(artist.get_patch_transform()) if isinstance(artist, Patch) else path
    yield from turned.iter_segments(simplify=False)


def _style(artist: Line2D | Patch) -> str:
    """Stroke and fill of an artist, as colours of the page."""
    width = POINT * artist.get_linewidth()
    if isinstance(artist, Line2D):
        stroke = to_hex(artist.get_color())
        more = [f"stroke-dasharray:{DASHES}", "stroke-linecap:butt"] if artist.is_dashed() else []
        more += [f"opacity:{artist.get_alpha():g}"] if artist.get_alpha() else []
    else:
        stroke, fill = to_hex(artist.get_edgecolor()), to_rgba(artist.get_facecolor())
        more = [f"fill:var(--{COLOURS[to_hex(fill)]})"] + ([f"fill-opacity:{fill[3]:g}"] if fill[3] < 1.0 else [])
    line = [f"stroke:var(--{COLOURS[stroke]})", f"stroke-width:{width:.1f}"] if width else []
    return f' style="{";".join([*line, *more])}"'
