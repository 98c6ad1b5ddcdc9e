"""A mechanism that moves on its page: its drawing, and what its signals are where it stands."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Final

import numpy as np
from markupsafe import Markup
from numpy.typing import NDArray

from analytic.description.law import FULL_TURN
from comparisons.datasheet.sheet import Positions, Sheet
from reports.document.parts import Widget

Array = NDArray[np.float64]

SAMPLES: Final = 241
READ_OUT: Final = ("S", "v", "a", "Mkr", "Peq", "Jeq")
DIGITS: Final = 4


def player(sheet: Sheet, positions: Positions, drawing: Markup) -> Widget:
    """The moving drawing, with controls and a read-out."""
    label = f"{sheet.linkage.title} in motion"
    return Widget("player", "motion", label, player_data(sheet, positions), markup=drawing)


def player_data(sheet: Sheet, positions: Positions) -> Mapping[str, Any]:
    """The axis and the signals at ``SAMPLES`` instants, evenly spaced in time.

    ``shares`` are the places of the instants on the axis of a figure, ``poses`` in the drawing's motion, from 0 to 1.
    """
    axis = sheet.values[sheet.axis]
    along = np.linspace(axis[0], axis[-1], SAMPLES)
    if sheet.axis == "phi" and np.nanmean(sheet.values["omega"]) < 0.0:
        along = along[::-1]
    turned = along % FULL_TURN if sheet.is_turn else along
    shares = turned / FULL_TURN if sheet.is_turn else (along - axis[0]) / (axis[-1] - axis[0])
    values = [f"{value:z.1f}" if sheet.is_turn else f"{value:z.4g}" for value in turned / sheet.axis_unit.size]
    return {
        "axis": {
            "kind": sheet.axis,
            "name": sheet.symbol,
            "unit": sheet.axis_unit.on_page,
            "values": values,
            "shares": np.round(shares, 4).tolist(),
        },
        "poses": np.round(_poses(sheet, positions, along), 5).tolist(),
        "rows": [_row(sheet, name, along) for name in READ_OUT if name in sheet.values],
    }


def _poses(sheet: Sheet, positions: Positions, along: Array) -> Array:
    """Where in the motion of the sheet's positions the mechanism is at places of its axis."""
    reached = np.interp(along, sheet.values[sheet.axis], sheet.values[positions.over])
    start, end = positions.axis[0], positions.axis[-1]
    share = (reached - start) / (end - start)
    return np.asarray(share % 1.0 if positions.closed else np.clip(share, 0.0, 1.0))


def _row(sheet: Sheet, name: str, along: Array) -> dict[str, Any]:
    """A signal at places of the axis, in the file's unit, to ``DIGITS`` digits of its largest value."""
    unit = sheet.unit(name)
    values = np.interp(along, sheet.values[sheet.axis], sheet.values[name]) / unit.size
    return {
        "name": name,
        "unit": unit.on_page,
        "values": [_short(value, sheet.scale(name) / unit.size) for value in values],
    }


def _short(value: float, scale: float) -> float | None:
    """A value without digits that are small beside the largest."""
    if not np.isfinite(value):
        return None
    least = 10.0 ** (np.floor(np.log10(scale)) + 1 - DIGITS) if scale else 1.0
    return float(f"{round(value / least) * least:.{DIGITS}g}") + 0.0
