"""``linkproof.optimise``: the best of a linkage's designs, labelled."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path

import xarray

from analytic.description.linkage import Linkage
from comparisons.designs.design_file import design_file
from reports.designs.optimum.optimise_terminal import document
from reports.python.keywords import of_linkage, with_keywords
from reports.requests.optimise import optimum
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
    held = dict.fromkeys(keep) if not isinstance(keep, Mapping) else keep
    chosen, options = of_linkage(linkage, options)
    options = replace(
        options,
        over=tuple(_word(*one) for one in over.items()),  # as the command that repeats the request has them
        keep=tuple(_word(*one) for one in held.items()),
        step=None if step is None else str(step),
    )
    found, conditions = optimum(chosen, options)
    saved = document(found, command_line("optimise", options), conditions)
    numbers = {
        one.parameter.name: (
            "design",
            [side[one.parameter.name] / one.parameter.unit.size for side in (found.before, found.after)],
            {"units": one.parameter.unit.name, "low": one.low / one.parameter.unit.size,
             "high": one.high / one.parameter.unit.size},
        )
        for one in found.problem.variables
    }  # fmt: skip
    figures = {
        one.name: ("design", found.values[:, column] / one.unit.size, {"units": one.unit.name})
        for column, one in enumerate(found.figures)
    }
    about = {name: saved[name] for name in ("mechanism", "variant", "conditions", "command")}
    cost = {name: value for name, value in saved["search"].items() if name != "ends"}
    text = design_file(found.problem.mechanism, found.after)
    return xarray.Dataset({**numbers, **figures}, {"design": ["before", "after"]}, {**about, **cost, "toml": text})


def _word(name: str, values: Range) -> str:
    """The same as it is typed."""
    if values is None:
        return name
    if isinstance(values, tuple):
        return f"{name}={':'.join('' if end is None else word(float(end)) for end in values)}"
    return f"{name}={values if isinstance(values, str) else word(float(values))}"
