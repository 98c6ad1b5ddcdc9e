"""A fault of a linkage file as one sentence: where it is, what was expected, what was got, what to do."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

from pydantic import BaseModel, ValidationError
from pydantic_core import ErrorDetails

from analytic.description.schema import EXPECTED, PLAIN, Document
from analytic.errors import UnknownNameError

LONGEST = 60  # characters of a wrong value worth repeating
WITHOUT = " is missing"


@dataclass(frozen=True)
class Source:
    """A linkage file as it was read: its name for messages, its text, and the variant laid over it, if any."""

    name: str
    text: str = ""
    variant: str | None = None

    def at(self, keys: Sequence[str]) -> str:
        """The file, the line if it is found, and the key, to begin a message with."""
        return f"{self.name}{line_of(self.text, keys, self.variant)}: {readable(keys)}"

    def place(self, message: str) -> str:
        """A message that begins with a key (``links.rod.mass: ...``), put behind the file and the line."""
        path, colon, rest = message.partition(": ")
        missing = WITHOUT if path.endswith(WITHOUT) else ""
        return f"{self.at(path.removesuffix(WITHOUT).split('.'))}{missing}{colon}{rest}"


def readable(keys: Sequence[str]) -> str:
    """A path of keys for a reader, who counts from 1: ``forces #2.force``."""
    return ".".join(f"#{int(key) + 1}" if key.isdigit() else key for key in keys).replace(".#", " #")


def sentence(error: ValidationError, source: Source) -> str:
    """The first fault of a document."""
    fault = _telling(error.errors(include_url=False, include_context=False))
    keys = _keys(fault)
    if fault["type"] == "extra_forbidden":
        return f"{source.at(keys)}: {UnknownNameError('key', keys[-1], _known_keys(keys[:-1]))}"
    if fault["type"] == "missing" and not keys[-1].isdigit():
        return f"{source.at(keys)}{WITHOUT}: expected {_expected(fault, keys)}; add it"
    return f"{source.at(keys)}: expected {_expected(fault, keys)}, got {shown(fault['input'])}; correct it"


def _telling(faults: Sequence[ErrorDetails]) -> ErrorDetails:
    """Of the first value at fault, which may fail each of several forms in its own way, the fault that lies deepest.

    Where a key is missing beside an unknown one, that one is its misspelling.
    """
    first = _keys(faults[0])
    deepest = max((f for f in faults if _keys(f)[: len(first)] == first), key=lambda fault: len(_keys(fault)))
    beside = [f for f in faults if f["type"] == "extra_forbidden" and _keys(f)[:-1] == _keys(deepest)[:-1]]
    return beside[0] if deepest["type"] == "missing" and beside else deepest


def _keys(fault: ErrorDetails) -> list[str]:
    """Keys from the file's root to the fault, without the validator's names for the forms a value can take."""
    forms = ("tuple[", "list[", "constrained-", "float")
    return [str(key) for key in fault["loc"] if key != "Polar" and not str(key).startswith(forms)]


def _expected(fault: ErrorDetails, keys: Sequence[str]) -> str:
    """What belongs there: by the innermost key there is a phrase for, else by the kind of value."""
    names = [key for key in keys if not key.isdigit()]
    for depth in range(len(names), 0, -1):
        inside = ".*" if depth < len(names) else ""
        for key in (f"{names[0]}.{names[depth - 1]}{inside}", f"{names[depth - 1]}{inside}"):
            if key in EXPECTED:
                return EXPECTED[key]
    return PLAIN.get(fault["type"], "a value of another kind")


def shown(value: object) -> str:
    """A value as the file has it, cut short."""
    written = str(value).lower() if isinstance(value, bool) else repr(value) if isinstance(value, str) else str(value)
    return written if len(written) <= LONGEST else f"{written[:LONGEST]}..."


def _known_keys(parents: Sequence[str]) -> list[str]:
    """Keys that are allowed where an unknown one was found."""
    model: type[BaseModel] | None = Document
    for key in parents:
        if model is not None and key in model.model_fields:
            model = next(_tables_in(model.model_fields[key].annotation), None)
    return sorted(model.model_fields) if model is not None else []


def _tables_in(annotation: Any) -> Iterator[type[BaseModel]]:  # noqa: ANN401 - an annotation may be anything
    """The table models inside an annotation such as ``dict[str, LinkTable]`` or ``SketchTable | None``."""
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        yield annotation
    for argument in getattr(annotation, "__args__", ()):
        yield from _tables_in(argument)


@dataclass(frozen=True)
class HeaderSection:
    """The lines under one header of a TOML file; ``number`` counts the [[headers]] of one name."""

    keys: list[str]
    variant: str | None
    number: int
    start: int
    lines: list[str]


def line_of(text: str, keys: Sequence[str], variant: str | None = None) -> str:
    """Where a key stands in the file, as ", line 7"; "" if it is not found.

    The section whose header leads deepest towards the key is searched first, the variant's before the file's own.
    """
    names = [key for key in keys if not key.isdigit()]
    wanted = next((int(key) for key in keys if key.isdigit()), 0)
    found = [
        section
        for section in _sections(text)
        if section.variant in (None, variant)
        and section.keys == names[: len(section.keys)]
        and section.number in (0, wanted)
    ]
    for section in sorted(found, key=lambda s: (s.variant is None, -len(s.keys), -s.number)):
        line = _line_in(section, names[len(section.keys) :])
        if line is None and section.keys and section.variant is None:
            line = section.start
        if line is not None:
            return f", line {line + 1}"
    return ""


def _line_in(section: HeaderSection, names: Sequence[str]) -> int | None:
    """The line of a section that writes the last of these keys, each looked for from where the one before it stands."""
    found, at = None, 0
    for name in names:
        at = next(
            (n for n in range(at, len(section.lines)) if name in _keys_written(section.lines[n])), len(section.lines)
        )
        if at < len(section.lines):
            found = section.start + at
    return found


def _sections(text: str) -> list[HeaderSection]:
    """The file cut at its headers; what stands before the first has no keys."""
    found = [HeaderSection([], None, 0, 0, [])]
    for start, line in enumerate(text.splitlines()):
        header = line.split("#", maxsplit=1)[0].strip()
        if header.startswith("[") and header.endswith("]") and "=" not in header:
            keys = [key.strip().strip("\"'") for key in header.strip("[]").split(".")]
            variant, keys = (keys[1], keys[2:]) if keys[0] == "variants" and len(keys) > 1 else (None, keys)
            number = sum(1 for section in found if section.keys == keys) if header.startswith("[[") else 0
            found.append(HeaderSection(keys, variant, number, start, []))
        found[-1].lines.append(line)
    return found


def _keys_written(line: str) -> list[str]:
    """The keys of a line: words that an equals sign follows."""
    for mark in "\"'{},":
        line = line.replace(mark, " ")
    parts = line.split("#", maxsplit=1)[0].split("=")[:-1]
    return [key for part in parts if part.split() for key in part.split()[-1].split(".")]
