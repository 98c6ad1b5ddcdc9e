"""A linkage's file as a template, in which a page puts other numbers: text and the places of numbers by turns."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from contextlib import suppress
from dataclasses import dataclass
from typing import Any, Final

from analytic.description import loading
from analytic.description.changes import Place
from analytic.description.linkage import Linkage
from analytic.description.rewriting import spelt_out, written_numbers
from analytic.errors import LinkproofError

MARK: Final = "\0"  # around the name of a number: no linkage file has this character


@dataclass(frozen=True)
class FileTemplate:
    """A file's text: every second one of the ``parts`` is the name of a number, which ``literals`` has as written."""

    parts: tuple[str, ...]
    literals: Mapping[str, str]


def templates(linkage: Linkage, names: Iterable[str]) -> list[FileTemplate]:
    """The file as it is, if its own values are meant, and the file with all numbers of the variant written out.

    A number that the first one lacks, as its file leaves it out or has it in another form, is in the second one.
    """
    text, name, names = linkage.text, linkage.name, tuple(names)
    own_variant = loading.document(text, name, name)[0].get("variant", "base")
    texts = [text] if linkage.variant == own_variant else []
    with suppress(LinkproofError):
        texts.append(spelt_out(text, name, linkage.variant))
    return [_template(key, written_numbers(key, name, None).places, names) for key in texts]


def _template(text: str, places: Mapping[str, Place], names: Iterable[str]) -> FileTemplate:
    import tomlkit  # noqa: PLC0415 - only a page that can be pulled at pays for it
    from tomlkit.items import Float, Integer, Trivia  # noqa: PLC0415

    document = tomlkit.parse(text.removeprefix(loading.BYTE_ORDER_MARK))
    literals: dict[str, str] = {}
    for name in names:
        table: Any = document
        try:
            for key in places[name][:-1]:
                table = table[key]
            number = table[places[name][-1]]
        except (LookupError, TypeError):
            continue
        if isinstance(number, Float | Integer):
            literals[name] = number.as_string()
            table[places[name][-1]] = Float(0.0, Trivia(), f"{MARK}{name}{MARK}")
    return FileTemplate(tuple(tomlkit.dumps(document).split(MARK)), literals)
