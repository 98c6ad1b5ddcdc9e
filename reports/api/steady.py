"""``sweep``, ``optimise`` and ``tolerance``: many designs of a linkage at a steady speed."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from analytic.description.changes import SPEED, without
from analytic.description.law import FULL_TURN
from analytic.description.linkage import Linkage
from analytic.errors import LinkproofError
from analytic.kinematics.mechanism import Mechanism
from comparisons.designer.building import conditions
from comparisons.designer.figures import NEGLIGIBLE
from comparisons.designer.optimisation import OptimisationRequest, Optimum
from comparisons.designer.parameters import (
    SAMPLES,
    Parameter,
    SteadyCase,
    case_at_speed,
    mass_words,
    named_figures,
    parameter,
)
from comparisons.designer.sweep import (
    MOST,
    DesignSpace,
    SweepRequest,
    figures_of_file,
    labelled_dataset,
    parameter_range,
    read_table,
    sweep_block,
    usual_figures,
)
from reports.api.motions import requested_case
from reports.api.options import Ranges, SteadyMotion, option_words, range_word

if TYPE_CHECKING:
    import xarray


def steady_case(
    linkage: Linkage, options: SteadyMotion, *, scale_mass: bool = False, refine: bool = True
) -> SteadyCase:
    """The requested motion, in the case of a linkage: a turn, the range of a driver that makes none, or --from to --to.

    Raises LinkproofError for bad input.
    """
    linkage = replace(linkage, scales_mass=scale_mass)
    mechanism = Mechanism(linkage if options.gravity else without(linkage, "gravity"))
    motion = options.motion
    case = requested_case(motion, mechanism)
    case.check_motion()
    first, last = (float(case.motion.angle(np.array([time]))[0]) for time in (0.0, case.motion.duration))
    speed = float(case.motion.speed(np.array([0.0]))[0])
    turns = not (linkage.is_linear or motion.swings) and abs(last - first) >= FULL_TURN * (1.0 - NEGLIGIBLE)
    start, end = (None, None) if turns else (first, last)
    steady = case_at_speed(mechanism, speed, start=start, end=end)
    how = f"refined between {SAMPLES}" if refine else f"sampled at {SAMPLES}"
    places = "places" if linkage.is_linear else "crank angles"
    newton = ", a numerical reference: Newton's method solves a group" if mechanism.is_numerical else ""
    return replace(steady, conditions=f"{conditions(case)}, {how} {places}{newton}")


def sweep_request(case: SteadyCase, space: DesignSpace, quantity: Sequence[str], *, refine: bool) -> SweepRequest:
    """The figures of a space of designs; raises LinkproofError for unknown names and more values than memory holds."""
    linkage = case.linkage
    figures = named_figures(case.mechanism, quantity) if quantity else usual_figures(case.mechanism)
    if not figures:
        raise LinkproofError(f"expected a figure of '{linkage.name}', got none: name one with --quantity")
    if space.count * len(figures) > MOST:
        raise LinkproofError(
            f"expected {MOST:.0e} values at most, designs times figures, got {space.count} × {len(figures)}: vary "
            "less, or call linkproof.sweep from Python with Dask arrays, whose chunks are computed one by one"
        )
    conditions = case.conditions + mass_words(linkage, (parameter.name for parameter in space.parameters))
    return SweepRequest(replace(case, conditions=conditions), space, figures, refine)


Array = NDArray[np.float64]


def given_designs(linkage: Linkage, vary: Any, table: Any) -> tuple[DesignSpace, dict[str, Any] | None]:  # noqa: ANN401
    """The grid of ``vary``, or the list of ``table``; of Dask arrays a space of one design, and the arrays by name.

    Raises LinkproofError for bad input.
    """
    if bool(vary) == (table is not None):
        got = "both" if vary else "neither"
        raise LinkproofError(
            f"expected designs by --vary NAME=FIRST:LAST:COUNT or by --table FILE, got {got}: give one of the two"
        )
    if isinstance(table, str | Path):
        return read_table(Path(table), linkage), None
    if not isinstance(vary, Mapping) and table is None:
        numbers, columns = zip(*(parameter_range(linkage, text) for text in vary), strict=True)
        return DesignSpace(numbers, columns), None
    given = vary if table is None else table
    values = {str(name): _check_values(str(name), given[name]) for name in given}
    parts = tuple(parameter(linkage, name) for name in values)
    if any(map(_is_dask_array, values.values())):
        return _design_space(parts, [np.zeros(1)] * len(parts), is_list=table is not None), values
    return _design_space(parts, [*values.values()], is_list=table is not None), None


def _is_dask_array(values: object) -> bool:
    return hasattr(values, "__dask_graph__")


def _check_values(name: str, given: Any) -> Any:  # noqa: ANN401 - arrays of two kinds
    """Values of a parameter; raises LinkproofError if they are not a list of finite numbers."""
    data = getattr(given, "data", given) if hasattr(given, "dims") else given  # of a DataArray
    values = data if _is_dask_array(data) else np.asarray(data, dtype=float)
    if len(values.shape) != 1 or values.shape == (0,) or not (_is_dask_array(values) or np.all(np.isfinite(values))):
        raise LinkproofError(f"{name}: expected a flat list of finite numbers, got {values!r:.60}; pass such a list")
    return values


def _design_space(parts: tuple[Parameter, ...], values: Sequence[Array], *, is_list: bool) -> DesignSpace:
    if is_list and len({len(value) for value in values}) > 1:
        raise LinkproofError(
            f"table: expected columns of one length, got {[len(value) for value in values]}; correct it"
        )
    return DesignSpace(parts, tuple(values), is_list)


def lazy_dataset(request: SweepRequest, values: Mapping[str, Any]) -> xarray.Dataset:
    """Figures of all designs as Dask arrays, a chunk for every combination of the values' chunks."""
    import dask.array as da  # noqa: PLC0415 - only Dask arrays need it

    figures_of_file(request)  # raises LinkproofError for figures that no design has
    shape = request.space.shape
    over = [0] * len(values) if request.space.is_list else range(len(shape))
    arrays = [value if _is_dask_array(value) else da.from_array(value, chunks=-1) for value in values.values()]
    pairs = [part for array, axis in zip(arrays, over, strict=True) for part in (array, (axis,))]
    figures = da.blockwise(
        partial(_compute_chunk, request), (len(shape), *range(len(shape))), *pairs,
        new_axes={len(shape): len(request.figures)}, dtype=float, meta=np.empty((0,) * (len(shape) + 1)),
    )  # fmt: skip
    return labelled_dataset(request, values, figures)


