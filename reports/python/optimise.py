"""``linkproof.optimise``: the best design of a linkage as labelled arrays."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path

import xarray

from analytic.description.linkage import Linkage
from comparisons.designs.parameters import design_file
from reports.designs.optimum.optimise_terminal import document
from reports.python.keywords import of_linkage, with_keywords
from reports.requests.designs import optimum
from reports.requests.options.declaring import command_line, word
from reports.requests.options.designs import OptimiseOptions

Range = str | float | tuple[float | None, float | None] | None


@with_keywords(without=("over", "keep", "step", "simulate"))
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
    chosen, options = of_linkage(linkage, options)
    options = replace(
        options,
        over=tuple(_word(*pair) for pair in over.items()),  # in the form of the command that repeats the request
        keep=tuple(_word(*pair) for pair in table.items()),
        step=None if step is None else str(step),
    )
    result, conditions = optimum(chosen, options)
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
    text = design_file(result.problem.mechanism, result.after)
    return xarray.Dataset({**numbers, **figures}, {"design": ["before", "after"]}, {**about, **cost, "toml": text})


def _word(name: str, values: Range) -> str:
    """A number with its range in the form of the command line."""
    if values is None:
        return name
    if isinstance(values, tuple):
        return f"{name}={':'.join('' if end is None else word(float(end)) for end in values)}"
    return f"{name}={values if isinstance(values, str) else word(float(values))}"
