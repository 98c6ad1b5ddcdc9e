"""A header as words with their meanings: names of a linkage, words of several languages, and what is neither."""

from __future__ import annotations

import re
import tomllib
import unicodedata
from collections import defaultdict
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Any, Final

from analytic.description.units import UNITS

Meanings = frozenset[str]
Table = Mapping[tuple[str, ...], Meanings]

TOKEN: Final = re.compile(r"[^\W\d_]+|\d+")
# Where a word begins inside another: camelCase, and the last capital of a run of them.
CAMEL: Final = re.compile(r"(?<=[a-z])(?=[A-Z])|(?<=[A-Z])(?=[A-Z][a-z])")
NO_MEANING: Final = frozenset({"nothing"})  # the meaning of words that change nothing


def plain_letters(text: str) -> str:
    """A text without case, accents and the marks of letters."""
    decomposed = unicodedata.normalize("NFKD", text.casefold())
    letters = "".join(c for c in decomposed if not unicodedata.combining(c) or c in "\u3099\u309a")
    return unicodedata.normalize("NFC", letters).replace("ł", "l").replace("ø", "o")


_FILE: Final = tomllib.loads(Path(__file__).with_name("header_words.toml").read_text(encoding="utf-8"))
TOGETHER: Final = {plain_letters(word.replace("|", "")): word.split("|") for word in _FILE.pop("together")}


def split_tokens(text: str) -> list[str]:
    """The words and numbers of a text, and the parts of words in the list of those written together."""
    tokens = TOKEN.findall(CAMEL.sub(" ", text))
    return [part for token in tokens for part in TOGETHER.get(plain_letters(token), (token,))]


def _merge_meanings(pairs: Iterable[tuple[tuple[str, ...], str]]) -> Table:
    """All meanings of each group of words."""
    table: dict[tuple[str, ...], Meanings] = defaultdict(frozenset)
    for texts, meaning in pairs:
        table[texts] |= {meaning}
    return dict(table)


WORDS: Final = _merge_meanings(
    (tuple(plain_letters(word).split()), meaning) for meaning, texts in _FILE.items() for word in texts
)


def name_meanings(names: Iterable[str]) -> Table:
    """Meanings, ``:name``, of names by their words; a number alone is a plot's, "Angular Velocity2", and no name."""
    return _merge_meanings(
        (key, f":{name}") for name in names if not all(map(str.isdigit, key := _name_key(split_tokens(name))))
    )


def _name_key(texts: Iterable[str]) -> tuple[str, ...]:
    """The key of a name in a table of meanings: its words in lower case, but for single letters."""
    return tuple(word if len(word) == 1 else word.casefold() for word in texts)


def header_words(header: str, names: Table) -> Iterator[tuple[str, Meanings]]:
    """The words of a header with all that each may mean, of which an unknown one has nothing.

    Numbers that belong to no name are left out, and words that change nothing.
    """
    every, at = split_tokens(header), 0
    longest = max(map(len, [*WORDS, *names]))
    while at < len(every):
        for end in range(min(len(every), at + longest), at, -1):
            part = every[at:end]
            meanings = names.get(_name_key(part), frozenset()) | WORDS.get(tuple(map(plain_letters, part)), frozenset())
            if meanings:
                break
        text, at = " ".join(part), end
        if meanings != NO_MEANING and (meanings or not text.isdigit()):
            yield text, meanings


# Units as other tools print them: ``newton-meter``, ``N·m``, ``Nmm``, ``deg/sec**2``, ``°/s``, ``об/мин``.
#
# The values of the plain units are those of linkage files (``analytic.description.units``); ``header_units.toml`` has
# their other names, and the units that a linkage file does not need.

_UNITS_FILE: Final[Mapping[str, Any]] = tomllib.loads(
    Path(__file__).with_name("header_units.toml").read_text(encoding="utf-8")
)

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


def _units_by_name() -> dict[str, Unit]:
    """All units by each of their names."""
    units: dict[str, Unit] = {}
    for kind, dimension in _UNITS_FILE["dimensions"].items():
        values = {**UNITS.get(kind, {}), **_UNITS_FILE.get(kind, {})}
        units |= {name: Unit(value, tuple(dimension)) for name, value in values.items()}
    return units | {name: units[plain] for plain, names in _UNITS_FILE["names"].items() for name in names}


UNITS_BY_NAME: Final[Mapping[str, Unit]] = _units_by_name()
_UNITS_BY_LOWER_CASE: Final = {
    name.lower(): unit for name, unit in reversed(tuple(UNITS_BY_NAME.items())) if len(name) > 1
}
DIMENSIONLESS: Final = Unit(1.0, (0, 0, 0, 0))
SUPERSCRIPTS: Final = str.maketrans("²³⁻¹", "23-1")
FACTOR_SIGN: Final = re.compile(r"\s*[*·.⋅×]\s*|(?<=\w)-(?=[^\W\d])|\s+")
POWER: Final = re.compile(r"(.+?)(?:\^?\s*\(?(-?[1-4])\)?)?")
LONGEST: Final = 40  # characters of a unit


def _find_unit(name: str) -> Unit | None:
    """A unit by its name, in any case where that is unknown as written; None for no unit."""
    return UNITS_BY_NAME.get(name) or _UNITS_BY_LOWER_CASE.get(name.lower())


@lru_cache(maxsize=1024)
def parse_unit(text: str) -> Unit | None:
    """The unit that a text names, such as ``a*b/c^2``, None if it names none; "-" is that of a plain number.

    Of two solidi the meaning is open, so there may be one.
    """
    text = text.strip()
    if not text or len(text) > LONGEST:
        return None
    if text == "-" or _find_unit(text):
        return _find_unit(text) or DIMENSIONLESS
    above, *below = text.translate(SUPERSCRIPTS).replace("**", "^").split("/")
    parts = [] if below and above.strip() in ("", "1") else [(above, 1)]
    parts += [(part.strip().removeprefix("(").removesuffix(")"), -1) for part in below]
    result = DIMENSIONLESS
    for part, sign in parts:
        for word in FACTOR_SIGN.split(part.strip()):
            power = POWER.fullmatch(word)
            unit = _find_unit(power[1]) if power else None
            if power is None or unit is None or len(below) > 1:
                return None
            result = result.times(unit, sign * int(power[2] or 1))
    return result
