"""The motion of a crank integrated in compiled code: the kernels of the linkage inside the loop over the windows.

The method is that of ``analytic.numerics.integration``, of a higher order. The equation is evaluated from the linkage
at every node, so that the motion shares neither tables nor code with the one that ``FreeMotion.error_bound`` holds
against it.
"""

from __future__ import annotations

import os
import sys
from dataclasses import replace
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING, Final

import numpy as np
from numpy.typing import NDArray

from analytic.compiled import evaluation
from analytic.compiled.flat_linkage import Program, program
from analytic.description.linkage import LinkTorque
from analytic.dynamics.equation_of_motion import EquationOfMotion
from analytic.errors import LinkproofError
from analytic.kinematics.mechanism import Mechanism
from analytic.numerics import integration
from analytic.numerics.collocation import Windows, gauss_scheme

if TYPE_CHECKING:
    from analytic.compiled.kernels.integration import Controls, Rules, Space

Array = NDArray[np.float64]

# A multiple of the eight numbers that a processor works on at once. Of 14 to 32, 24 was the quickest by a fifth.
NODES: Final = 24
KERNELS: Final = "analytic.compiled.kernels.integration"
# s, what the first motion of a process pays: importing the compiler and reading the kernels, or compiling them.
LOADING, COMPILING = 0.5, 40.0


def is_able(equation: EquationOfMotion) -> bool:
    """Whether the kernels know an equation, and numba is installed."""
    return equation.half_slope == "exact" and evaluation.available()


def check_able(equation: EquationOfMotion) -> None:
    """Raise LinkproofError where this path is asked for and cannot be taken."""
    if equation.half_slope != "exact":
        raise LinkproofError(
            f"path: expected 'numpy' or 'auto' with the half slope '{equation.half_slope}', got 'compiled', whose "
            "kernels know the exact one only; leave the path out"
        )
    evaluation.kernels()


def price() -> float:
    """Seconds until the kernels are ready in this process; 0 where they have been used."""
    ready = sys.modules.get(KERNELS)
    if ready is not None and ready.advance.signatures:
        return 0.0
    return LOADING if _are_kept() else COMPILING


def _are_kept() -> bool:
    """Whether the kernels lie on disk as machine code newer than their sources."""
    folder = Path(os.environ.get("NUMBA_CACHE_DIR") or Path(__file__).parent / "kernels" / "__pycache__")
    newest = max(path.stat().st_mtime for path in kernel_files())
    code = f"integration.advance*.py{sys.version_info.major}{sys.version_info.minor}.nbi"
    return any(path.stat().st_mtime > newest for path in folder.rglob(code))


def kernel_files() -> list[Path]:
    """Sources of the kernels."""
    return list((Path(__file__).parent / "kernels").glob("*.py"))


def integrate(
    equation: EquationOfMotion, start: tuple[float, float], duration: float, *, tolerance: float, rounding: float
) -> Windows | None:
    """``analytic.numerics.integration.integrate`` of an equation that the kernels know; None where it would raise."""
    from analytic.compiled.kernels.integration import LOST, advance  # noqa: PLC0415 - numba is an extra, and slow to import

    loaded, scheme = _program(equation), gauss_scheme(NODES)
    rules, controls = _rules()
    design, space = _memory(loaded)
    most = integration.MOST_WINDOWS
    # Memory that is never written to costs nothing.
    starts, base = np.empty(most + 1), np.empty(most)
    angles, speeds = np.empty((most, len(scheme.angle))), np.empty((most, len(scheme.speed)))
    tolerance = max(tolerance, integration.LEAST_TOLERANCE)
    count = advance(
        loaded.tables,
        design,
        rules,
        controls,
        (float(start[0]), float(start[1])),
        float(duration),
        tolerance,
        rounding,
        space,
        starts,
        base,
        angles,
        speeds,
    )
    if count == LOST:
        return None
    ends = starts[: count + 1].copy()
    return Windows(ends, base[:count].copy(), _columns(angles[:count]), _columns(speeds[:count]))


def _columns(rows: Array) -> Array:
    """One window a column, in memory of their own."""
    return np.ascontiguousarray(rows.T)


def _program(equation: EquationOfMotion) -> Program:
    """The linkage with the crank torque as one of its loads."""
    mechanism = equation.mechanism
    if np.any(equation.torque.values):
        linkage = mechanism.linkage
        load = LinkTorque(linkage.crank, equation.torque)
        mechanism = Mechanism(replace(linkage, torques=(*linkage.torques, load)))
    return program(mechanism)


def _memory(loaded: Program) -> tuple[Array, Space]:
    from analytic.compiled.kernels.integration import Space  # noqa: PLC0415
    from analytic.compiled.kernels.linkage import design_of, scratch  # noqa: PLC0415

    rows = {name: np.empty(NODES) for name in Space._fields}
    return design_of(loaded), Space(**{**rows, "work": scratch(loaded)})


@lru_cache
def _rules() -> tuple[Rules, Controls]:
    """Scheme and constants as the kernels take them."""
    from analytic.compiled.kernels.integration import Controls, Rules  # noqa: PLC0415

    scheme = gauss_scheme(NODES)
    rules = Rules(**{name: np.ascontiguousarray(getattr(scheme, name).T) for name in Rules._fields})
    controls = Controls(**{name: getattr(integration, name.upper()) for name in Controls._fields})
    return rules, controls
