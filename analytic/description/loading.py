"""Reading a linkage file: TOML, then the variant, then validation, then SI units and the joints it implies."""

from __future__ import annotations

import math
import os
import re
import sys
import tomllib
from collections.abc import Iterator, Mapping, MutableMapping, MutableSequence
from dataclasses import dataclass, replace
from difflib import get_close_matches
from functools import lru_cache
from pathlib import Path
from typing import Any, Final, TypeVar

from pydantic import BaseModel, ValidationError

from analytic.description.changes import named_numbers, with_numbers
from analytic.description.changes import numbers as numbers_of
from analytic.description.conversion import interpret
from analytic.description.diagnosis import Source, sentence, shown
from analytic.description.linkage import LOADS, Linkage
from analytic.description.lookup import Reader, reader_of
from analytic.description.schema import Document
from analytic.description.walk import Keys
from analytic.description.written import in_unit
from analytic.errors import DescriptionError, LinkproofError, UnknownNameError, is_safe, listed, printable, shortened
from analytic.files import file_fault, read_file

CATALOGUE = Path(__file__).parents[1] / "catalogue"
GALLERY, LITERATURE = CATALOGUE / "gallery", CATALOGUE / "literature"
SHELVES: Final = (CATALOGUE, GALLERY, LITERATURE)

BYTE_ORDER_MARK: Final = "\ufeff"
MOST_DIGITS: Final = re.compile(rf"(?:\d_?){{{sys.get_int_max_str_digits() + 1}}}")
# A key of this many parts is no linkage's, and takes the TOML parser a time that grows with their square.
DEEPEST: Final = re.compile(
    r"^[ \t\[]*(?:[\w-]+|\"[^\"\n]*\"|'[^'\n]*')(?:\s*\.\s*(?:[\w-]+|\"[^\"\n]*\"|'[^'\n]*')){99}", re.MULTILINE
)
PLACE: Final = re.compile(r" \(at (?:line (\d+), column (\d+)|end of document)\)$")


@dataclass(frozen=True)
class LinkageFile:
    """A linkage file as it was read: the mechanism's name, the file's in messages, its text.

    ``is_known``: whether it comes with the suite, so that its name alone identifies it on every machine. ``text`` has
    Unix line ends.
    """

    name: str
    origin: str
    text: str
    is_known: bool = False

    def linkage(self, variant: str | None = None) -> Linkage:
        """The linkage in a variant, by default with the file's own values.

        Raises DescriptionError, with file and line, for a wrong file, UnknownNameError for an unknown variant.
        """
        return parse(self.text, self.name, self.origin, variant)


def catalogue() -> tuple[str, ...]:
    """Names, sorted, of the sewing mechanisms that come with the suite; commands use them if none is named."""
    return _names_on_shelf(CATALOGUE)


def gallery() -> tuple[str, ...]:
    """Names, sorted, of the classic linkages that come with the suite as a start; commands use them if named."""
    return _names_on_shelf(GALLERY)


def literature() -> tuple[str, ...]:
    """Names, sorted, of the published linkages that come with the suite; commands use them only where named."""
    return _names_on_shelf(LITERATURE)


def known_names() -> tuple[str, ...]:
    """Names of all linkages that come with the suite: the catalogue's, the gallery's, the literature's, each sorted."""
    return (*catalogue(), *gallery(), *literature())


def _names_on_shelf(shelf: Path) -> tuple[str, ...]:
    """Names, sorted, of the linkage files in a folder of the package, without ``.toml``."""
    return tuple(sorted(path.stem for path in shelf.glob("*.toml")))


