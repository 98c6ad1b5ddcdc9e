"""Where the kernels keep what: the columns of a linkage's tables and the rows of the scratch memory.

Crank angles are worked on in blocks. The scratch memory is one vector of rows, each holding one quantity at every angle
of a block; the rows of a body lie together, in the order below, so that a kernel gets a body as one piece of it.
"""

from __future__ import annotations

from typing import Final

# Crank angles per block: a six-bar's bodies then fill a good part of a first-level cache. Of 64, 128, 256 and 512
# angles, 128 was quickest by a little.
BLOCK: Final = 128
# Floats from row to row: not a power of two, else all rows fall into the same few places of the cache.
ROW: Final = BLOCK + 8

# Rows of a body: origin, cosine and sine of its angle; origin's and angle's derivatives over φ, first then second.
X, Y, C, S, DX, DY, DW, DDX, DDY, DDW = (ROW * row for row in range(10))
# Five more that a dyad's later steps take over from its earlier ones: its closure and travel.
BODY: Final = ROW * 15
# A dyad's rows are its two bodies'.
SECOND: Final = BODY
KEPT: Final = (*(ROW * row for row in range(10, 15)), *(SECOND + ROW * row for row in range(10, 15)))

# The scratch memory: a block's own rows, its sums, its laws, then its bodies.
# Own rows: crank angle, its cosine and sine, crank speed and acceleration, and 1 where there is no motion.
ANGLE, COSINE, SINE, SPEED, ACCELERATION, FAULT = (ROW * row for row in range(6))
SUMS: Final = ROW * 6
# Sums over the linkage: Jeq, ½Jeq', Q, b, and the output with its first and second derivative.
JEQ, HALF_DERIVATIVE, FORCE, DAMPING, OUTPUT, OUTPUT_RATE, OUTPUT_SECOND = (ROW * row for row in range(7))
LAWS: Final = SUMS + ROW * 7
LAW: Final = ROW * 2  # a law's components

# Columns of ``Tables.dyads``.
KIND, SIGN, NEAR_ONE, NEAR_TWO, FIRST_JOINT, INNER_JOINT, SECOND_JOINT = 0, 1, 2, 3, 4, 8, 12
# Entries of a joint: those of an R joint, then those of a P joint.
NEAR_POINT, FAR_POINT = 0, 1
THROUGH, ALONG, ANCHOR, FROM_SLIDER = 0, 1, 2, 3
# Entries of ``Tables.crank``.
CRANK_NEAR, CRANK_FAR, CRANK_MASS, CRANK_CENTRE, CRANK_INERTIA = range(5)

# A design is a linkage's numbers followed by the constants derived from them: three of the crank, then a dyad's each.
CRANK_CONSTANTS: Final = 3
DYAD_CONSTANTS: Final = 16
