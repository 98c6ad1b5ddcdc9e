"""The words of reports: page templates, which escape all values that are not markup, and sentences as plain text."""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

from markupsafe import Markup

from reports.document import numbers

if TYPE_CHECKING:
    import jinja2

FOLDER = Path(__file__).parents[1] / "templates"
MACRO = re.compile(r"\n\n{% macro (\w+)")  # the begin of one in sentences.txt; others stand within one
# A signal of a part of the linkage.
INSTANT = re.compile(r"[-+]?\.?\d")  # what stands behind the @ of a figure
SIGNAL = re.compile(r"(?P<kind>point|link|joint_force):(?P<owner>.+):(?P<what>\w+)")


def render(template: str, **values: object) -> Markup:
    """A page template of ``reports/templates``, by its file's name, filled in with values, as markup.

    Raises Jinja's UndefinedError for a value that the template lacks, its TemplateNotFound for an unknown name.
    """
    return Markup(_environment().get_template(template).render(**values))


def lines(macro: str, **values: object) -> list[str]:
    """The sentences of one macro of ``sentences.txt`` with these values, a line each, as plain text.

    Empty lines are left out. Raises KeyError for a macro that there is not, Jinja's UndefinedError for a value that it
    lacks.
    """
    names = str(getattr(_sentences(macro), macro)(**values)).splitlines()
    return [" ".join(line.split()) for line in names if line.strip()]


def sentence(macro: str, **values: object) -> str:
    """The sentences of one macro of ``sentences.txt`` with these values as one paragraph; "" if it has none.

    Raises as ``lines`` does.
    """
    return " ".join(lines(macro, **values))


@cache
def _sentences(macro: str) -> Any:  # noqa: ANN401 - a template's module
    """The module of a compiled macro, which has it as an attribute; kept once made.

    Each macro is compiled alone, with those that it uses, since all of them take a quarter of a second.
    """
    _, *texts = MACRO.split((FOLDER / "sentences.txt").read_text(encoding="utf-8"))
    known = dict(zip(texts[::2], texts[1::2], strict=True))
    used = [macro]
    for name in used:
        used += [other for other in known if other not in used and f"{other}(" in known[name]]
    return _environment().from_string("".join(f"{{% macro {name}{known[name]}" for name in used[::-1])).module


@cache
def _environment() -> jinja2.Environment:
    """Jinja's environment of the page templates, kept once made; a missing value is an error."""
    import jinja2  # noqa: PLC0415 - a table needs none of it

    environment = jinja2.Environment(
        loader=jinja2.FileSystemLoader(FOLDER),
        autoescape=jinja2.select_autoescape(default_for_string=False),  # pages, not sentences
        undefined=jinja2.StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
    )
    filters = (numbers.figure, numbers.bound, numbers.decade, numbers.error, numbers.seconds,
           numbers.within_turn, plain, enumerated, math.degrees)  # fmt: skip
    environment.filters.update({function.__name__: function for function in filters})
    return environment


def enumerated(names: Sequence[str]) -> str:
    """Names joined for a sentence: "a, b and c"; "" for none."""
    return " and ".join(filter(None, (", ".join(names[:-1]), *names[-1:])))


def plain(name: str) -> str:
    """A name for a reader, spaces for its underscores: "joint_force" is "joint force"."""
    return name.replace("_", " ")


def worded(quantity: str) -> str:
    """A quantity's name for a reader.

    "Jeq:needle_bar.mean" is "Jeq of needle bar, mean", "point:F:x@5 - phi" is "x of point F at 5° − phi".
    """
    whole, *less = quantity.split(" - ")
    name, at, place = whole.rpartition("@")
    if at and INSTANT.match(place):
        unit = next((unit for unit in ("rad", "s") if place.endswith(unit)), "")
        where = f"{place.removesuffix(unit)} {unit}" if unit else f"{place.removesuffix('deg')}°"
        words = f"{_signal(name)} at {where}"
    else:
        name, dot, what = whole.rpartition(".")
        words = f"{_signal(name)}, {what}" if dot else _signal(whole)
    return plain(" − ".join([words, *map(_signal, less)]))


def _signal(name: str) -> str:
    """A signal's name in words, "x of point F" for "point:F:x"; any other name with " of " for its colons."""
    part = SIGNAL.fullmatch(name)
    return f"{part['what']} of {part['kind']} {part['owner']}" if part else name.replace(":", " of ")