def find(name: str) -> Path:
    """Path of a mechanism's file by its name here or its own ``.toml`` path.

    Raises UnknownNameError for a name without suffix that nothing here has, DescriptionError for a path that does not
    end in .toml or that no file can be read from, and for the name of a folder, or of a .toml file without its suffix.
    """
    path = Path(name)
    ours = known_names()
    if not path.suffix and path.parent == Path():
        if name in ours:
            return next(shelf / f"{name}.toml" for shelf in SHELVES if (shelf / f"{name}.toml").exists())
        if file_fault(Path(f"{name}.toml")) is None:
            raise DescriptionError(
                f"unknown mechanism '{name}': did you mean the file '{name}.toml'? give its whole name"
            )
        if name and os.path.isdir(name):
            raise DescriptionError(f"expected the path of a linkage file, got the folder '{name}'; name its files")
        raise UnknownNameError("mechanism", name, ours)
    known = f"the path of a linkage file, whose name ends in .toml, or one of the mechanisms {listed(ours)}"
    if path.suffix.lower() != ".toml":
        raise DescriptionError(f"expected {known}, got '{name}'; give one of them")
    fault = file_fault(path)
    if fault:
        near = get_close_matches(name, [str(file) for file in path.parent.glob("*.toml")], n=1)
        hint = f"; did you mean '{near[0]}'?" if near else ""
        raise DescriptionError(f"expected {known}, got '{name}', which {fault}{hint}")
    return path


def read(name: str | Path) -> LinkageFile:
    """Read a mechanism's file by catalogue name or path; raises DescriptionError or UnknownNameError.

    A byte-order mark is dropped, and Windows line ends become a line feed. UnknownNameError is for an unknown name,
    DescriptionError for a path without a readable .toml file and, with file and line, for what is not UTF-8.
    """
    path = find(str(name))
    try:
        text = read_file(path, "a linkage file").decode("utf-8-sig").replace("\r\n", "\n")  # one text everywhere
    except UnicodeDecodeError as error:
        line = error.object[: error.start].count(b"\n") + 1
        raise DescriptionError(
            f"{path}:{line}: expected a text file in UTF-8, got other bytes; save it as UTF-8"
        ) from error
    is_known = path.parent in SHELVES
    return LinkageFile(printable(path.stem), path.name if is_known else str(path), text, is_known)


def load(name: str | Path, variant: str | None = None) -> Linkage:
    """Read a mechanism by catalogue name or path, in the given variant (its first one if None).

    Raises DescriptionError, with file and line, for a wrong file, or UnknownNameError for an unknown mechanism or
    variant.

    >>> linkproof.load("juki-mf7923d").links["crank"].mass  # kg
    0.64
    """
    return read(name).linkage(variant)


def in_variant(linkage: Linkage, variant: str) -> Linkage:
    """The linkage of another variant of the same file, with the gravity of the given one.

    Raises UnknownNameError for a variant that the file lacks, DescriptionError for one that is wrong.
    """
    return replace(parse(linkage.text, linkage.name, linkage.name, variant), gravity=linkage.gravity)


@lru_cache(maxsize=64)
def parse(text: str, name: str, origin: str, variant: str | None = None) -> Linkage:
    """The Linkage of a file's text in a variant; ``name`` is its own, ``origin`` names the file in messages.

    None is the file's own values. Raises DescriptionError, with file and line, or UnknownNameError for an unknown
    variant. The last 64 results are kept, and the same object is returned for the same arguments.
    """
    raw, names, source = document(text, name, origin, variant)
    return interpret(validated(raw, source), name, names, source)


