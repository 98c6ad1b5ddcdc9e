"""A file's curves against the closed form, the difference below, the worst place, and what a cause leaves."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np

from reports.document.chart import Chart, Curve, Ink, Mark, Panel

MOST: Final = 3  # curves of one picture
HEIGHT: Final = 4.4  # inches: of the two panels of a curve
LOOKS: Final[Mapping[str, tuple[Ink, str, float]]] = {
    "closed form": ("reference", "-", 3.4),
    "file": (0, "-", 1.2),
    "without the cause": (2, "--", 1.2),
}


@dataclass(frozen=True)
class JudgedCurve:
    """A signal of a file at some of its times, s: its values in a ``unit``, those of the closed form, the worst time.

    ``without`` are the file's values without the ``cause`` that is named, None where none is, or where either of two
    values is right. All are plain lists, so that a report's folder can save them.
    """

    name: str
    unit: str
    time: list[float]
    file: list[float]
    truth: list[float]
    worst: float
    error: str
    cause: str = ""
    without: list[float | None] | None = None

    @property
    def caption(self) -> str:
        """The caption of the picture, in one sentence."""
        removed = f", and without its likely cause: {self.cause}" if self.cause else ""
        return f"{self.name} of the file and of the closed form, and their difference, {self.error}{removed}."


def judged_chart(curves: Sequence[JudgedCurve], head: tuple[str, ...] = ()) -> Chart:
    """The curves side by side, each over its difference from the closed form."""
    drawn = curves[:MOST]
    panels = [_panel(curve, of_difference=below) for below in (False, True) for curve in drawn]
    names = [name for name in LOOKS if name != "without the cause" or any(curve.cause for curve in drawn)]
    nothing = np.zeros(0)
    key = tuple(Curve(nothing, nothing, name, ink, line, width) for name in names for ink, line, width in [LOOKS[name]])
    return Chart(tuple(panels), HEIGHT, columns=len(drawn), wide=True, head=head, key=key)


def _panel(curve: JudgedCurve, *, of_difference: bool) -> Panel:
    """The curves, or what they differ from the closed form by, with the worst place marked."""
    time, truth = np.array(curve.time), np.array(curve.truth)
    shown = {"closed form": truth, "file": np.array(curve.file)}
    if curve.without is not None:
        shown["without the cause"] = np.array(curve.without, dtype=float)
    if of_difference:
        shown = {name: values - truth for name, values in shown.items() if name != "closed form"}
    curves = tuple(Curve(time, y, "", ink, line, width) for n, y in shown.items() for ink, line, width in [LOOKS[n]])
    mark = Mark(curve.worst, name="" if of_difference else f"worst at {curve.worst:.5g} s", ink="limit")
    label, title = (f"difference, {curve.unit}", "") if of_difference else (curve.unit, curve.name)
    return Panel(curves, "time, s", label, (mark,), names="", title=title)
