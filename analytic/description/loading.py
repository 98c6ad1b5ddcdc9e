"""Reading a linkage file: TOML, then the variant, then validation, then SI units and the joints it implies."""

from __future__ import annotations

import re
import sys
import tomllib
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from functools import lru_cache
from pathlib import Path
from typing import Any, Final, TypeVar

from pydantic import BaseModel, ValidationError

from analytic.description.conversion import interpret
from analytic.description.diagnosis import Source, sentence, shown
from analytic.description.linkage import Linkage
from analytic.description.schema import Document
from analytic.errors import DescriptionError, LinkproofError, UnknownNameError, is_safe, listed, printable

CATALOGUE = Path(__file__).parents[1] / "catalogue"
LITERATURE = CATALOGUE / "literature"

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

    ``is_known``: whether it comes with the suite, so that its name alone identifies it on every machine.
    """

    name: str
    origin: str
    text: str
    is_known: bool = False

    def linkage(self, variant: str | None = None) -> Linkage:
        """The linkage in a variant, the file's own values if None; raises as ``load`` does."""
        return parse(self.text, self.name, self.origin, variant)


def catalogue() -> tuple[str, ...]:
    """Names of the sewing mechanisms that come with the suite, sorted; commands use them if no mechanism is named."""
    return _names_on_shelf(CATALOGUE)


def literature() -> tuple[str, ...]:
    """Names of the linkages of others that come with the suite, sorted: taken where they are named."""
    return _names_on_shelf(LITERATURE)


def _names_on_shelf(shelf: Path) -> tuple[str, ...]:
    return tuple(sorted(path.stem for path in shelf.glob("*.toml")))


def find(name: str) -> Path:
    """Path of a mechanism: a name known here, or the path of a user's own ``.toml`` file."""
    path = Path(name)
    ours = (*catalogue(), *literature())
    if not path.suffix and path.parent == Path():
        if name in ours:
            return (CATALOGUE if name in catalogue() else LITERATURE) / f"{name}.toml"
        if _fault(Path(f"{name}.toml")) is None:
            raise DescriptionError(
                f"unknown mechanism '{name}': did you mean the file '{name}.toml'? give its whole name"
            )
        if name and _fault(path) == "is a folder":
            raise DescriptionError(f"expected the path of a linkage file, got the folder '{name}'; name its files")
        raise UnknownNameError("mechanism", name, ours)
    known = f"the path of a linkage file, whose name ends in .toml, or one of the mechanisms {listed(ours)}"
    if path.suffix.lower() != ".toml":
        raise DescriptionError(f"expected {known}, got '{name}'; give one of them")
    fault = _fault(path)
    if fault:
        raise DescriptionError(f"expected {known}, got '{name}', which {fault}; check the path")
    return path


def _fault(path: Path) -> str | None:
    """Why a path cannot be read: it is a folder, or does not exist."""
    try:
        return None if path.is_file() else "is a folder" if path.is_dir() else "does not exist"
    except (OSError, ValueError):  # a name too long for the system, or with a null character
        return "does not exist"


def read(name: str | Path) -> LinkageFile:
    """Read a mechanism's file by catalogue name or path; raises DescriptionError or UnknownNameError."""
    path = find(str(name))
    try:
        text = path.read_text(encoding="utf-8-sig")
    except UnicodeDecodeError as error:
        line = error.object[: error.start].count(b"\n") + 1
        raise DescriptionError(
            f"{path}:{line}: expected a text file in UTF-8, got other bytes; save it as UTF-8"
        ) from error
    except OSError as error:
        raise DescriptionError(f"{path}: expected a readable file, got '{error.strerror}'; check it") from error
    is_known = path.parent in (CATALOGUE, LITERATURE)
    return LinkageFile(printable(path.stem), path.name if is_known else str(path), text, is_known)


def load(name: str | Path, variant: str | None = None) -> Linkage:
    """Read a mechanism by catalogue name or path, in the given variant (its first one if None).

    Raises DescriptionError, with file and line, or UnknownNameError.
    """
    return read(name).linkage(variant)


def in_variant(linkage: Linkage, variant: str) -> Linkage:
    """Another variant of a linkage's file, under the linkage's gravity."""
    return replace(parse(linkage.text, linkage.name, linkage.name, variant), gravity=linkage.gravity)


@lru_cache(maxsize=64)
def parse(text: str, name: str, origin: str, variant: str | None = None) -> Linkage:
    """Turn a file's text into a Linkage; ``origin`` names the file in messages."""
    raw, names, source = document(text, name, origin, variant)
    return interpret(validated(raw, source), name, names, source)


