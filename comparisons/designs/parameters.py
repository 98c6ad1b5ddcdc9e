"""Numbers of a linkage's file that designs differ in, by name, in the units of the file; and the file of a design."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Final, Literal

import numpy as np

from analytic.description.changes import SPEED, Kind, design_numbers, named_numbers, with_numbers
from analytic.description.changes import numbers as numbers_of
from analytic.description.crank_motion import RPM
from analytic.description.file_units import FileUnit, file_unit
from analytic.description.linkage import Linkage
from analytic.description.loading import parse
from analytic.description.rewriting import DESIGN, rewritten
from analytic.description.units import factor
from analytic.errors import LinkproofError, StructureError, UnknownNameError
from analytic.kinematics.decomposition import find_structure
from analytic.kinematics.mechanism import Mechanism
from analytic.kinematics.sweep import Sweep

# The units of kinds that a file does not state.
FIXED: Final[Mapping[str, FileUnit]] = {"direction": FileUnit("", 1.0), "acceleration": FileUnit("m/s^2", 1.0)}
LISTED: Final = "those that `linkproof list --numbers` shows"
WRITTEN: Final = re.compile(r"\s*(?P<number>[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)\s*(?P<unit>\D.*?)?\s*")


@dataclass(frozen=True)
class Parameter:
    """A number by its name in the file (``analytic.description.changes``), its SI value and the unit of the file."""

    name: str
    kind: Kind | Literal["angle", "speed"]
    value: float
    unit: FileUnit

    @property
    def shown(self) -> str:
        """The name with the unit, as tables are headed."""
        return f"{self.name} [{self.unit.name}]" if self.unit.name else self.name

    def si(self, text: str) -> float:
        """The SI value of a number as it is typed: in the unit of the file, or with one of its own, 17cm.

        Raises LinkproofError for no number, UnknownNameError for a unit that does not measure this.
        """
        number, size = self._read(text)
        return number * size

    def in_file(self, text: str) -> float:
        """The same number in the unit of the file."""
        number, size = self._read(text)
        return number if size == self.unit.size else float(f"{number * size / self.unit.size:.15g}")

    def _read(self, text: str) -> tuple[float, float]:
        """A number, and the size of its unit in SI."""
        read = WRITTEN.fullmatch(text)
        number = float(read["number"]) if read else math.nan
        if read is None or not math.isfinite(number):
            raise LinkproofError(
                f"{self.name}: expected a finite number{f' of {self.unit.name}' if self.unit.name else ''}, got "
                f"'{text}'; correct it"
            )
        return number, self.unit.size if read["unit"] is None else self._size(read["unit"])

    def _size(self, unit: str) -> float:
        if self.kind in FIXED or self.kind == SPEED:
            if unit != self.unit.name:
                raise LinkproofError(
                    f"{self.name}: expected {self.unit.name or 'a plain number'}, got '{unit}'; correct it"
                )
            return self.unit.size
        try:
            return factor(self.kind, unit)
        except UnknownNameError as error:
            raise LinkproofError(f"{self.name}: {error}") from error


def parameters(linkage: Linkage) -> dict[str, Parameter]:
    """Every number of a linkage that its designs may differ in, by name."""
    numbers = design_numbers(linkage).items()
    return {name: Parameter(name, kind, value, _unit(linkage, kind)) for name, (kind, value) in numbers}


def parameter(linkage: Linkage, name: str, speed: float = math.nan) -> Parameter:
    """One of them, or the driver's speed, whose own value is that of a motion, SI; raises UnknownNameError."""
    if name == SPEED:
        return Parameter(SPEED, SPEED, abs(speed), speed_unit(linkage))
    known = parameters(linkage)
    if name not in known:
        raise UnknownNameError(f"parameter of '{linkage.name}'", name, [*known, SPEED], LISTED)
    return known[name]


def mass_words(linkage: Linkage, names: Iterable[str]) -> str:
    """Words on the masses of designs for their conditions: none where no length of a moving link differs."""
    places = {name: number.place for name, number in named_numbers(linkage).items()}
    if not any(places.get(name, ())[0:3:2] == ("links", "points") for name in names):
        return ""
    return ", masses scaled with lengths" if linkage.scales_mass else ", masses as in the file"


def speed_unit(linkage: Linkage) -> FileUnit:
    """The unit of the driver's speed: rpm, or the file's unit of length per second."""
    return file_unit("m/s", linkage) if linkage.is_linear else FileUnit("rpm", RPM)


def _unit(linkage: Linkage, kind: Kind) -> FileUnit:
    if kind in FIXED:
        return FIXED[kind]
    name = linkage.units[kind]
    return FileUnit(name, factor(kind, name))


# The linkage file of a design: other numbers, the same assembly modes as the original.


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
