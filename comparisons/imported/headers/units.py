"""Units as other tools print them: ``newton-meter``, ``N·m``, ``Nmm``, ``deg/sec**2``, ``°/s``, ``об/мин``.

The values of the plain units are those of linkage files (``analytic.description.units``); ``units.toml`` beside this
file has their other names, and the units that a linkage file does not need.
"""

from __future__ import annotations

import re
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Any, Final

from analytic.description.units import UNITS

_FILE: Final[Mapping[str, Any]] = tomllib.loads(Path(__file__).with_name("units.toml").read_text(encoding="utf-8"))

Dimension = tuple[int, int, int, int]  # exponents of m, kg, s and rad
PLAIN: Final[Dimension] = (0, 0, 0, 0)
KINDS: Final[Mapping[str, Dimension]] = {kind: tuple(powers) for kind, powers in _FILE["dimensions"].items()}


@dataclass(frozen=True)
class Unit:
    """A unit: its value in SI units and its dimension, in which an angle counts."""

    factor: float
    dimension: Dimension

    def __pow__(self, exponent: int) -> Unit:
        return Unit(self.factor**exponent, _dimension(exponent * part for part in self.dimension))

    def __mul__(self, other: Unit) -> Unit:
        parts = zip(self.dimension, other.dimension, strict=True)
        return Unit(self.factor * other.factor, _dimension(a + b for a, b in parts))

    def measures(self, dimension: Dimension) -> bool:
        """Whether it can be the unit of a quantity; a speed of rotation may be in 1/s."""
        return self.dimension == dimension or (
            dimension[3] == 1 and dimension[2] < 0 and self.dimension == (*dimension[:3], 0)
        )


def _dimension(parts: Any) -> Dimension:  # noqa: ANN401 - any iterable of four integers
    metre, kilogram, second, radian = parts
    return (metre, kilogram, second, radian)


def _named() -> dict[str, Unit]:
    """Every unit by every name it has."""
    units: dict[str, Unit] = {}
    for kind, dimension in KINDS.items():
        plain = {name: value for name, value in UNITS.get(kind, {}).items() if name.isalpha()} | _FILE.get(kind, {})
        units |= {name: Unit(value, dimension) for name, value in plain.items()}
    return units | {name: units[plain] for plain, names in _FILE["names"].items() for name in names}


NAMED: Final[Mapping[str, Unit]] = _named()
_LOWER: Final = {name.lower(): unit for name, unit in reversed(tuple(NAMED.items())) if len(name) > 1}
ONE: Final = Unit(1.0, PLAIN)
SUPERSCRIPTS: Final = str.maketrans("²³⁻¹", "23-1")
EXPONENT: Final = re.compile(r"(?:\*\*|\^)?\s*\(?(-?[1-4])\)?$")
# Names to offer, by dimension: those of linkage files, and the plain ones here.
OFFERED: Final[Mapping[Dimension, list[str]]] = {
    dimension: [
        name for kind in KINDS if KINDS[kind] == dimension for table in (UNITS, _FILE) for name in table.get(kind, {})
    ]
    for dimension in KINDS.values()
}
LONGEST: Final = 40  # characters of a unit


@lru_cache(maxsize=1024)
def parsed(text: str) -> Unit | None:
    """The unit that a text names, None if it names none; "-" and "1" are the unit of a plain number."""
    text = text.strip()
    if not text or len(text) > LONGEST:
        return None
    if text in ("-", "1"):
        return ONE
    return _name(text) or _product(text.translate(SUPERSCRIPTS).replace("**", "^"))


def _name(text: str) -> Unit | None:
    return NAMED.get(text) or _LOWER.get(text.lower())


def _product(text: str) -> Unit | None:
    """Of ``a*b/c*d`` and the like; one solidus, everything behind it divides."""
    above, solidus, below = text.partition("/")
    if solidus and (not below.strip() or "/" in below):
        return None
    top = ONE if above.strip() in ("", "1") else _factors(above)
    bottom = _factors(below.strip().removeprefix("(").removesuffix(")")) if solidus else ONE
    return top * bottom**-1 if top and bottom else None


def _factors(text: str) -> Unit | None:
    result = ONE
    for word in re.split(r"\s*[*·.⋅×]\s*|(?<=\w)-(?=[^\W\d])|\s+", text.strip()):
        unit = _power(word) if word else None
        if unit is None:
            return None
        result = result * unit
    return result


def _power(word: str) -> Unit | None:
    """A unit, with its exponent if any."""
    exponent = EXPONENT.search(word)
    name = word[: exponent.start()] if exponent else word
    unit = _name(name) or _run_together(name)
    return unit ** int(exponent[1]) if unit and exponent else unit


def _run_together(name: str) -> Unit | None:
    """``Nmm`` and the like: a force and a length."""
    for cut in (1, 2, 3):
        force, length = NAMED.get(name[:cut]), NAMED.get(name[cut:])
        if force and length and force.dimension == KINDS["force"] and length.dimension == KINDS["length"]:
            return force * length
    return None