def document(
    text: str, name: str, origin: str, variant: str | None = None
) -> tuple[dict[str, Any], tuple[str, ...], Source]:
    """A file's text as nested dictionaries, a variant laid over it; with the names of all variants, and the source.

    ``name`` is the mechanism's, ``origin`` the file's, both for messages; None is the variant of the file itself, whose
    name comes first, the others sorted. The dictionaries have no key ``variants``. Raises DescriptionError, with file
    and line, for a text that is no TOML, control characters and wrong tables of variants, UnknownNameError for an
    unknown variant; other keys are not checked.
    """
    text = text.removeprefix(BYTE_ORDER_MARK)
    raw = tables(text, origin)
    source = Source(origin, text)
    check_characters(raw, source)
    overlays = raw.pop("variants", {})
    base_name = str(raw.get("variant", "base"))
    if not isinstance(overlays, dict) or not all(isinstance(part, dict) for part in overlays.values()):
        raise DescriptionError(
            source.place(f"variants: expected tables [variants.NAME], got {shown(overlays)}; write them so")
        )
    if base_name in overlays:
        raise DescriptionError(
            f"{source.at(['variants', base_name])}: expected another name than '{base_name}', which is the file itself "
            "(key variant); rename one of them"
        )
    names = (base_name, *sorted(overlays))
    chosen = base_name if variant is None else variant
    if chosen not in names:
        raise UnknownNameError(f"variant of '{name}'", chosen, names)
    if chosen != base_name:
        overlay = overlays[chosen]
        _check_links(raw.get("links"), overlay.get("links"), source, chosen)
        raw = _with_variant(raw, overlay)
        raw["variant"] = chosen
        source = replace(source, variant=chosen)
    return raw, names, source


def tables(text: str, origin: str) -> dict[str, Any]:
    """A TOML text as nested dictionaries; raises DescriptionError, with file and line, for a wrong or an empty one.

    Wrong are also numbers of too many digits and tables nested too deeply. ``origin`` is the file's name in messages.
    """
    if not text.strip():
        raise DescriptionError(
            f"{origin}:1: expected a linkage description, got an empty file; start from a catalogue file"
        )
    deepest = DEEPEST.search(text)
    if deepest:
        raise _nesting_error(f"{origin}:{_line_number(text, deepest.start())}")
    try:
        return tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        raise DescriptionError(_syntax_error(str(error), text, origin)) from error
    except ValueError as error:
        digits = MOST_DIGITS.search(text)
        line = _line_number(text, digits.start()) if digits else 1
        raise DescriptionError(f"{origin}:{line}: expected a number, got one of too many digits; correct it") from error
    except RecursionError:
        raise _nesting_error(f"{origin}:1") from None


def _line_number(text: str, position: int) -> int:
    """The number of the line, from 1, that holds a position of the text, an index of a character."""
    return text.count("\n", 0, position) + 1


def _nesting_error(place: str) -> DescriptionError:
    """The error for a file whose tables are nested too deeply to be read; ``place`` begins its message."""
    return DescriptionError(f"{place}: expected tables and short lists, got very deep nesting; flatten it")


# Usual slips: what the parser says, what the line has, and what to do about it.
SLIPS: Final = tuple(
    (re.compile(fault), re.compile(line), words)
    for fault, line, words in (
        ("", r"=\s*[-+]?\d+,\d+\s*(#.*)?$", "a number with a decimal comma; write a dot, such as 0.3"),
        ("Invalid value", "[“”„‘’«»]", 'quotation marks that are not straight; write "'),
        ("Invalid value", r"=\s*(?i:true|false)\b", "true and false have small letters; correct it"),
        ("Invalid value", r"[=\[,]\s*[^\W\d]", 'a word without quotes; write it as "word"'),
        ("Invalid value", r"=\s*(#.*)?$", "a key without a value; add the value or leave the key out"),
        ("Expected '='", "", "a key without = behind it; write key = value"),
        ("Expected newline", "", "more than a value behind =; units stand in [units], and a comment begins with #"),
        ("Illegal character '\\\\n'|Unterminated string", "", 'a text whose end is missing; close it with "'),
        ("Unclosed|Expected '\\]'", r"\[[^\]#]*[\d.]\s+[-+.\d]", "numbers without a comma between them; write [x, y]"),
        ("Unclosed", r"[\]}\"\d]\s+\w+\s*=", "entries without a comma between them; write { A = [0, 0], B = [1, 0] }"),
        ("Unclosed|Expected '\\]'", "", "a bracket that is not closed; close it in the same line"),
        ("initial character for a key part", r"\{[^}]*$", "a table in braces of several lines; write it in one line"),
    )
)
TWICE: Final = re.compile(r"Cannot (mutate immutable namespace|overwrite|declare)[^(]*(\('(?P<name>[^']*)',?\))?")
BARE_NAME: Final = re.compile(r"\s*\[*([^\]=\"'#]+)[\]=]")


