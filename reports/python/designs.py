"""``linkproof.sweep``: figures over a space of designs as labelled arrays."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import xarray
from numpy.typing import NDArray

from analytic.description.linkage import Linkage
from analytic.errors import LinkproofError
from comparisons.designer.parameters import Parameter, design_file, parameter
from comparisons.designer.sweep import DesignSpace, SweepRequest, figures_of_file, labelled_dataset, sweep_block
from comparisons.designer.sweep import sweep as sweep_space
from comparisons.designer.tolerances import (
    QUANTILES,
    SEED,
    Tolerances,
    ToleranceStudy,
    read_tolerances,
    tolerance_study,
)
from reports.designs.optimise_terminal import document
from reports.python.keywords import Words, resolve_linkage, with_keywords, words
from reports.requests.designs import build_sweep_request, build_tolerance_request, find_optimum, steady_case
from reports.requests.options import (
    NOT_STEADY,
    OptimiseOptions,
    SweepOptions,
    ToleranceOptions,
    command_line,
    typed_word,
)

Array = NDArray[np.float64]


@with_keywords(without=("vary", "table", "quantity", *NOT_STEADY))
def sweep(
    linkage: Linkage | str | Path,
    vary: Mapping[str, Any] | None = None,
    figures: Words = (),
    *,
    table: Any = None,  # noqa: ANN401 - whatever has columns
    options: SweepOptions,
) -> xarray.Dataset:
    """Figures of many designs of a linkage, as by ``linkproof sweep``: a variable each, NaN for designs out of reach.

    ``vary`` has the values of a parameter by its name, (n,) each, and the dataset a dimension per parameter: a grid.
    ``table``, a mapping, DataFrame or Dataset of columns (n,) by name, lists designs instead, and the dimension is
    ``design``. Values go in and figures come out in the units of the linkage's file, as on the command line;
    ``evaluate`` takes its ``designs`` in SI. ``figures`` are the names of ``--quantity``, such as "Mkr.peak".

    If values are Dask arrays, so are the figures, computed chunk by chunk on request; there is no limit to their
    number. Extremes are taken at 180 crank angles, or are exact with ``refine``; with ``scale_mass`` masses change with
    lengths. Raises LinkproofError for bad input; if no design assembles, all values are NaN.
    """
    chosen, options = resolve_linkage(linkage, replace(options, quantity=words(figures)))
    case = steady_case(chosen, options)
    if (vary is None) == (table is None):
        raise LinkproofError(f"sweep: expected vary or table, got {'neither' if vary is None else 'both'}: pass one")
    given = table if vary is None else vary
    values = {str(name): _check_values(str(name), given[name]) for name in given}
    parts = tuple(parameter(case.mechanism.linkage, name) for name in values)
    if not parts:
        raise LinkproofError("sweep: expected parameters, got none; name one or more")
    is_lazy = any(map(_is_dask_array, values.values()))
    space = _design_space(parts, [np.zeros(1)] * len(parts) if is_lazy else [*values.values()], is_list=vary is None)
    request = build_sweep_request(case, space, options)
    if not is_lazy:
        return sweep_space(request).dataset
    figures_of_file(request)  # raises LinkproofError for figures that no design has
    return labelled_dataset(request, values, _dask_array(request, [*values.values()]))


def _is_dask_array(values: object) -> bool:
    return hasattr(values, "__dask_graph__")


def _check_values(name: str, given: Any) -> Any:  # noqa: ANN401 - arrays of two kinds
    """Values of a parameter; raises LinkproofError if they are not a list of finite numbers."""
    data = given.data if isinstance(given, xarray.DataArray) else given
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


def _dask_array(request: SweepRequest, values: Sequence[Any]) -> Any:  # noqa: ANN401 - Dask's own array
    """Figures of all designs as a Dask array (*shape, figures), a chunk for every combination of the values' chunks."""
    import dask.array as da  # noqa: PLC0415 - only Dask arrays need it

    shape = request.space.shape
    over = [0] * len(values) if request.space.is_list else range(len(shape))
    arrays = [value if _is_dask_array(value) else da.from_array(value, chunks=-1) for value in values]
    pairs = [part for array, axis in zip(arrays, over, strict=True) for part in (array, (axis,))]
    return da.blockwise(
        partial(_compute_chunk, request), (len(shape), *range(len(shape))), *pairs,
        new_axes={len(shape): len(request.figures)}, dtype=float, meta=np.empty((0,) * (len(shape) + 1)),
    )  # fmt: skip


def _compute_chunk(request: SweepRequest, *values: Array) -> Array:
    """The figures of one chunk of designs, in the form that Dask joins."""
    space = _design_space(request.space.parameters, values, is_list=request.space.is_list)
    return sweep_block(replace(request, space=space), 0, space.count).reshape(-1, *space.shape)


# ``linkproof.optimise``: the best design of a linkage as labelled arrays.

Range = str | float | tuple[float | None, float | None] | None


