"""The linkage file of a design: other numbers, the same assembly modes as the original."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from analytic.description.changes import SPEED, with_numbers
from analytic.description.changes import numbers as numbers_of
from analytic.description.loading import parse
from analytic.description.rewriting import DESIGN, rewritten
from analytic.errors import StructureError
from analytic.kinematics.decomposition import find_structure
from analytic.kinematics.mechanism import Mechanism
from analytic.kinematics.sweep import Sweep


def design_file(mechanism: Mechanism, numbers: Mapping[str, float], new_variant: str = DESIGN) -> str:
    """The text of the file with these numbers, SI, by name; its sketch moves where it would pick other modes.

    A speed among them is left out, for files have none. Raises LinkproofError for numbers that describe no linkage,
    AssemblyError where the design has no such sketch.
    """
    original, structure = mechanism.linkage, mechanism.structure
    numbers = {name: value for name, value in numbers.items() if name != SPEED}
    if original.scales_mass:
        before, after = numbers_of(original), numbers_of(with_numbers(original, numbers))
        numbers = {name: value for name, value in after.items() if value != before[name]}
    signs = tuple(dyad.sign for dyad in structure.dyads)
    text = rewritten(original.text, original.name, original.variant, numbers, new_variant=new_variant)
    try:
        new = Mechanism(parse(text, original.name, original.name))
        if structure.is_numerical or tuple(dyad.sign for dyad in new.structure.dyads) == signs:
            return text
    except StructureError:  # the sketch leaves a mode open
        pass
    design = with_numbers(original, numbers)
    sweep = Sweep(design, find_structure(design).with_signs(signs), np.asarray(design.sketch_angle))
    sketch = {
        f"sketch.{point}.{axis}": float(value)
        for point in design.sketch
        for axis, value in zip("xy", sweep.point(point), strict=True)
    }
    return rewritten(original.text, original.name, original.variant, {**numbers, **sketch}, new_variant=new_variant)