def _syntax_error(fault: str, text: str, origin: str) -> str:
    """The message for a TOML syntax error, Python's ``fault``: the file ``origin``, line, the fault and its remedy.

    ``text`` is that of the file.
    """
    place = PLACE.search(fault)
    line, column = place.groups() if place and place[1] else (_line_number(text.rstrip(), len(text)), None)
    slip = _known_slip(fault, text.split("\n")[int(line) - 1])
    where = f" in column {column}" if column else " at the end of the file"
    return f"{origin}:{line}: not valid TOML: {slip or PLACE.sub('', fault) + where + '; correct it'}"


def _known_slip(fault: str, line: str) -> str:
    """A frequent slip in a line of a file and its remedy, in words; empty where the fault is no such slip.

    ``fault`` is the message of Python's TOML parser.
    """
    if twice := TWICE.match(fault):
        return f"{repr(twice['name']) if twice['name'] else 'a key'} is written twice; leave one out or rename it"
    name = BARE_NAME.match(line)
    if name and not name[1].isascii():
        return f'a name with letters other than a to z; put it in quotes: "{name[1].strip().rpartition(".")[2]}"'
    return next((words for pattern, seen, words in SLIPS if pattern.search(fault) and seen.search(line)), "")


M = TypeVar("M", bound=BaseModel)


def read_document(path: Path, what: str, model: type[M]) -> M:
    """A TOML file as an object of ``model``; ``what`` it should be is named in words for the error.

    Raises LinkproofError with the path for a file that cannot be read or is not UTF-8, or DescriptionError with file,
    line and key for a wrong content. An empty file stands for no keys.
    """
    return parse_document(read_source(path, what), model)


def read_source(path: Path, what: str) -> Source:
    """A TOML file's name and text, not yet parsed; ``what`` is expected there, in words.

    Raises LinkproofError, with the path, for a file that cannot be read or is not UTF-8.
    """
    try:
        return Source(printable(str(path)), read_file(path, what).decode("utf-8-sig"))
    except UnicodeDecodeError as error:
        raise LinkproofError(f"expected {what} in UTF-8 at '{path}', got other bytes; save it so") from error


def parse_document(source: Source, model: type[M]) -> M:
    """A TOML text, checked, as an object of ``model``; raises DescriptionError with file, line and key.

    An empty text stands for no keys.
    """
    raw = tables(source.text, source.name) if source.text.strip() else {}
    check_characters(raw, source)
    try:
        return model.model_validate(raw)
    except ValidationError as error:
        raise DescriptionError(sentence(error, source, model)) from None


def check_characters(raw: Mapping[str, Any], source: Source) -> None:
    """Raise DescriptionError for control characters in keys and texts of a file; texts may have tabs and line ends.

    They would reach terminals. ``raw`` are the nested dictionaries of the file.
    """
    for keys, text in _all_texts(raw, []):
        name = keys[-1]
        if not (text.isprintable() or all(is_safe(c) or c in "\n\t" for c in text)) or not all(map(is_safe, name)):
            raise DescriptionError(
                f"{source.at(keys)}: expected no control characters, got {shown(text or name)}; leave them out"
            )


def _all_texts(value: object, keys: list[str]) -> Iterator[tuple[list[str], str]]:
    """Yield (keys, text) for every text in nested tables and lists, and (keys, "") for every key, depth first.

    ``keys`` lead to ``value``; an index in a list is one of them, as text, from "0".
    """
    if isinstance(value, dict):
        for key, inner in value.items():
            yield [*keys, key], ""
            yield from _all_texts(inner, [*keys, key])
    elif isinstance(value, list):
        for number, inner in enumerate(value):
            yield from _all_texts(inner, [*keys, str(number)])
    elif isinstance(value, str):
        yield keys, value


