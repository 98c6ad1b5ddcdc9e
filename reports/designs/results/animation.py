"""The scheme in motion as a GIF, for a slide or a message."""

from __future__ import annotations

from io import BytesIO
from typing import Final

import numpy as np
from matplotlib.axes import Axes
from PIL import Image

from comparisons.datasheet.sheet import Sheet
from reports.charts import draw
from reports.charts.kinematic_scheme import KinematicScheme
from reports.charts.moving import SECONDS
from reports.charts.scheme import draw_paths, draw_position, scaled_figure

FRAMES: Final = 60
DOTS, COLOURS = 100, 64  # to the inch, and of a frame


def gif(sheet: Sheet) -> bytes:
    """The bytes of a GIF that repeats for ever: a turn the way the crank turns, or the motion forth and back."""
    positions, angle = sheet.positions, sheet.values["phi"]
    assert positions is not None
    axis = positions.axis
    if positions.closed:
        places = np.linspace(axis[0], axis[-1], FRAMES, endpoint=False)[:: -1 if angle[-1] < angle[0] else 1]
    else:
        places = np.linspace(axis[0], axis[-1], FRAMES // 2 + 1)
        places = np.concatenate([places, places[-2:0:-1]])
    schemes = [KinematicScheme(sheet.linkage, positions, float(place)) for place in places]
    pictures = (draw.png(scaled_figure(scheme, scheme.extent, _draw_frame), DOTS) for scheme in schemes)
    frames = [Image.open(BytesIO(picture)).convert("RGB") for picture in pictures]
    first, *rest = (frame.quantize(COLOURS, Image.Quantize.MAXCOVERAGE) for frame in frames)
    data = BytesIO()
    first.save(data, "GIF", save_all=True, append_images=rest, duration=round(1e3 * SECONDS / FRAMES), loop=0)
    return data.getvalue()


def _draw_frame(axes: Axes, scheme: KinematicScheme, size: float) -> None:
    draw_paths(axes, scheme)
    draw_position(axes, scheme, size)
