"""The scheme in one position as a DXF drawing, in the linkage's unit of length: a layer for each link."""

from __future__ import annotations

import io
import re
from itertools import pairwise
from typing import Final

import ezdxf
import numpy as np
from ezdxf import units

from analytic.description.linkage import GROUND, Linkage
from analytic.description.written import file_unit
from analytic.errors import printable
from analytic.kinematics.mechanism import Mechanism
from comparisons.designer.building import positions_at
from comparisons.designer.sheet import Positions
from reports.charts import symbols
from reports.charts.scheme import KinematicScheme

UNITS: Final = {
    "m": units.M,
    "cm": units.CM,
    "mm": units.MM,
    "um": units.InsertUnits.Microns,
    "in": units.IN,
    "ft": units.FT,
}
FORBIDDEN: Final = re.compile(r"""[<>/\\":;?*|=,`']""")  # in the name of a layer
CODES: Final = re.compile(r"%(?=%)|\^")  # begin what a text shows as another character
JOINTS, NAMES = "joints", "names"
PIN: Final = 0.012  # of the linkage's size: radius of a joint


def dxf(linkage: Linkage, positions: Positions, angle: float | None = None) -> str:
    """The text of a DXF file: the scheme at this crank angle, rad or m, or at the sketch's for None.

    Guides are as long as ``positions`` need them, joints circles and points, links lines. Raises AssemblyError for an
    angle that the crank cannot reach.
    """
    place = linkage.sketch_angle if angle is None else angle
    scheme = KinematicScheme(linkage, positions_at(Mechanism(linkage), np.array([place]), closed=False), place)
    whole = KinematicScheme(linkage, positions)
    document = ezdxf.new("R2010", units=UNITS[file_unit("m", linkage).name])
    space, radius = document.modelspace(), PIN * float(np.max(np.ptp(np.array(whole.extent), axis=0)))
    layers = _layers([GROUND, *linkage.links, *scheme.stretches])
    for number, layer in enumerate((JOINTS, NAMES, *layers.values())):
        document.layers.add(layer, color=1 + number % 6)
    for run in whole.runs:
        host = run[0].host
        space.add_line(*scheme.shown(host, whole.reach(*run)), {"layer": layers[host]})
    bars = {name: scheme.shown(name, link.points.values()) for name, link in linkage.links.items()}
    for name, spots in (bars | {name: scheme.at(ends) for name, ends in scheme.stretches.items()}).items():
        corners = symbols.outline(spots)
        for start, end in pairwise([*corners, *corners[: len(corners) > 2]]):
            space.add_line(start, end, {"layer": layers[name]})
    for name, spot in scheme.spots.items():
        space.add_point(spot, {"layer": JOINTS})
        if name in scheme.joined:
            space.add_circle(spot, radius, {"layer": JOINTS})
        text = CODES.sub("_", printable(name))
        space.add_text(text, height=2.0 * radius, dxfattribs={"layer": NAMES, "insert": spot + 1.5 * radius})
    text_file = io.StringIO()
    document.write(text_file)
    return text_file.getvalue()


def _layers(parts: list[str]) -> dict[str, str]:
    """The DXF layer of each part, by the part: a name that DXF allows, unique without regard to capitals."""
    layers: dict[str, str] = {}
    taken = {"0", "defpoints", JOINTS, NAMES}
    for part in parts:
        layer = FORBIDDEN.sub("_", printable(part))[:200].strip() or "_"
        while layer.casefold() in taken:
            layer += "_"
        taken.add(layer.casefold())
        layers[part] = layer
    return layers