def _check_links(base: object, over: object, source: Source, variant: str) -> None:
    """Raise DescriptionError for a link of ``over`` that the ``base`` lacks, unless it has a mass.

    ``over`` is the table [links] of the ``variant`` of this name, ``base`` the file's; if one of them is no table,
    nothing is checked.
    """
    if isinstance(base, dict) and isinstance(over, dict):
        for link, table in over.items():
            if link not in base and not (isinstance(table, dict) and "mass" in table):
                where = source.at(["variants", variant, "links", link])
                raise DescriptionError(f"{where}: {UnknownNameError('link', link, base)}")


def _with_variant(base: Mapping[str, Any], over: Mapping[str, Any]) -> dict[str, Any]:
    """A copy of the base document with a variant's keys laid over it, table by table; lists are replaced whole."""
    result = dict(base)
    for key, value in over.items():
        mergeable = isinstance(value, dict) and isinstance(result.get(key), dict)
        result[key] = _with_variant(result[key], value) if mergeable else value
    return result


def validated(raw: Mapping[str, Any], source: Source) -> Document:
    """The nested dictionaries, checked, as a Document; raises DescriptionError with file, line and key."""
    try:
        return Document.model_validate(raw)
    except ValidationError as error:
        raise DescriptionError(sentence(error, source)) from None


# A linkage file written anew with other numbers: another design of the linkage, in the units of its file.
#
# The text stays as it was written, comments included, wherever nothing changes. The file's own values become those of
# the variant chosen, and published figures and variants, which belong to the original design, are left out.


DESIGN: Final = "design"
MARK: Final = "# Made by linkproof from "
NOT_OF_DESIGNS: Final = ("published",)
ROUNDING: Final = 4 * 2.0**-52  # relative; what a number may lose on its way through the file's units and unit vectors
MOST_NAMED: Final = 12  # changed numbers in the first line


def with_variant_written(text: str, name: str, variant: str | None) -> str:
    """The text of a linkage file with a variant's numbers, and all defaults, written as its own values.

    ``name`` is the mechanism's; None is the file's own variant. Printed figures, which belong to the file as it was,
    are left out; directions stay as they are written. Raises DescriptionError for a wrong file, UnknownNameError for an
    unknown variant, LinkproofError where a number cannot be written in the units of the file.
    """
    linkage = parse(text, name, name, variant)
    raw, _, source = document(text, name, name, variant)
    raw = {key: part for key, part in raw.items() if key not in NOT_OF_DESIGNS}
    file = WrittenNumbers(raw, reader_of(validated(raw, source), source), linkage)
    for number, value in numbers_of(linkage).items():
        if not math.isfinite(value) or ".along." in number:
            continue
        file.set(number, value)
    result = _toml_text(text, raw)
    _check_written_numbers(result, name, linkage)
    return result


def written_numbers(text: str, name: str, variant: str | None) -> WrittenNumbers:
    """The places and units of all numbers of a linkage file in a variant, for setting them.

    ``name`` is the mechanism's; None is the file's own variant. Raises DescriptionError for a wrong file,
    UnknownNameError for an unknown variant.
    """
    raw, _, source = document(text, name, name, variant)
    return WrittenNumbers(raw, reader_of(validated(raw, source), source), parse(text, name, name, variant))


