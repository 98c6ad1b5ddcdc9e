"""Bodies in the scratch memory: their poses and derivatives at one angle of a block, read and written."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from analytic.compiled.kernels.jit import inlined
from analytic.compiled.kernels.layout import DDW, DDX, DDY, DW, DX, DY, C, S, X, Y
from analytic.kinematics.frames import Pose, Rate

Array = NDArray[np.float64]


@inlined
def pose(body: Array, i: int) -> Pose:
    """Pose of a body at the block's i-th angle."""
    return body[X + i], body[Y + i], body[C + i], body[S + i]


@inlined
def rate(body: Array, i: int) -> Rate:
    """Its first derivatives."""
    return body[DX + i], body[DY + i], body[DW + i]


@inlined
def second(body: Array, i: int) -> Rate:
    """Its second derivatives."""
    return body[DDX + i], body[DDY + i], body[DDW + i]


@inlined
def put_pose(body: Array, i: int, values: Pose) -> None:
    """Write a body's pose."""
    body[X + i], body[Y + i], body[C + i], body[S + i] = values


@inlined
def put_rate(body: Array, i: int, values: Rate) -> None:
    """Write its first derivatives."""
    body[DX + i], body[DY + i], body[DW + i] = values


@inlined
def put_second(body: Array, i: int, values: Rate) -> None:
    """Write its second derivatives."""
    body[DDX + i], body[DDY + i], body[DDW + i] = values