def _compute_chunk(request: SweepRequest, *values: Array) -> Array:
    """The figures of one chunk of designs, in the form that Dask joins."""
    space = _design_space(request.space.parameters, values, is_list=request.space.is_list)
    return sweep_block(replace(request, space=space), 0, space.count).reshape(-1, *space.shape)


def optimisation_request(
    minimise: str | None,
    maximise: str | None,
    over: Ranges,
    keep: Ranges,
    *,
    is_global: bool,
    step: str | None,
) -> OptimisationRequest:
    """The aim and the constraints of an optimisation; raises LinkproofError for bad input before the search."""
    if (minimise is None) == (maximise is None):
        got = "neither" if minimise is None else "both"
        raise LinkproofError(f"expected --minimise FIGURE or --maximise FIGURE, got {got}; give one, such as Mkr.peak")
    varied, held = (
        tuple(range_word(*pair) for pair in given.items()) if isinstance(given, Mapping) else tuple(given)
        for given in (over, keep)
    )
    return OptimisationRequest(minimise or maximise or "", varied, held, minimise is not None, is_global, step or "")


def check_words(best: Optimum, motion: SteadyMotion) -> tuple[str, ...]:
    """The options by which ``compare`` checks the best design under the same motion; its file has one variant."""
    same = replace(motion.motion, variant=None)
    if SPEED in best.after:
        unit = best.problem.case.linkage.phi.speed_unit
        same = replace(same, speed=math.copysign(float(f"{best.after[SPEED] / unit.size:.15g}"), same.rpm))
    return tuple(option_words(same))
