"""Linkages with a motion that can be written down, and one whose crank only swings."""

import math

import numpy as np
import pytest

from tests.analytic.linkages import file_text

needs_extended_precision = pytest.mark.skipif(
    np.finfo(np.longdouble).eps > 1e-18, reason="this machine's long double is a double"
)

PENDULUM, ROTOR = file_text("pendulum"), file_text("rotor")
PENDULUM_RATE = math.sqrt(2 * 9.81 * 0.5 / (0.1 + 2 * 0.25))  # rad/s, of small oscillations
# Its crank swings between limits on both sides; turned upside down it has a place to rest.
DOUBLE_ROCKER = file_text("double-rocker")


def four_bar(ground, crank, coupler, rocker, start):
    """The text of a four-bar in m that is sketched at a crank angle, rad, with C left of A→B."""
    x, y = crank * math.cos(start), crank * math.sin(start)
    gap = math.hypot(ground - x, y)
    along = (gap**2 + coupler**2 - rocker**2) / (2 * gap)
    across = math.sqrt(max(coupler**2 - along**2, 0.0))
    c = (x + (along * (ground - x) + across * y) / gap, y + (-along * y + across * (ground - x)) / gap)
    text = DOUBLE_ROCKER.replace('"mm"', '"m"').replace('angle = "deg"', 'angle = "rad"')
    numbers = {"B = [100": ground, "A = [80": crank, "C = [60": coupler, "C = [90": rocker}
    for old, new in numbers.items():
        text = text.replace(f"{old}, 0]", f"{old.split('[')[0]}[{new!r}, 0]")
    text = text.replace("angle = 70", f"angle = {start!r}").replace("[86, 90]", repr(list(c)))
    return text
