"""Cosine, sine and arctangent of many numbers at once: polynomials without branches, which the compiler vectorises.

Reduction and polynomials of cosine and sine are those of fdlibm (Sun Microsystems 1993: ``e_rem_pio2.c``, ``k_sin.c``,
``k_cos.c``), the arctangent's those of Cephes (Moshier 1989: ``atan.c``); all are good to about one rounding.
"""

from __future__ import annotations

import math
from typing import Final

import numpy as np
from numpy.typing import NDArray

from analytic.compiled.kernels.jit import kernel
from analytic.compiled.kernels.layout import BLOCK

Array = NDArray[np.float64]

# π/2 in three parts; the first two have 33 bits, so that their products with less than 2^20 quarter turns are exact.
QUARTERS_PER_RADIAN: Final = 6.36619772367581382433e-01
QUARTER_1: Final = 1.57079632673412561417e00
QUARTER_2: Final = 6.07710050630396597660e-11
QUARTER_3: Final = 2.02226624879595063154e-21
LARGEST: Final = 1e6  # rad; beyond it the library's own functions are called

HALF_TURN_LOW: Final = 6.123233995736765886130e-17  # π/2 less its nearest float
TAN_67: Final = 2.41421356237309504880  # tan 67.5°
TAN_33: Final = 0.66


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


@kernel
def arctangents(n: int, sine: Array, cosine: Array, angle: Array) -> None:
    """Angle in [-π, π] of ``n`` directions given by multiples of their sines and cosines."""
    for i in range(min(n, BLOCK)):
        s, c = abs(sine[i]), abs(cosine[i])
        # tan(x) = s/c from 0 to infinity; a third of it at a time, turned back by 0, 45 or 90 degrees.
        steep, flat = s > TAN_67 * c, s <= TAN_33 * c
        top = -c if steep else (s if flat else s - c)
        bottom = s if steep else (c if flat else s + c)
        x = top / bottom
        z = x * x
        p = -8.750608600031904122785e-01 * z - 1.615753718733365076637e01
        p = ((p * z - 7.500855792314704667340e01) * z - 1.228866684490136173410e02) * z - 6.485021904942025371773e01
        q = z + 2.485846490142306297962e01
        q = (
            ((q * z + 1.650270098316988542046e02) * z + 4.328810604912902668951e02) * z + 4.853903996359136964868e02
        ) * z
        q += 1.945506571482613964425e02
        x += x * (z * p / q)
        x += HALF_TURN_LOW if steep else (0.0 if flat else 0.5 * HALF_TURN_LOW)
        x += 0.5 * math.pi if steep else (0.0 if flat else 0.25 * math.pi)
        x = math.pi - (x - 2.0 * HALF_TURN_LOW) if cosine[i] < 0.0 else x
        angle[i] = math.copysign(x, sine[i])