def rewritten(
    text: str, name: str, variant: str | None, numbers: Mapping[str, float], *, new_variant: str = DESIGN
) -> str:
    """The text of a linkage file whose own values are those of a variant, with other numbers in place.

    Args:
        text: The file as it is.
        name: Its mechanism's name, for messages and for the first line of the new file, which says how it was made.
        variant: The variant to begin with, the file's own values if None.
        numbers: SI values by name, as in ``analytic.description.changes``; those not named stay. A component of a
            direction takes the other one with it, as it does in ``changed``.
        new_variant: What the new file calls its values, in the key ``variant``.

    Raises:
        UnknownNameError: For a number or a variant that the file does not have.
        DescriptionError: For a text that is no linkage file, or numbers that describe no linkage.
        LinkproofError: For a number that is not finite, a direction of no length, and one that cannot be written in the
            units of the file.

    """
    old = parse(text, name, name, variant)
    known = numbers_of(old)
    for number, value in numbers.items():
        if number not in known:
            raise UnknownNameError(f"parameter of '{name}'", number, known)
        if not math.isfinite(value):
            raise LinkproofError(f"{number}: expected a finite number, got {value:g}; correct it")
    changed = {number: value for number, value in numbers.items() if value != known[number]}
    try:
        target = with_numbers(old, changed)
    except ZeroDivisionError:
        raise LinkproofError(
            f"{', '.join(key for key in changed if '.along.' in key)}: expected a direction, got [0, 0]; give another"
        ) from None
    raw, _, source = document(text, name, name, variant)
    raw = {"variant": new_variant} | {key: part for key, part in raw.items() if key not in NOT_OF_DESIGNS}
    raw["variant"] = new_variant
    file = WrittenNumbers(raw, reader_of(validated(raw, source), source), old)
    sentences = [file.set(number, value) for number, value in changed.items()]
    if target.output and any(".along." in number for number in changed):
        raw["output"]["along"] = list(target.output.along)  # where it followed a guide, S stays what it was
    result = f"{_first_line(name, old.variant, sentences)}\n{_toml_text(text, raw)}"
    _check_written_numbers(result, name, target)
    return result


class WrittenNumbers:
    """A linkage file as nested dictionaries, ``raw``, in which numbers are set by name.

    ``places`` has the keys and indices of each by name; ``kinds`` and ``values``, SI, are by place.
    """

    def __init__(self, raw: dict[str, Any], reader: Reader, linkage: Linkage) -> None:
        """Find every number of the linkage in ``raw``, the file as nested tables; ``reader`` knows the file's units."""
        self.raw = raw
        self.unit, self.units = reader.unit, reader.units
        numbers = named_numbers(linkage)
        self.places = {name: _place_in_file(number.path, linkage, reader) for name, number in numbers.items()}
        self.kinds = {self.places[name]: number.kind for name, number in numbers.items()}
        self.values = {self.places[name]: number.value for name, number in numbers.items()}

    def set(self, number: str, value: float) -> str:
        """Put an SI value in its place in ``raw``, in the file's unit; returns "name = number unit" as text.

        A pair that is left out there, given by radius and angle, or a direction is written anew as [x, y]. Raises
        KeyError for a name that the linkage does not have.
        """
        place = self.places[number]
        self.values[place] = value
        table: Any = self.raw
        for depth, key in enumerate(place[:-1], start=1):
            if isinstance(key, str):
                is_pair = place[depth:] in ((0,), (1,)) and place[0] not in LOADS
                if is_pair and (not isinstance(table.get(key), list) or self.kinds[place] == "direction"):
                    # left out, given by radius and angle, or of any length
                    table[key] = [self._written((*place[:depth], component)) for component in (0, 1)]
                table.setdefault(key, {})
            table = table[key]
        table[place[-1]] = self._written(place)
        return f"{number} = {table[place[-1]]!r} {self.units.get(self.kinds[place], '')}".rstrip()

    def _written(self, place: Keys) -> float:
        """The value at a place in the file's unit, so chosen that it gives back the SI value."""
        return in_unit(self.values[place], self.unit(self.kinds[place]).size)


