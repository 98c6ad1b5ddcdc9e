"""Adams result files (``.res``): XML of schema xrf 2.0, as Adams/Solver and the solver in SolidWorks Motion write it.

``StepMap`` lists entities with their components, each with ``id`` and ``unitsValue``; a ``Step`` holds one instant, its
numbers in the order of the ids.
"""

from __future__ import annotations

import io
import re
from dataclasses import replace
from typing import Final
from xml.etree import ElementTree

from analytic.errors import printable
from comparisons.imported.columns import Column
from comparisons.imported.files.tables import tables
from comparisons.imported.files.text import ResultText

NOT_INSTANTS: Final = ("input", "output")  # types of steps that are no instants of the motion


def is_adams(text: str) -> bool:
    """Whether a text is an Adams result file."""
    return text.lstrip().startswith("<") and "<Results" in text[:2000]


def columns(file: ResultText) -> list[Column]:
    """A column for each component; raises LinkproofError with the file, and the step as the line."""
    names: dict[int, tuple[str, str]] = {}  # header and unit by id
    steps: list[str] = []
    entity = ""
    content = re.sub(r"^\s*<\?xml[^>]*\?>", "", file.text, count=1).encode("utf-8", "replace")
    try:
        for event, element in ElementTree.iterparse(io.BytesIO(content), ("start", "end")):
            tag = element.tag.rpartition("}")[2]
            if event == "start" and tag == "Entity":
                entity = printable(element.get("name", "")).removesuffix("_XFORM")
            elif event == "start" and tag == "Component":
                name = printable(element.get("name", ""))
                header = name if entity.lower() == name.lower() else f"{entity}.{name}"
                names[int(element.get("id", "")[:9])] = (header, element.get("unitsValue", ""))
            elif event == "end" and tag == "Step":
                if element.get("type") not in NOT_INSTANTS:
                    steps.append("\t".join((element.text or "").split()))
                element.clear()
    except ElementTree.ParseError as error:
        raise file.fail(error.position[0], f"expected valid XML of Adams, got {error.msg}; export it again") from error
    except ValueError as error:
        raise file.fail(1, f"expected a number for the id of '{entity}', got another; export it again") from error
    blocks = [*tables(ResultText(f"{file.name}[steps]", "\n".join(steps)))]
    if len(blocks) > 1 or len(blocks[0][1]) != len(names):
        raise file.fail(1, f"expected {len(names)} numbers in every step, got another count; export the results again")
    every = zip(blocks[0][1], sorted(names.items()), strict=True)
    return [replace(column, header=header, unit=unit) for column, (_, (header, unit)) in every]
