"""How the kernels are compiled: once for all linkages, without the interpreter's lock, kept on disk between runs.

Only the entry points keep their machine code on disk, with everything they call inside. Numba looks at an entry's own
file only to see whether that code is still good; ``SOURCES`` makes up for it: an entry takes it as the default of its
last parameter, which is part of the key, so that a change in any file of formulas or kernels counts.

Numba calls machine code by its function's qualified name and a number that counts from 1 in every process. Where one
process loads what two have kept, code of one name is taken for one: kernels that one function makes, one for each kind
of dyad, would be exchanged. So each is named by what it is made of.
"""

from __future__ import annotations

import zlib
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any, Final, TypeVar

import numba

from analytic.compiled.choice import sources

Function = TypeVar("Function", bound=Callable[..., Any])

# "numpy": a division by zero gives inf or nan and no exception, so that loops have no way out and are vectorised.
# No "_nrt": nothing is allocated, so no references to arrays are counted; that made a block half as long again, and the
# counts of the shared tables would be fought over by threads.
_OPTIONS: Final = {"nogil": True, "error_model": "numpy", "_nrt": False}
INLINED: Final = {**_OPTIONS, "forceinline": True}


def checksum(paths: Iterable[Path]) -> int:
    """A number that changes with the text of any of the files."""
    total = 0
    for path in paths:
        total = zlib.crc32(path.read_bytes(), total)
    return total


SOURCES: Final = checksum(sources())


def _named(function: Function) -> Function:
    """The function, by a name that no other has which is made by the same one."""
    parts = [cell.cell_contents for cell in function.__closure__ or ()]
    names = [str(getattr(part, "__qualname__", getattr(part, "__name__", part))) for part in parts]
    function.__qualname__ = "_of_".join([function.__qualname__, *names])
    return function


def kernel(function: Function) -> Function:
    """Compile a function that other kernels call."""
    compiled: Function = numba.njit(**_OPTIONS)(_named(function))
    return compiled


def inlined(function: Function) -> Function:
    """Compile a function into its callers: a small one, or one that takes the tables, a hundred words to pass on."""
    compiled: Function = numba.njit(**INLINED)(_named(function))
    return compiled


def counting(function: Function) -> Function:
    """Compile a function that adds up zeros and ones, whose order is free since their sum is exact."""
    compiled: Function = numba.njit(fastmath={"reassoc"}, **_OPTIONS)(function)
    return compiled


def reducing(function: Function) -> Function:
    """Compile a function that adds numbers up, in any order, or finds the largest of numbers that are no nan."""
    compiled: Function = numba.njit(fastmath={"reassoc", "nnan", "nsz"}, **_OPTIONS)(function)
    return compiled


def entry(function: Function) -> Function:
    """Compile a function called from Python, or by kernels elsewhere, and keep it on disk where that can be."""
    compiled: Function
    try:
        compiled = numba.njit(cache=True, **_OPTIONS)(function)
    except RuntimeError:  # numba finds no folder that can be written to
        compiled = numba.njit(**_OPTIONS)(function)
    return compiled
