"""Cosine and sine of many numbers at once: polynomials without branches, which the compiler vectorises.

Reduction and polynomials of cosine and sine are those of fdlibm (Sun Microsystems 1993: ``e_rem_pio2.c``, ``k_sin.c``,
``k_cos.c``); both are good to about one rounding.
"""

from __future__ import annotations

import math
from typing import Final

import numpy as np
from numpy.typing import NDArray

from analytic.compiled.kernels.jit import kernel

Array = NDArray[np.float64]

# π/2 in three parts; the first two have 33 bits, so that their products with less than 2^20 quarter turns are exact.
QUARTERS_PER_RADIAN: Final = 6.36619772367581382433e-01
QUARTER_1: Final = 1.57079632673412561417e00
QUARTER_2: Final = 6.07710050630396597660e-11
QUARTER_3: Final = 2.02226624879595063154e-21
LARGEST: Final = 1e6  # rad; beyond it the library's own functions are called


@kernel
def cosines_and_sines(n: int, angle: Array, cosine: Array, sine: Array) -> None:
    """Cosine and sine of ``n`` angles, rad, to 1.5e-16 whatever the angle."""
    largest = 0.0
    for i in range(n):
        largest = max(largest, abs(angle[i]))
    if not largest < LARGEST:
        for i in range(n):
            cosine[i], sine[i] = math.cos(angle[i]), math.sin(angle[i])
        return
    for i in range(n):
        x = angle[i]
        quarters = np.rint(x * QUARTERS_PER_RADIAN)
        r = ((x - quarters * QUARTER_1) - quarters * QUARTER_2) - quarters * QUARTER_3
        z = r * r
        p = -1.98412698298579493134e-04 + z * (
            2.75573137070700676789e-06 + z * (-2.50507602534068634195e-08 + z * 1.58969099521155010221e-10)
        )
        s = r + (z * r) * (-1.66666666666666324348e-01 + z * (8.33333333332248946124e-03 + z * p))
        p = 2.48015872894767294178e-05 + z * (
            -2.75573143513906633035e-07 + z * (2.08757232129817482790e-09 + z * -1.13596475577881948265e-11)
        )
        p = z * (z * (4.16666666666666019037e-02 + z * (-1.38888888888741095749e-03 + z * p)))
        half = 0.5 * z
        whole = 1.0 - half
        c = whole + (((1.0 - whole) - half) + p)
        quadrant = np.int32(quarters)
        odd = (quadrant & 1) != 0
        c, s = (s if odd else c), (c if odd else s)
        cosine[i] = -c if ((quadrant + 1) & 2) != 0 else c
        sine[i] = -s if (quadrant & 2) != 0 else s
