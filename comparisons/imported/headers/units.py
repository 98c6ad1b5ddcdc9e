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

Dimension = tuple[int, ...]  # exponents of m, kg, s and rad


@dataclass(frozen=True)
class Unit:
    """A unit: its value in SI units and its dimension, in which an angle counts."""

    factor: float
    dimension: Dimension

    def times(self, other: Unit, exponent: int) -> Unit:
        """The product with a power of another unit."""
        powers = zip(self.dimension, other.dimension, strict=True)
        return Unit(self.factor * other.factor**exponent, tuple(own + exponent * added for own, added in powers))

    def measures(self, dimension: Dimension) -> bool:
        """Whether it can be the unit of a quantity; a speed of rotation may be in 1/s."""
        turns = dimension[3] == 1 and dimension[2] < 0
        return self.dimension == dimension or (turns and self.dimension == (*dimension[:3], 0))


def _named() -> dict[str, Unit]:
    """Every unit by every name it has."""
    units: dict[str, Unit] = {}
    for kind, dimension in _FILE["dimensions"].items():
        values = {**UNITS.get(kind, {}), **_FILE.get(kind, {})}
        units |= {name: Unit(value, tuple(dimension)) for name, value in values.items()}
    return units | {name: units[plain] for plain, names in _FILE["names"].items() for name in names}


NAMED: Final[Mapping[str, Unit]] = _named()
_LOWER: Final = {name.lower(): unit for name, unit in reversed(tuple(NAMED.items())) if len(name) > 1}
DIMENSIONLESS: Final = Unit(1.0, (0, 0, 0, 0))
SUPERSCRIPTS: Final = str.maketrans("²³⁻¹", "23-1")
BETWEEN: Final = re.compile(r"\s*[*·.⋅×]\s*|(?<=\w)-(?=[^\W\d])|\s+")
POWER: Final = re.compile(r"(.+?)(?:\^?\s*\(?(-?[1-4])\)?)?")
LONGEST: Final = 40  # characters of a unit


def _unit(name: str) -> Unit | None:
    return NAMED.get(name) or _LOWER.get(name.lower())


@lru_cache(maxsize=1024)
def parsed(text: str) -> Unit | None:
    """The unit that a text names, such as ``a*b/c^2``, None if it names none; "-" is that of a plain number.

    Of two solidi the meaning is open, so there may be one.
    """
    text = text.strip()
    if not text or len(text) > LONGEST:
        return None
    if text == "-" or _unit(text):
        return _unit(text) or DIMENSIONLESS
    above, *below = text.translate(SUPERSCRIPTS).replace("**", "^").split("/")
    parts = [] if below and above.strip() in ("", "1") else [(above, 1)]
    parts += [(part.strip().removeprefix("(").removesuffix(")"), -1) for part in below]
    result = DIMENSIONLESS
    for part, sign in parts:
        for word in BETWEEN.split(part.strip()):
            power = POWER.fullmatch(word)
            unit = _unit(power[1]) if power else None
            if power is None or unit is None or len(below) > 1:
                return None
            result = result.times(unit, sign * int(power[2] or 1))
    return result