def document(
    text: str, name: str, origin: str, variant: str | None = None
) -> tuple[dict[str, Any], tuple[str, ...], Source]:
    """A file's text as nested dictionaries, the variant in its place, with the names of all variants.

    Raises as ``parse`` does, except for faults that only the whole linkage shows.
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
    """The file as nested dictionaries; raises DescriptionError with file and line."""
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
    return text.count("\n", 0, position) + 1


def _nesting_error(place: str) -> DescriptionError:
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
        ("Unclosed|Expected '\\]'", "", "a bracket that is not closed; close it in the same line"),
        ("initial character for a key part", r"\{[^}]*$", "a table in braces of several lines; write it in one line"),
    )
)
TWICE: Final = re.compile(r"Cannot (mutate immutable namespace|overwrite|declare)[^(]*(\('(?P<name>[^']*)',?\))?")
BARE_NAME: Final = re.compile(r"\s*\[*([^\]=\"'#]+)[\]=]")


def _syntax_error(fault: str, text: str, origin: str) -> str:
    """A syntax error of the TOML parser, its place first."""
    place = PLACE.search(fault)
    line, column = place.groups() if place and place[1] else (_line_number(text.rstrip(), len(text)), None)
    slip = _known_slip(fault, text.split("\n")[int(line) - 1])
    where = f" in column {column}" if column else " at the end of the file"
    return f"{origin}:{line}: not valid TOML: {slip or PLACE.sub('', fault) + where + '; correct it'}"


def _known_slip(fault: str, line: str) -> str:
    """A frequent slip in a line of a file and its remedy, in words; empty where the fault is no such slip."""
    if twice := TWICE.match(fault):
        return f"{repr(twice['name']) if twice['name'] else 'a key'} is written twice; leave one out or rename it"
    name = BARE_NAME.match(line)
    if name and not name[1].isascii():
        return f'a name with letters other than a to z; put it in quotes: "{name[1].strip().rpartition(".")[2]}"'
    return next((words for pattern, seen, words in SLIPS if pattern.search(fault) and seen.search(line)), "")


M = TypeVar("M", bound=BaseModel)


def read_document(path: Path, what: str, model: type[M]) -> M:
    """A TOML file other than a linkage's, as its ``model`` has it; ``what`` is expected at its path, in words.

    Raises LinkproofError with the path, or DescriptionError with file, line and key.
    """
    try:
        return parse_document(Source(printable(str(path)), path.read_text(encoding="utf-8-sig")), model)
    except OSError as error:
        raise LinkproofError(f"expected {what} at '{path}', got '{error.strerror}'; check it") from error
    except UnicodeDecodeError as error:
        raise LinkproofError(f"expected {what} in UTF-8 at '{path}', got other bytes; save it so") from error


def parse_document(source: Source, model: type[M]) -> M:
    """A text in TOML as its ``model`` has it; raises DescriptionError with file, line and key."""
    raw = tables(source.text, source.name) if source.text.strip() else {}
    check_characters(raw, source)
    try:
        return model.model_validate(raw)
    except ValidationError as error:
        raise DescriptionError(sentence(error, source, model)) from None


def check_characters(raw: Mapping[str, Any], source: Source) -> None:
    """Refuse control characters, which would reach terminals and pages from names and titles; texts may have lines."""
    for keys, text in _all_texts(raw, []):
        name = keys[-1]
        if not (text.isprintable() or all(is_safe(c) or c in "\n\t" for c in text)) or not all(map(is_safe, name)):
            raise DescriptionError(
                f"{source.at(keys)}: expected no control characters, got {shown(text or name)}; leave them out"
            )


def _all_texts(value: object, keys: list[str]) -> Iterator[tuple[list[str], str]]:
    """Every text of a document with the keys that lead to it, and every key, with no text."""
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
    """A variant's link of another name is a slip, unless it is a whole new link."""
    if isinstance(base, dict) and isinstance(over, dict):
        for link, table in over.items():
            if link not in base and not (isinstance(table, dict) and "mass" in table):
                where = source.at(["variants", variant, "links", link])
                raise DescriptionError(f"{where}: {UnknownNameError('link', link, base)}")


def _with_variant(base: Mapping[str, Any], over: Mapping[str, Any]) -> dict[str, Any]:
    """The base document with a variant's keys laid over it, table by table; lists are replaced whole."""
    result = dict(base)
    for key, value in over.items():
        mergeable = isinstance(value, dict) and isinstance(result.get(key), dict)
        result[key] = _with_variant(result[key], value) if mergeable else value
    return result


def validated(raw: Mapping[str, Any], source: Source) -> Document:
    """The document of nested dictionaries; raises DescriptionError."""
    try:
        return Document.model_validate(raw)
    except ValidationError as error:
        raise DescriptionError(sentence(error, source)) from None
