"""Adams result files (``.res``): XML of schema xrf 2.0, as Adams/Solver and the solver in SolidWorks Motion write it.

``StepMap`` lists entities with their components, each with ``id`` and ``unitsValue``; a ``Step`` holds one instant, its
numbers in the order of the ids.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Final
from xml.parsers import expat

from analytic.errors import LinkproofError, printable, shortened
from comparisons.imported.columns import Column
from comparisons.imported.files.printed import LONGEST, is_number, parse, resolution
from comparisons.imported.files.text import ResultText

# Steps that are no instants of the motion.
NOT_INSTANTS: Final = ("input", "output")


@dataclass
class _Results:
    """What a parser has met so far."""

    file: ResultText
    entity: str = ""
    names: dict[int, tuple[str, str, int]] = field(default_factory=dict)  # header, unit and line by id
    words: list[str] | None = None  # of the step that is being read
    steps: list[list[str]] = field(default_factory=list)
    lines: list[int] = field(default_factory=list)


def is_adams(text: str) -> bool:
    """Whether a text is an Adams result file."""
    return text.lstrip().startswith("<") and "<Results" in text[:2000]


def columns(file: ResultText) -> tuple[int, list[Column]]:
    """The line at which the components begin, and a column for each; raises LinkproofError with file and line."""
    results = _Results(file)
    _parse(results)
    if not results.names or not results.steps:
        missing = "components in a StepMap" if not results.names else "steps"
        raise file.fail(1, f"expected an Adams result file with {missing}, got none; export the results again")
    names = [results.names[identifier] for identifier in sorted(results.names)]
    for line, step in zip(results.lines, results.steps, strict=True):
        if len(step) != len(names):
            raise file.fail(
                line,
                f"expected {len(names)} numbers in the step, one for each component, got {len(step)}; export again",
            )
    return names[0][2], [
        _column(results, number, name, [step[number] for step in results.steps]) for number, name in enumerate(names)
    ]


def _parse(results: _Results) -> None:
    parser = expat.ParserCreate()
    parser.buffer_text = True

    def start(tag: str, attributes: Mapping[str, str]) -> None:
        name = tag.rpartition(":")[2]
        if name == "Entity":
            results.entity = printable(attributes.get("name", "")).removesuffix("_XFORM")
        elif name == "Component":
            _add(results, attributes, parser.CurrentLineNumber)
        elif name == "Step" and attributes.get("type") not in NOT_INSTANTS:
            results.words = []
            results.lines.append(parser.CurrentLineNumber)

    def text(characters: str) -> None:
        if results.words is not None:
            results.words.append(characters)

    def end(tag: str) -> None:
        if tag.rpartition(":")[2] == "Step" and results.words is not None:
            results.steps.append("".join(results.words).split())
            results.words = None

    parser.StartElementHandler, parser.CharacterDataHandler, parser.EndElementHandler = start, text, end
    try:
        parser.Parse(re.sub(r"^\s*<\?xml[^>]*\?>", "", results.file.text, count=1).encode("utf-8", "replace"), True)
    except expat.ExpatError as error:
        reason = expat.ErrorString(error.code)
        raise results.file.fail(error.lineno, f"expected valid XML of Adams, got {reason}; export it again") from error


def _add(results: _Results, attributes: Mapping[str, str], line: int) -> None:
    identifier = attributes.get("id", "")
    if not re.fullmatch(r"\d{1,9}", identifier) or int(identifier) in results.names:
        raise results.file.fail(
            line, f"expected a component with an id of its own, got '{shortened(identifier)}'; export the results again"
        )
    name = printable(attributes.get("name", ""))
    header = name if results.entity.lower() == name.lower() else f"{results.entity}.{name}"
    results.names[int(identifier)] = (header, attributes.get("unitsValue", ""), line)


def _column(results: _Results, number: int, name: tuple[str, str, int], words: list[str]) -> Column:
    header, unit, line = name
    numbers = parse(words) if max(map(len, words)) <= LONGEST else None
    if numbers is None:
        raise _bad_word(results, header, words)
    values, decimals = numbers
    return Column(header, unit, values, resolution(values, decimals), f"{results.file.name}:{line} ({header})")


def _bad_word(results: _Results, header: str, words: list[str]) -> LinkproofError:
    for line, word in zip(results.lines, words, strict=True):
        if not is_number(word):
            return results.file.fail(
                line, f"expected finite numbers of {header}, got '{shortened(word)}'; export that stretch again"
            )
    return results.file.fail(1, f"expected finite numbers of {header}; export the results again")
