"""Which path a computation takes, NumPy or the kernels, and what it costs to get the kernels ready.

The kernels are compiled once for all linkages, by numba, an optional dependency, and kept on disk: the first use on a
machine takes half a minute, later ones a fraction of a second. Where no folder can be written to they are compiled anew
in every process, and only on request.
"""

from __future__ import annotations

import hashlib
import importlib.util
import math
import os
import sys
from collections.abc import Iterator
from pathlib import Path
from types import ModuleType
from typing import Final

from analytic.errors import LinkproofError, UnknownNameError

PATHS: Final = ("auto", "numpy", "compiled")
PACKAGE: Final = "analytic.compiled.kernels"
# The function of a module of kernels that Python calls.
ENTRIES: Final = {"evaluation": "quantities", "figures": "reduced", "integration": "advance"}
# s: a call of kernels in memory, importing numba and reading them from disk, compiling them.
CALLING, LOADING, COMPILING = 6e-4, 1.0, 40.0


def is_compiled(path: str, kernels: str, seconds: float) -> bool:
    """Whether to take the compiled path where NumPy needs about ``seconds``; raises UnknownNameError for no path."""
    if path not in PATHS:
        raise UnknownNameError("path", path, PATHS)
    if path != "auto" or seconds < CALLING:
        return path == "compiled"
    return seconds >= cost_of_start(kernels)


def cost_of_start(kernels: str) -> float:
    """Seconds until a module of kernels is ready, infinite where it cannot be or would not last."""
    if is_loaded(kernels):
        return CALLING
    if not is_installed():
        return math.inf
    if is_kept(kernels):
        return LOADING
    return math.inf if folder() is None else COMPILING


def cores() -> int:
    """Processor cores this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def is_installed() -> bool:
    """Whether numba is installed; it is not imported for the answer."""
    return importlib.util.find_spec("numba") is not None


def is_loaded(kernels: str) -> bool:
    """Whether a module of kernels is in memory, compiled."""
    module = sys.modules.get(f"{PACKAGE}.{kernels}")
    return module is not None and bool(getattr(module, ENTRIES[kernels]).signatures)


def is_kept(kernels: str) -> bool:
    """Whether a module of kernels lies on disk as machine code newer than all sources it may come from."""
    where = folder()
    if where is None:
        return False
    newest = max(path.stat().st_mtime for path in sources())
    code = f"{kernels}.{ENTRIES[kernels]}*.py{sys.version_info.major}{sys.version_info.minor}.nbi"
    return any(path.stat().st_mtime > newest for path in where.glob(code))


def sources() -> list[Path]:
    """Files of the formulas and kernels."""
    analytic = Path(__file__).parents[1]
    return sorted(
        path for room in ("numerics", "kinematics", "dynamics", "compiled") for path in (analytic / room).rglob("*.py")
    )


def folder() -> Path | None:
    """The folder in which numba keeps the kernels' machine code: the first of its choices that can be written to."""
    return next(filter(_is_writable, _folders()), None)


def _folders() -> Iterator[Path]:
    """Numba's choices (``numba.core.caching``): the user's setting, beside the sources, the user's caches."""
    here = Path(__file__).parent / "kernels"
    name = f"kernels_{hashlib.sha1(str(here).encode()).hexdigest()}"
    if "NUMBA_CACHE_DIR" in os.environ:
        yield Path(os.environ["NUMBA_CACHE_DIR"]) / name
    yield here / "__pycache__"
    yield _user_caches() / name


def _user_caches() -> Path:
    if sys.platform == "win32":
        return Path(os.environ.get("LOCALAPPDATA", Path.home())) / "numba" / "Cache"
    if sys.platform == "darwin":
        return Path("~/Library/Caches/numba").expanduser()
    return Path(os.environ.get("XDG_CACHE_HOME", "~/.cache")).expanduser() / "numba"


def _is_writable(path: Path) -> bool:
    """Whether a folder can be written to, or made."""
    there = next(parent for parent in (path, *path.parents) if parent.exists())
    return os.access(there, os.W_OK | os.X_OK)


def kernels(name: str) -> ModuleType:
    """A module of kernels; raises LinkproofError if numba is not installed."""
    try:
        return importlib.import_module(f"{PACKAGE}.{name}")
    except ModuleNotFoundError as error:
        if error.name is None or error.name.partition(".")[0] != "numba":
            raise
        raise LinkproofError(
            "compiled path: expected numba, which compiles it, got an installation without; pip install "
            "'linkproof[compiled]', or choose the path 'numpy'"
        ) from error
