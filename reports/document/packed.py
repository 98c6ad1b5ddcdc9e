"""Columns of numbers for a drawing of a page, in few bytes."""

from __future__ import annotations

import base64
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
FULL_SHARE: Final = 65534  # of the way between the ends of a packed column


def packed(*columns: Array) -> dict[str, Any]:
    """Columns (n,) for a drawing, to which 16 bits are enough: ends of each, and shares of the way between.

    They are under "ends", (low, high) each, and "shares", one text for all columns, JSON-ready. The shares are whole
    numbers up to ``FULL_SHARE``, the lower byte first, in base64; one more stands for a value that is not finite, and
    is not drawn.
    """
    ends, shares = [], []
    for column in columns:
        finite = np.isfinite(column)
        known = column[finite] if finite.any() else np.zeros(1)
        low, high = float(np.min(known)), float(np.max(known))
        share = np.where(finite, column - low, 0.0) / ((high - low) or 1.0)
        shares.append(np.where(finite, np.rint(FULL_SHARE * share), FULL_SHARE + 1))
        ends.append((low, high))
    return {"ends": ends, "shares": base64.b64encode(np.concatenate(shares).astype("<u2").tobytes()).decode("ascii")}
