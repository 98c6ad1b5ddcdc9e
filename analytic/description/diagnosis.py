"""A fault of a linkage file as one sentence: its place, the expected and the actual value, the remedy."""

from __future__ import annotations

import tomllib
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

from pydantic import BaseModel, ValidationError
from pydantic_core import ErrorDetails

from analytic.description.schema import Document
from analytic.description.units import UNITS
from analytic.errors import DescriptionError, UnknownNameError, shortened

_PHRASES_FILE: Final = Path(__file__).with_name("expected.toml")
_PHRASES: Final = tomllib.loads(_PHRASES_FILE.read_text(encoding="utf-8"))
EXPECTED: Final[Mapping[str, str]] = _PHRASES["by_key"] | {
    f"units.{kind}": f"the name of a unit of {kind.replace('_', ' ')} in quotes: {', '.join(units)}"
    for kind, units in UNITS.items()
}
LONGEST_NUMBER: Final = 10_000  # bits of an integer that Python still writes out
WITHOUT = " is missing"


@dataclass(frozen=True)
class Source:
    """A linkage file as it was read: its name for messages, its text, and the variant laid over it, if any."""

    name: str
    text: str = ""
    variant: str | None = None

    def fault(self, message: str) -> DescriptionError:
        """The DescriptionError about this file, to be raised; the message begins with the key at fault."""
        return DescriptionError(self.place(message))

    def line(self, keys: Sequence[str]) -> int:
        """The line, from 1, of a key: the variant's before the file's own.

        ``keys`` lead to it from the file's root, indices as text from "0". Without it the line is that of the innermost
        table that has it; 1 where no such table is in the file.
        """
        roots = [*([f"variants.{self.variant}."] if self.variant else []), ""]
        tree = tomllib.loads(self.text)
        for depth in range(len(keys), 0, -1):
            for root in roots:
                place = _keys_in(tree, root + ".".join(keys[:depth]))
                if place:
                    return line_of(self.text, place)
        return 1

    def at(self, keys: Sequence[str]) -> str:
        """File, line and key as text, with which a message begins: "rig.toml:12: links.rod.mass"."""
        return f"{self.name}:{self.line(keys)}: {readable(keys)}"

    def place(self, message: str) -> str:
        """A message that begins with a key (``links.rod.mass: ...``), with file name and line put before it.

        The key may end in " is missing".
        """
        path, colon, rest = message.partition(": ")
        missing = WITHOUT if path.endswith(WITHOUT) else ""
        return f"{self.at(path.removesuffix(WITHOUT).split('.'))}{missing}{colon}{rest}"


def readable(keys: Sequence[str]) -> str:
    """A path of keys for a reader, who counts from 1: ``forces #2.force`` for forces, "1", force. Long keys are cut."""
    return ".".join(f"#{int(key) + 1}" if key.isdigit() else shortened(key) for key in keys).replace(".#", " #")


JOINED: Final = "links are pinned where points have one name, and slide by slides or slots; leave it out"
BEYOND: Final = (
    "gears, belts, chains, cams, contact and a second driver are beyond it; see 'What linkproof cannot do' in "
    "docs/linkage-files.md"
)
NO_KEYS: Final[Mapping[str, str]] = {
    **dict.fromkeys(
        (
            "gear",
            "gears",
            "rack",
            "belt",
            "belts",
            "pulley",
            "chain",
            "chains",
            "cam",
            "cams",
            "contact",
            "contacts",
            "inputs",
            "drivers",
            "synthesis",
        ),
        BEYOND,
    ),
    **dict.fromkeys(("pin", "pins", "joint", "joints", "hinge", "hinges", "revolute"), JOINED),
    "repeat": "equal parts stand in the file one by one; write them out, by a few lines of Python if they are many",
}  # what files have had or might have, and what to do instead


def sentence(error: ValidationError, source: Source, model: type[BaseModel] = Document) -> str:
    """The most telling fault of the first wrong value, as one sentence, which begins with file, line and key.

    ``source`` gives the place, ``model``, the table of the whole file, what is expected there.
    """
    fault = _most_telling_fault(error.errors(include_url=False, include_context=False))
    keys = _keys(fault)
    if fault["type"] == "extra_forbidden" and keys[-1] in NO_KEYS:
        return f"{source.at(keys)}: unknown key '{keys[-1]}': {NO_KEYS[keys[-1]]}"
    if fault["type"] == "extra_forbidden":
        return f"{source.at(keys)}: {UnknownNameError('key', keys[-1], _known_keys(keys[:-1], model))}"
    if fault["type"] == "missing" and not keys[-1].isdigit():
        return f"{source.at(keys)}{WITHOUT}: expected {_expected_in_words(fault, keys, model)}; add it"
    expected, value = _expected_in_words(fault, keys, model), fault["input"]
    is_comma = "[x, y]" in expected and isinstance(value, list) and len(value) > 2 and isinstance(value[-1], int)
    cure = "write decimals with a dot, 25.5 and not 25,5" if is_comma else "correct it"
    return f"{source.at(keys)}: expected {expected}, got {shown(value)}; {cure}"


