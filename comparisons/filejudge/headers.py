"""A header as words with their meanings, and the signal it means: the one of which all its words and its unit are true.

Of every signal it is known which words are true of it and which it needs. No word of a header is passed over: one that
is unknown, or true of no signal that the others mean, leaves the column to the user.
"""

from __future__ import annotations

import re
import tomllib
import unicodedata
from collections import defaultdict
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property, lru_cache
from pathlib import Path
from typing import Any, Final

import numpy as np

from analytic import signals
from analytic.description.linkage import GROUND, Linkage
from analytic.description.units import UNITS
from analytic.errors import LinkproofError, listed, shortened
from analytic.kinematics.mechanism import Mechanism
from comparisons.filejudge.columns import TIME, Column

Meanings = frozenset[str]
Table = Mapping[tuple[str, ...], Meanings]

TOKEN: Final = re.compile(r"[^\W\d_]+|\d+")
# Where a word begins inside another: camelCase, and the last capital of a run of them.
CAMEL: Final = re.compile(r"(?<=[a-z])(?=[A-Z])|(?<=[A-Z])(?=[A-Z][a-z])")
NO_MEANING: Final = frozenset({"nothing"})  # the meaning of words that change nothing

LONGEST: Final = 200  # characters of a header that is read
# A name and its unit: "Torque (N*m)", "Torque [Nm]", "M{Nm}"; "M in Nm", "M / Nm", "M, Nm", "torque_Nm", "Torque Nm".
WITH_UNIT: Final = (
    r"(.*?)\s*[(\[{<]\s*([^()\[\]{}<>]*(?:\([^()]*\)[^()\[\]{}<>]*)?)\s*[)\]}>]\s*",
    r"(.+?)\s+in\s+(\S.*)", r"([^/]+?)\s*/\s*(\S.*)", r"(.+?)\s*[,:;]\s*(\S.*)", r"(.+)_([^_]+)", r"(.+)\s+(\S+)",
)  # fmt: skip
REPEAT_NUMBER: Final = re.compile(r"\s#\d+$")  # the number of a repeated header
# What a signal in an SI unit measures, and what else is true of it.
QUANTITIES: Final = {
    "s": {TIME}, "m": {"displacement"}, "m/s": {"speed"}, "m/s²": {"acceleration"}, "N": {"force"}, "N m": {"torque"},
    "rad": {"angle", "displacement"}, "rad/s": {"angular_speed", "speed"},
    "rad/s²": {"angular_acceleration", "acceleration"},
    "W": {"power"}, "J": {"energy"}, "kg m²": {"inertia"}, "kg": {"inertia"},
}  # fmt: skip
EVERY_QUANTITY: Final[Meanings] = frozenset().union(*QUANTITIES.values())
AROUND: Final = {"angular", "angle", "z"}
DRIVE: Final = ("phi", "omega", "epsilon", "Mkr", "Peq")
COMPONENTS: Final = frozenset({"x", "y", "z", "magnitude"})  # each of which has to be true: "vx" is a speed and x


def plain_letters(text: str) -> str:
    """A text in lower case, without accents and marks on letters, but those of kana; ł and ø become l and o."""
    decomposed = unicodedata.normalize("NFKD", text.casefold())
    letters = "".join(c for c in decomposed if not unicodedata.combining(c) or c in "\u3099\u309a")
    return unicodedata.normalize("NFC", letters).replace("ł", "l").replace("ø", "o")


_FILE: Final = tomllib.loads(Path(__file__).with_name("header_words.toml").read_text(encoding="utf-8"))
TOGETHER: Final = {plain_letters(word.replace("|", "")): word.split("|") for word in _FILE.pop("together")}


def split_tokens(text: str) -> list[str]:
    """The words and numbers of a text, as written, without all other signs.

    They are divided at capitals inside, as in camelCase, and where words written together are in the list of such.
    """
    tokens = TOKEN.findall(CAMEL.sub(" ", text))
    return [part for token in tokens for part in TOGETHER.get(plain_letters(token), (token,))]


def _merge_meanings(pairs: Iterable[tuple[tuple[str, ...], str]]) -> Table:
    """The table of all meanings of each group of words, from pairs of such a tuple of words and one meaning."""
    table: dict[tuple[str, ...], Meanings] = defaultdict(frozenset)
    for texts, meaning in pairs:
        table[texts] |= {meaning}
    return dict(table)


