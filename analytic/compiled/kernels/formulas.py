"""The closed form's own formulas, compiled: numba finds them here when a kernel calls them.

NumPy calls the same functions with arrays. What spares NumPy the work with zeros is False in compiled code, so that
loops have no branches; what asks for plain numbers is True.
"""

from __future__ import annotations

from collections.abc import Callable
from types import FunctionType, ModuleType
from typing import Any

from numba.extending import overload, register_jitable

from analytic.compiled.kernels.jit import INLINED
from analytic.dynamics import force_formulas, link_sums
from analytic.kinematics import frames, transmission
from analytic.kinematics.dyads import arms, crossing, prp, rpp, rpr, rrp, rrr
from analytic.numerics import step_control

NEVER = (frames.is_zero, frames.is_one, frames.is_origin, frames.is_still)


def _never(function: Callable[[Any], bool]) -> None:
    """Make a question False in compiled code."""
    overload(function, jit_options=INLINED)(lambda _: lambda _: False)


def _compiled(module: ModuleType) -> None:
    """Let kernels call a module's functions."""
    for function in vars(module).values():
        is_own = isinstance(function, FunctionType) and function.__module__ == module.__name__
        if is_own and function not in (*NEVER, frames.is_plain):
            register_jitable(**INLINED)(function)


for question in NEVER:
    _never(question)
overload(frames.is_plain, jit_options=INLINED)(lambda _: lambda _: True)
for source in (frames, arms, crossing, rrr, rrp, rpr, rpp, prp, transmission, link_sums, force_formulas, step_control):
    _compiled(source)