@with_keywords(without=("over", "keep", "step", *NOT_STEADY))
def optimise(
    linkage: Linkage | str | Path,
    *,
    over: Mapping[str, Range],
    keep: Mapping[str, Range] | Sequence[str] = (),
    step: str | float | None = None,
    options: OptimiseOptions,
) -> xarray.Dataset:
    """The best design of a linkage, as by ``linkproof optimise``, in the units of its file.

    ``over`` has the bounds of each number by name, (170, 180) or "±10%"; ``keep`` the figures to hold: None holds the
    file's value, a number that value, a pair a range, in which None means unbounded. ``everywhere`` is the
    command's ``--global``, ``step`` its ``--round``; with ``scale_mass`` masses change with lengths.

    Numbers and figures are variables over ``design``, before and after, with their units; the attributes have the
    ``toml`` of the new design's file, the ``method`` and its cost, and the ``residual``, 0 at a local optimum. Raises
    LinkproofError for bad input, and if no design holds the figures of ``keep``.
    """
    table = dict.fromkeys(keep) if not isinstance(keep, Mapping) else keep
    chosen, options = resolve_linkage(linkage, options)
    options = replace(
        options,
        over=tuple(_range_word(*pair) for pair in over.items()),  # in the form of the command that repeats the request
        keep=tuple(_range_word(*pair) for pair in table.items()),
        step=None if step is None else str(step),
    )
    result, conditions = find_optimum(chosen, options)
    saved = document(result, command_line("optimise", options), conditions)
    numbers = {
        variable.parameter.name: (
            "design",
            [side[variable.parameter.name] / variable.parameter.unit.size for side in (result.before, result.after)],
            {"units": variable.parameter.unit.name, "low": variable.low / variable.parameter.unit.size,
             "high": variable.high / variable.parameter.unit.size},
        )
        for variable in result.problem.variables
    }  # fmt: skip
    figures = {
        figure.name: ("design", result.values[:, column] / figure.unit.size, {"units": figure.unit.name})
        for column, figure in enumerate(result.figures)
    }
    about = {name: saved[name] for name in ("mechanism", "variant", "conditions", "command")}
    cost = {name: value for name, value in saved["search"].items() if name != "ends"}
    text = design_file(result.problem.mechanism, result.written)
    return xarray.Dataset({**numbers, **figures}, {"design": ["before", "after"]}, {**about, **cost, "toml": text})


def _range_word(name: str, values: Range) -> str:
    """A number with its range in the form of the command line."""
    if values is None:
        return name
    if isinstance(values, tuple):
        return f"{name}={':'.join('' if end is None else typed_word(float(end)) for end in values)}"
    return f"{name}={values if isinstance(values, str) else typed_word(float(values))}"


# ``linkproof.tolerance``: the change of each result with each toleranced number of a linkage.


@with_keywords(without=NOT_STEADY)
def tolerance(
    linkage: Linkage | str | Path,
    tolerances: Mapping[str, Any] | str | Path,
    results: Words | None = None,
    *,
    options: ToleranceOptions,
) -> xarray.Dataset:
    """The effect of tolerances on a linkage's results, over ``result`` and ``parameter``; in the file's units.

    ``tolerances`` are ± by name, as under [tolerances] in a file of ``linkproof tolerance``, or such a file, which also
    supplies ``results`` and ``speed`` if they are not given: rpm, or the file's unit of length per second. With
    ``scale_mass`` masses change with lengths.

    ``contribution`` (±), ``share`` (of the variance), ``worst`` (±, all together) and ``linear_deviation`` follow from
    ``derivative``, whose attribute ``derivatives`` is exact or difference. ``change`` (over ``limit``) is computed
    with one number at its limit, ``corner`` (``end``) with all; ``mean``, ``deviation`` and ``quantile`` are of random
    designs. Derivatives are NaN where two local maxima are equal, and so are values of designs that do not
    assemble. Raises LinkproofError for bad input.
    """
    given = Tolerances((), None, tolerances) if isinstance(tolerances, Mapping) else read_tolerances(Path(tolerances))
    given = replace(given, results=given.results if results is None else words(results))
    if options.speed is not None:
        given = replace(given, speed=options.speed)
    chosen, options = resolve_linkage(linkage, options)
    return dataset(tolerance_study(build_tolerance_request(chosen, given, options)))


def dataset(study: ToleranceStudy) -> xarray.Dataset:
    """A study as labelled arrays in the units of the linkage's file."""
    request = study.request
    size = np.array([figure.unit.size for figure in request.figures])
    parameter_size = np.array([tolerance.parameter.unit.size for tolerance in request.tolerances])
    of, by = ("result",), ("result", "parameter")
    return xarray.Dataset(
        {
            "nominal": (of, study.nominal / size),
            "derivative": (by, study.derivatives * parameter_size / size[:, None]),
            "contribution": (by, study.contributions / size[:, None]),
            "share": (by, study.shares),
            "change": ((*by, "limit"), study.changes / size[:, None, None]),
            "worst": (of, study.worst / size),
            "corner": ((*of, "end"), study.corners / size[:, None]),
            "linear_deviation": (of, study.deviations / size),
            "mean": (of, study.mean / size),
            "deviation": (of, study.deviation / size),
            "quantile": ((*of, "level"), study.quantiles / size[:, None]),
        },
        coords={
            "result": [figure.name for figure in request.figures],
            "units": (of, [figure.unit.name for figure in request.figures]),
            "parameter": [tolerance.name for tolerance in request.tolerances],
            "parameter_units": (("parameter",), [tolerance.parameter.unit.name for tolerance in request.tolerances]),
            "plus_minus": (("parameter",), [tolerance.plus_minus for tolerance in request.tolerances] / parameter_size),
            "distribution": (("parameter",), [str(tolerance.distribution) for tolerance in request.tolerances]),
            "limit": ["lower", "upper"],
            "end": ["least", "largest"],
            "level": [*QUANTILES],
        },
        attrs={
            "mechanism": request.mechanism.linkage.name,
            "variant": request.mechanism.linkage.variant,
            "conditions": request.conditions,
            "derivatives": study.how,
            "corners": "all" if study.has_all_corners else "the two that derivatives single out",
            "samples": request.samples,
            "seed": SEED,
            "assembled": study.assembled,
        },
    )
