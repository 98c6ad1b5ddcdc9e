"""``linkproof.sweep``: figures over a space of designs as labelled arrays."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
import xarray
from numpy.typing import NDArray

from analytic.description.linkage import Linkage
from analytic.errors import LinkproofError
from comparisons.designs.parameters import Parameter, parameter
from comparisons.designs.sweep.saved_sweep import described, labelled
from comparisons.designs.sweep.simulated_designs import shares_of_limits
from comparisons.designs.sweep.space import DesignSpace, Grid, Listed
from comparisons.designs.sweep.sweep import SweepRequest, own_figures, sweep_block
from comparisons.designs.sweep.sweep import sweep as sweep_space
from comparisons.runs.cluster.connecting import opened
from reports.python.keywords import Words, of_linkage, with_keywords, words
from reports.requests.compare import campaign
from reports.requests.designs import check_sweep, simulated_campaign, sweep_request_of
from reports.requests.options.designs import SweepOptions
from reports.requests.steady import steady_case

Array = NDArray[np.float64]


@with_keywords(without=("vary", "table", "quantity"))
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

    If values are Dask arrays, so are the figures, computed chunk by chunk on request. Figures of other values are
    computed by the workers of a ``scheduler`` of Dask, if it is given: its address, "local:N" or a client. Extremes are
    taken at the sampled crank ``angles``, or are exact with ``refine``; with ``scale_mass`` masses change with lengths.
    ``simulate`` names engines that run some of the designs, as many as ``designs``, chosen by ``seed``:
    ``share_of_limit``, over ``engine`` and the designs, is the largest error of a design over its limit, infinite if a
    run failed and NaN without a run. Raises LinkproofError for bad input; if no design assembles, all values are NaN.
    """
    check_sweep(options)
    chosen, options = of_linkage(linkage, replace(options, quantity=words(figures)))
    case = steady_case(chosen, options)
    if (vary is None) == (table is None):
        raise LinkproofError(f"sweep: expected vary or table, got {'neither' if vary is None else 'both'}: pass one")
    given = table if vary is None else vary
    values = {str(name): _checked(str(name), given[name]) for name in given}
    parts = tuple(parameter(case.mechanism.linkage, name) for name in values)
    if not parts:
        raise LinkproofError("sweep: expected parameters, got none; name one or more")
    is_lazy = any(map(_is_lazy, values.values()))
    if is_lazy and options.simulate:
        raise LinkproofError("simulate: expected arrays of numbers, got Dask's, worked out later; pass NumPy arrays")
    space = _space(parts, [np.zeros(1)] * len(parts) if is_lazy else [*values.values()], is_table=vary is None)
    request, conditions = sweep_request_of(case, space, options)
    own_figures(request)  # raises LinkproofError for figures that no design has
    rows = _lazy(request, [*values.values()]) if is_lazy else _computed(request.on_single_path(), options.scheduler)
    about = {name: value for name, value in described(request, conditions, "").items() if name != "command"}
    dataset = labelled(request, values, rows, about)
    return _with_engines(dataset, request.on_single_path(), options) if options.simulate else dataset


def _with_engines(dataset: xarray.Dataset, request: SweepRequest, options: SweepOptions) -> xarray.Dataset:
    """The dataset with the errors of engines over some of the designs, as shares of their limits."""
    with TemporaryDirectory() as folder:
        designs, wanted, limits = simulated_campaign(request, options, Path(folder))
        runs = campaign(wanted, limits=limits)
        with runs.running.pool() as pool:
            judged = runs.compared(pool)
    shares = shares_of_limits(designs, judged.records, request.space.count)
    values = np.array([*shares.values()]).reshape(-1, *request.space.shape)
    over = ("engine", *request.space.dimensions)
    return dataset.assign_coords(engine=[*shares]).assign(share_of_limit=(over, values, {"units": "1"}))


def _is_lazy(values: object) -> bool:
    return hasattr(values, "__dask_graph__")


def _checked(name: str, given: Any) -> Any:  # noqa: ANN401 - arrays of two kinds
    """Values of a parameter; raises LinkproofError if they are not a list of finite numbers."""
    data = given.data if isinstance(given, xarray.DataArray) else given
    values = data if _is_lazy(data) else np.asarray(data, dtype=float)
    if len(values.shape) != 1 or values.shape == (0,) or not (_is_lazy(values) or np.all(np.isfinite(values))):
        raise LinkproofError(f"{name}: expected a flat list of finite numbers, got {values!r:.60}; pass such a list")
    return values


def _space(parts: tuple[Parameter, ...], values: Sequence[Array], *, is_table: bool) -> DesignSpace:
    if not is_table:
        return Grid(parts, tuple(values))
    if len({len(value) for value in values}) > 1:
        raise LinkproofError(
            f"table: expected columns of one length, got {[len(value) for value in values]}; correct it"
        )
    return Listed(parts, tuple(values))


def _computed(request: SweepRequest, scheduler: object) -> Array:
    """Figures of all designs, (figures, *shape), computed here or on the workers of a scheduler."""
    values = np.empty((len(request.figures), request.space.count))

    def keep(number: int, block: Array) -> None:
        values[:, slice(*request.block(number))] = block

    with opened(scheduler, None) as pool:
        sweep_space(request if pool is None else replace(request, cores=1), keep=keep, pool=pool)
    return values.reshape(-1, *request.space.shape)


def _lazy(request: SweepRequest, values: Sequence[Any]) -> Any:  # noqa: ANN401 - Dask's own array
    """The same as a Dask array, a chunk for every combination of the chunks of the values."""
    import dask.array as da  # noqa: PLC0415 - only Dask arrays need it

    shape = request.space.shape
    over = [0] * len(values) if len(shape) == 1 else range(len(shape))
    arrays = [value if _is_lazy(value) else da.from_array(value, chunks=-1) for value in values]
    pairs = [part for array, axis in zip(arrays, over, strict=True) for part in (array, (axis,))]
    return da.blockwise(
        partial(_chunk, request), (len(shape), *range(len(shape))), *pairs, new_axes={len(shape): len(request.figures)},
        dtype=float, meta=np.empty((0,) * (len(shape) + 1)),
    )  # fmt: skip


def _chunk(request: SweepRequest, *values: Array) -> Array:
    space = _space(request.space.parameters, values, is_table=isinstance(request.space, Listed))
    return sweep_block(replace(request, space=space), 0, space.count).reshape(-1, *space.shape)
