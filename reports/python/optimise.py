"""``linkproof.optimise``: the best of a linkage's designs, labelled."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Unpack

import xarray

from analytic.description.linkage import Linkage
from comparisons.designs.design_file import design_file
from comparisons.designs.steady_motion import SAMPLES
from reports.command_line.commands.optimise import OptimiseChoice, optimum, wish
from reports.command_line.destination import Destination
from reports.designs.optimum.optimise_terminal import document
from reports.python.options import MotionOptions, choice, chosen_linkage

Range = str | float | tuple[float | None, float | None] | None


def optimise(
    linkage: Linkage | str | Path,
    *,
    over: Mapping[str, Range],
    minimise: str | None = None,
    maximise: str | None = None,
    keep: Mapping[str, Range] | Sequence[str] = (),
    angles: int = SAMPLES,
    scale_mass: bool = False,
    starts: int = 1,
    seed: int = 0,
    everywhere: bool = False,
    step: str | float | None = None,
    **options: Unpack[MotionOptions],
) -> xarray.Dataset:
    """The best design of a linkage, as by ``linkproof optimise``, in the units of its file.

    ``over`` has the bounds of each number by name, (170, 180) or "±10%"; ``keep`` the figures to hold: None holds the
    file's value, a number that value, a pair a range, in which None means unbounded. ``everywhere`` is the
    command's ``--global``, ``step`` its ``--round``; with ``scale_mass`` masses change with lengths.

    Numbers and figures are variables over ``design``, before and after, with their units; the attributes have the
    ``toml`` of the new design's file, the ``method`` and its cost, and the ``residual``, 0 at a local optimum. Raises
    LinkproofError for bad input, and if no design holds the figures of ``keep``.
    """
    kept = dict.fromkeys(keep) if not isinstance(keep, Mapping) else keep
    how = {"starts": starts, "seed": seed, "everywhere": everywhere, "step": "" if step is None else str(step)}
    wished = wish(minimise, maximise, [_word(*one) for one in over.items()], [_word(*one) for one in kept.items()], how)
    asked = OptimiseChoice(
        mechanism=str(linkage), wish=wished, angles=angles, scale_mass=scale_mass,
        **choice(options),
    )  # fmt: skip
    chosen = chosen_linkage(linkage, asked.variant)
    found, conditions = optimum(chosen, asked, Destination(quiet=True))
    saved = document(found, asked.command, conditions)
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
        return f"{name}={':'.join('' if end is None else repr(float(end)) for end in values)}"
    return f"{name}={values if isinstance(values, str) else repr(float(values))}"