def _place_in_file(path: Keys, linkage: Linkage, reader: Reader) -> Keys:
    """The keys and indices of a number in the file, by its path in the linkage.

    As ("sketch", "points", "B", 0) for ("sketch", "B", 0).
    """
    match path:
        case ("sketch", *rest):
            return ("sketch", "points", *rest)
        case ("sliders", int(index), _, *rest):
            return ("links", linkage.sliders[index].link, "slides", *rest)
        case ("slots", int(index), _, *rest):
            return ("slots", linkage.slots[index].number, *rest)
        case ("forces" | "torques" as kind, int(index), key, row, component):
            number = getattr(linkage, kind)[index].number
            written = getattr(getattr(reader.document, kind)[number], str(key))
            rows = (row,) if isinstance(written, list) else ()
            return (kind, number, key, *rows, *((component,) if kind == "forces" else ()))
    return path


def _first_line(name: str, variant: str, sentences: list[str]) -> str:
    """The comment that begins the new file: from which file and variant it was made, and which numbers were changed.

    ``sentences`` are "name = number unit"; those beyond the first MOST_NAMED are only counted. It has no line end.
    """
    more = [f"{len(sentences) - MOST_NAMED} more numbers"] if len(sentences) > MOST_NAMED else []
    numbers = ", ".join([*sentences[:MOST_NAMED], *more]) or "no number changed"
    return f"{MARK}{printable(name)}, variant {shortened(printable(variant))}: {printable(numbers)}"


def _toml_text(text: str, raw: Mapping[str, Any]) -> str:
    """The text of a TOML file with the values ``raw``, comments kept; made anew, without comments, where that fails.

    linkproof's first line and a byte-order mark are dropped.
    """
    import tomlkit  # noqa: PLC0415 - only what writes a file pays for it
    from tomlkit.exceptions import TOMLKitError  # noqa: PLC0415

    text = text.removeprefix(BYTE_ORDER_MARK)
    if text.startswith(MARK):
        text = text.partition("\n")[2]
    try:
        document = tomlkit.parse(text)
        _update(document, raw)
        result = f"{tomlkit.dumps(document).rstrip()}\n"
        if tomllib.loads(result) == raw:
            return result
    except (TOMLKitError, tomllib.TOMLDecodeError):
        pass
    return tomlkit.dumps(raw)


def _update(old: Any, new: Any) -> None:  # noqa: ANN401 - TOML values
    """Make a parsed file's table or list equal ``new``, in place, by what differs alone, so that comments stay.

    Both are tables, or lists of one length.
    """
    if isinstance(old, MutableMapping):
        for key in [key for key in old if key not in new]:
            del old[key]
    pairs = new.items() if isinstance(old, MutableMapping) else enumerate(new)
    for key, value in pairs:
        inner = old.get(key) if isinstance(old, MutableMapping) else old[key]
        if inner == value:
            continue
        if _is_alike(inner, value):
            _update(inner, value)
        else:
            old[key] = value


def _is_alike(old: object, new: object) -> bool:
    """Whether both values are tables, or lists of one length, so that one can be updated to the other."""
    if isinstance(old, MutableSequence):
        return isinstance(new, list) and len(old) == len(new)
    return isinstance(old, MutableMapping) and isinstance(new, dict)


def _check_written_numbers(result: str, name: str, target: Linkage) -> None:
    """Raise LinkproofError where a number of the new file's text misses that of ``target`` by more than rounding.

    So too where one of the two lacks it; DescriptionError for a text that is no linkage file. ``name`` is the
    mechanism's.
    """
    new = parse(result, name, f"{name} with other numbers")
    meant, got = numbers_of(target), numbers_of(new)
    for number in [*meant, *got]:
        if number not in got or number not in meant or not _is_near(number, got, meant):
            raise LinkproofError(
                f"{number}: expected a number that can be written in the units of '{name}', got "
                f"{meant.get(number, math.nan)!r}; correct it"
            )


def _is_near(number: str, got: Mapping[str, float], meant: Mapping[str, float]) -> bool:
    """Whether the ``number`` of the new file equals the intended one, to the rounding of the file's units.

    ``got`` and ``meant`` are the SI values of the new file and those intended, by name.
    """
    size = 1.0 if ".along." in number else max(abs(meant[number]), math.ulp(0.0))
    return abs(got[number] - meant[number]) <= ROUNDING * size