WORDS: Final = _merge_meanings(
    (tuple(plain_letters(word).split()), meaning) for meaning, texts in _FILE.items() for word in texts
)


def name_meanings(names: Iterable[str]) -> Table:
    """The table of the meanings, ``:name``, of names by their words.

    A number alone is a plot's, "Angular Velocity2", and no name.
    """
    return _merge_meanings(
        (key, f":{name}") for name in names if not all(map(str.isdigit, key := _name_key(split_tokens(name))))
    )


def _name_key(texts: Iterable[str]) -> tuple[str, ...]:
    """The key of a name in a table of meanings: its words, those of more than one letter in lower case."""
    return tuple(word if len(word) == 1 else word.casefold() for word in texts)


def header_words(header: str, names: Table) -> Iterator[tuple[str, Meanings]]:
    """Yield the words of a header, each with its possible meanings; an unknown word has an empty set.

    ``names`` are meanings of names, beside the known words. Numbers that belong to no name are left out, and words that
    change nothing.
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

# Units that are taken for one another, by the SI unit of what is measured, with their SI values.
MISTAKEN_UNITS: Final[Mapping[str, Mapping[str, float]]] = _UNITS_FILE["mistaken"]
Dimension = tuple[int, ...]  # exponents of m, kg, s and rad


@dataclass(frozen=True)
class Unit:
    """A unit: its value in SI units and its dimension, in which an angle counts."""

    factor: float
    dimension: Dimension

    def times(self, other: Unit, exponent: int) -> Unit:
        """The product of this unit and a power, the ``exponent``, of another one."""
        powers = zip(self.dimension, other.dimension, strict=True)
        return Unit(self.factor * other.factor**exponent, tuple(own + exponent * added for own, added in powers))

    def measures(self, dimension: Dimension) -> bool:
        """Whether it can be the unit of a quantity of this dimension; 1/s may be that of a speed of rotation."""
        turns = dimension[3] == 1 and dimension[2] < 0
        return self.dimension == dimension or (turns and self.dimension == (*dimension[:3], 0))


def _units_by_name() -> dict[str, Unit]:
    """The table of all known units, by each of their names, as written: those of linkage files and of the TOML file."""
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
LONGEST_UNIT: Final = 40  # characters of a unit


def _find_unit(name: str) -> Unit | None:
    """The unit of a name, as written, else, if it has more than one letter, in any case; None for an unknown one."""
    return UNITS_BY_NAME.get(name) or _UNITS_BY_LOWER_CASE.get(name.lower())


@lru_cache(maxsize=1024)
def parse_unit(text: str) -> Unit | None:
    """The unit that a text names, such as ``a*b/c^2``; None if it names none. "-" is the unit of plain numbers.

    There may be one solidus only, as two are ambiguous, and powers from -4 to 4.
    """
    text = text.strip()
    if not text or len(text) > LONGEST_UNIT:
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


class NotJudgedError(LinkproofError):
    """A column that means no signal, or may mean several; the message is the reason."""


@dataclass(frozen=True)
class Meaning:
    """The signal that a column means, its unit (None: the header states none), and the assumption made, "" for none.

    ``printed`` is the unit as the header has it.
    """

    signal: str
    unit: Unit | None
    printed: str
    assumption: str = ""


@dataclass(frozen=True)
class _Vocabulary:
    """The vocabulary of a signal: the meanings of its ``quantity``, and all that are true of it, ``words``.

    ``needs`` are sets of meanings, of each of which a header has to have one.
    """

    quantity: Meanings
    needs: tuple[Meanings, ...]
    words: Meanings


def splits(header: str, unit: str) -> Iterator[tuple[str, str]]:
    """Yield ways to divide a header into name and unit, the likeliest first; the unit is "" where there is none.

    The last way has no unit. ``unit`` is one that the file states apart from the header: if it is known, the header
    with it is the one way. The number of a repeated header is dropped.
    """
    header = REPEAT_NUMBER.sub("", header)
    if parse_unit(unit):
        yield header, unit
        return
    for form in WITH_UNIT:
        match = re.fullmatch(form, header)
        if match and parse_unit(match[2].strip("()[]")):
            yield match[1], match[2].strip("()[]")
    yield header, ""


@dataclass(frozen=True)
class HeaderParser:
    """Parser of headers: the signals of one linkage by words of several languages and by names of its parts."""

    linkage: Linkage

    @cached_property
    def signals(self) -> tuple[str, ...]:
        """Names of all signals, with the magnitudes of forces, without the time."""
        return signals.names_with_magnitudes(Mechanism(self.linkage))

    @cached_property
    def _names(self) -> Table:
        """The table of the meanings, ``:name``, of the words in the names of links, points and joints."""
        points = {point for link in self.linkage.links.values() for point in link.points} | {*self.linkage.ground}
        return name_meanings({*self.linkage.links, *points, *self.linkage.joint_names} - {GROUND})

    @cached_property
    def _vocabularies(self) -> dict[str, _Vocabulary]:
        """The vocabulary of the time and of each signal: the words by which a header may mean it.

        Transmission angles have none.
        """
        return {
            name: self._vocabulary_of(name)
            for name in (TIME, *self.signals)
            if not name.startswith("transmission_angle")
        }

    def _vocabulary_of(self, name: str) -> _Vocabulary:
        """The words by which a header may mean a signal or the time."""
        linkage, output = self.linkage, self.linkage.output
        kind, _, rest = name.partition(":")
        part, _, component = rest.rpartition(":")
        point, _, link = part.partition(":")
        quantity, axes = QUANTITIES[self.si_unit_name(name)], {component[-1:]} & {"x", "y"}
        drive = {"drive", f":{linkage.crank}"}
        others = {*AROUND} if "rad" in self.si_unit_name(name) or "N m" in self.si_unit_name(name) else {"linear"}
        owner = {f":{part}"}
        if kind in DRIVE:
            owner = drive if linkage.is_linear and kind != "Peq" else quantity | drive
            others |= {"length"} if kind == "phi" else set()
        elif kind in signals.OUTPUT and output is not None:
            owner = quantity | {"output"}
            slides = any(slider.point == output.point for slider in linkage.sliders)
            others |= {f":{output.link}", *([f":{output.point}"] if slides else [])}
        elif kind in ("point", "joint_force"):
            others |= {f":{n}" for n, body in linkage.links.items() if point in body.points and link in ("", n)}
            others |= {"path"} if kind == "point" else {"reaction"}
            owner |= {f":{point}"} if kind == "joint_force" else set()
        elif kind != "link":
            owner = {TIME: {TIME}, "Teq": {"kinetic"}, "Jeq": {"reduced"}}.get(kind, {"shaking"})
            others |= {"torque"} if kind == "Jeq" else {"reaction"}  # "moment of inertia"
        others |= {"magnitude"} if name.endswith(signals.MAGNITUDE) else set()
        needs = (frozenset(owner), *([frozenset(axes)] if axes else []))
        return _Vocabulary(frozenset(quantity), needs, frozenset().union(quantity, others, *needs))

    def unit(self, name: str) -> Unit:
        """SI unit of a signal or of "time"; raises KeyError for a name of another kind."""
        unit = parse_unit(self.si_unit_name(name))
        assert unit is not None, name
        return unit

    def si_unit_name(self, name: str) -> str:
        """The name of the SI unit of a signal or of "time"; raises KeyError for a name of another kind."""
        return "s" if name == TIME else signals.unit(name, self.linkage)

    def in_stated_unit(self, signal: str, column: Column) -> Meaning:
        """The meaning of a column as this signal, in its stated unit, or without a unit if that cannot measure it.

        The unit is the column's, else that of its header. Raises KeyError for an unknown signal.
        """
        for _, text in splits(column.header, column.unit):
            unit = parse_unit(text)
            if unit is not None and unit.measures(self.unit(signal).dimension):
                return Meaning(signal, unit, text)
        return Meaning(signal, None, "")

    def meaning(self, column: Column) -> Meaning:
        """The signal that a column means, by its header and unit; raises NotJudgedError with the reason.

        So it does for a header that is too long, has an unknown word, or fits no signal or several.
        """
        if len(column.header) > LONGEST:
            raise NotJudgedError(f"its name '{shortened(column.header)}' is longer than {LONGEST} characters")
        reasons = []
        for name, text in splits(column.header, column.unit):
            try:
                return self._meaning(name.strip(), parse_unit(text), text, column)
            except NotJudgedError as reason:
                reasons.append(reason)
        raise reasons[0]

    def _meaning(self, name: str, unit: Unit | None, printed: str, column: Column) -> Meaning:
        """The meaning of a column name with a ``unit``, as ``printed``; the name of a signal itself means that signal.

        Raises NotJudgedError with the reason if it is not clear, or for a unit that does not measure the signal.
        """
        if name in (TIME, *self.signals):
            if unit and not unit.measures(self.unit(name).dimension):
                raise NotJudgedError(f"'{printed}' is no unit of {name}")
            return Meaning(name, unit, printed)
        read = []
        for word, meanings in header_words(name, self._names):
            if not meanings:
                raise NotJudgedError(
                    f"'{shortened(word)}' in its name is no unit, link, point or joint, nor a known word"
                )
            read.append(meanings)
        fitting = self._fitting(read, unit)
        if not fitting:
            others = self._fitting(read, None) if unit else {}
            raise NotJudgedError(
                f"'{printed}' is no unit of {listed(others)}" if others else self._why_no_signal(read, unit)
            )
        names_stated = {name: sum(word.startswith(":") for word in stated) for name, stated in fitting.items()}
        best = [name for name in fitting if names_stated[name] == max(names_stated.values())]
        best = [name for name in best if ":" not in name] or best
        if len(best) > 1:
            raise NotJudgedError(f"it may be {listed(best)}: add its unit, or the name and component that it lacks")
        return Meaning(best[0], unit, printed, self._assumption(best[0], fitting[best[0]], column))

    def _fitting(self, read: Sequence[Meanings], unit: Unit | None) -> dict[str, Meanings]:
        """Signals whose words are all true and whose required words are present, each with the meanings that fit.

        ``read`` has the meanings of each word of the header; a ``unit``, if there is one, must fit, too. {} without
        any.
        """
        fitting = {}
        for name, true in self._vocabularies.items():
            if unit is not None and not unit.measures(self.unit(name).dimension):
                continue
            every = frozenset[str]().union(*(meanings & true.words for meanings in read))
            is_true = all(meanings & true.words and meanings & COMPONENTS <= true.words for meanings in read)
            is_place = name.startswith("point:") and name[-2] == ":"  # "D.x", without a word for it
            measured = every & EVERY_QUANTITY
            has_quantity = measured & true.quantity if measured else unit is not None or is_place
            if is_true and has_quantity and all(every & need for need in true.needs):
                fitting[name] = every
        return fitting

    def _why_no_signal(self, read: Sequence[Meanings], unit: Unit | None) -> str:
        """The reason, in words, why a header of known words means no signal, with the names of signals of that kind.

        ``read`` has the meanings of each of its words, ``unit`` is its unit, if it states one.
        """
        stated = frozenset[str]().union(*read)
        kind = [name for name, true in self._vocabularies.items() if stated & true.quantity]
        kind = kind or [name for name in self._vocabularies if unit and unit.measures(self.unit(name).dimension)]
        if "elsewhere" in stated or not kind:
            return "the closed form has no such quantity"
        return f"its name fits none of {listed(dict.fromkeys(name.rpartition(':')[0] or name for name in kind))}"

    def _assumption(self, signal: str, stated: Meanings, column: Column) -> str:
        """The assumption behind a column's signal, in words, "" for none.

        ``stated`` are the meanings that the header has. Raises NotJudgedError for a magnitude with negative values.
        """
        output = self.linkage.output
        if signal in DRIVE and not stated & {"drive", f":{self.linkage.crank}"}:
            return "its name has no link: taken as the crank's"
        if signal in signals.OUTPUT and output is not None:
            return f"taken as the output's, {output.point} along [{output.along[0]:.4g}, {output.along[1]:.4g}]"
        if signal.endswith(signals.MAGNITUDE):
            if np.any(column.values < 0.0):
                raise NotJudgedError("its name has no component, and it changes its sign, as no size of a force does")
            return "" if "magnitude" in stated else "its name has no component: taken as the size of the force"
        return ""