def _most_telling_fault(faults: Sequence[ErrorDetails]) -> ErrorDetails:
    """The fault to report, of one or more: the deepest of the first wrong value, which may fail several forms.

    Where that is a missing key beside an unknown one, a misspelling of it, the fault of the unknown key is returned.
    """
    first = _keys(faults[0])
    deepest = max((f for f in faults if _keys(f)[: len(first)] == first), key=lambda fault: len(_keys(fault)))
    beside = [f for f in faults if f["type"] == "extra_forbidden" and _keys(f)[:-1] == _keys(deepest)[:-1]]
    return beside[0] if deepest["type"] == "missing" and beside else deepest


def _keys(fault: ErrorDetails) -> list[str]:
    """Keys, as text, from the file's root to the fault, without pydantic's own entries for alternative forms."""
    forms = ("tuple[", "list[", "constrained-", "float")
    return [str(key) for key in fault["loc"] if key != "Polar" and not str(key).startswith(forms)]


def _expected_in_words(fault: ErrorDetails, keys: Sequence[str], model: type[BaseModel]) -> str:
    """What is expected at ``keys``, in words.

    That is the description of the outermost key's field in the ``model``; else the phrase of the innermost key that has
    one; else the kind of value that the fault asks for.
    """
    if keys[0] in model.model_fields and (words := model.model_fields[keys[0]].description):
        return words
    names = [key for key in keys if not key.isdigit()]
    for depth in range(len(names), 0, -1):
        inside = ".*" if depth < len(names) else ""
        for key in (f"{names[0]}.{names[depth - 1]}{inside}", f"{names[depth - 1]}{inside}"):
            if key in EXPECTED:
                return EXPECTED[key]
    return str(_PHRASES["by_kind"].get(fault["type"], "a value of another kind"))


def shown(value: object) -> str:
    """A value read from a file, cut short, as text for a message: texts in quotes, true and false in small letters.

    Of an integer too long to be written it says how many bits it has.
    """
    if isinstance(value, int) and not isinstance(value, bool) and value.bit_length() > LONGEST_NUMBER:
        return f"a number of {value.bit_length()} bits"
    return shortened(
        str(value).lower() if isinstance(value, bool) else repr(value) if isinstance(value, str) else str(value)
    )


def _known_keys(parents: Sequence[str], root: type[BaseModel]) -> list[str]:
    """Names of the keys, sorted, that the table at the path ``parents`` of keys may have; [] for an unknown path.

    ``root`` is the model of the whole file.
    """
    model: type[BaseModel] | None = root
    for key in parents:
        if model is not None and key in model.model_fields:
            model = next(_tables_in(model.model_fields[key].annotation), None)
    if model is None:
        return []
    outside = () if parents or root is not Document else ("variants",)  # removed before the model validates
    return sorted((*(field.alias or name for name, field in model.model_fields.items()), *outside))


def _tables_in(annotation: Any) -> Iterator[type[BaseModel]]:  # noqa: ANN401 - an annotation may be anything
    """Yield the table models inside an annotation such as ``dict[str, LinkTable]`` or ``SketchTable | None``."""
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        yield annotation
    for argument in getattr(annotation, "__args__", ()):
        yield from _tables_in(argument)


def line_of(text: str, keys: Sequence[str | int]) -> int:
    """The line, from 1, of a TOML text that has a key, a table's header or an element of a list.

    ``keys`` and indices lead to it from the root. The line of a table without a header is that of its first key. Raises
    KeyError or IndexError for keys that lead nowhere.
    """
    import tomlkit  # noqa: PLC0415 - only who is shown a fault pays for it
    from tomlkit.items import Table  # noqa: PLC0415

    mark = "here"
    while mark in text:
        mark += "!"
    document = tomlkit.parse(text)
    place: Any = document
    for key in keys:
        parent, place = place, place[key]
    if isinstance(place, Table):
        place.comment(mark)
    else:
        parent[keys[-1]] = mark
    before, marked, _ = tomlkit.dumps(document).partition(mark)
    return before.count("\n") + 1 if marked else line_of(text, [*keys, next(iter(place))])


def _keys_in(tree: object, path: str) -> list[str | int] | None:
    """The keys and indices that a dotted path means in nested tables and lists; None for a path that leads nowhere."""
    inner = tree.items() if isinstance(tree, dict) else enumerate(tree) if isinstance(tree, list) else ()
    for key, value in inner:
        if path == str(key):
            return [key]
        rest = _keys_in(value, path.removeprefix(f"{key}.")) if path.startswith(f"{key}.") else None
        if rest is not None:
            return [key, *rest]
    return None
