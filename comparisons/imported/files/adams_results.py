"""Adams result files (``.res``): XML of schema xrf 2.0, as Adams/Solver and the solver in SolidWorks Motion write it.

``StepMap`` lists entities with their components, each with ``id`` and ``unitsValue``; a ``Step`` holds one instant, its
numbers in the order of the ids.
"""

from __future__ import annotations

import io
import re
from typing import Final
from xml.etree import ElementTree

import numpy as np

from analytic.errors import printable, shortened
from comparisons.imported.columns import Column
from comparisons.imported.files.tables import DIGITS_OF, is_number, resolution
from comparisons.imported.files.text import ResultText

NOT_INSTANTS: Final = ("input", "output")  # types of steps that are no instants of the motion


def is_adams(text: str) -> bool:
    """Whether a text is an Adams result file."""
    return text.lstrip().startswith("<") and "<Results" in text[:2000]


def columns(file: ResultText) -> list[Column]:
    """A column for each component; raises LinkproofError with the file and the step."""
    names: dict[int, tuple[str, str]] = {}  # header and unit by id
    steps: list[list[str]] = []
    entity = ""
    content = re.sub(r"^\s*<\?xml[^>]*\?>", "", file.text, count=1).encode("utf-8", "replace")
    try:
        for event, element in ElementTree.iterparse(io.BytesIO(content), ("start", "end")):
            tag = element.tag.rpartition("}")[2]
            if event == "start" and tag == "Entity":
                entity = printable(element.get("name", "")).removesuffix("_XFORM")
            elif event == "start" and tag == "Component":
                number, name = element.get("id", ""), printable(element.get("name", ""))
                if not re.fullmatch(r"[0-9]{1,9}", number) or int(number) in names:
                    raise file.fail(
                        1, f"expected a component with an id of its own, got '{shortened(number)}'; export it again"
                    )
                header = name if entity.lower() == name.lower() else f"{entity}.{name}"
                names[int(number)] = (header, element.get("unitsValue", ""))
            elif event == "end" and tag == "Step":
                if element.get("type") not in NOT_INSTANTS:
                    steps.append((element.text or "").split())
                element.clear()
    except ElementTree.ParseError as error:
        raise file.fail(error.position[0], f"expected valid XML of Adams, got {error.msg}; export it again") from error
    if not names or not steps:
        missing = "steps" if names else "components in a StepMap"
        raise file.fail(1, f"expected an Adams result file with {missing}, got none; export the results again")
    for number, step in enumerate(steps, start=1):
        bad = next((word for word in step if not is_number(word)), None)
        if bad is not None or len(step) != len(names):
            got = f"'{shortened(bad)}'" if bad else str(len(step))
            raise file.fail(1, f"expected {len(names)} finite numbers in step {number}, got {got}; export it again")
    every = np.char.replace(np.char.upper(np.array(steps)), "D", "E").astype(float).T
    words = list(zip(*steps[:: max(1, len(steps) // DIGITS_OF)], strict=True))
    return [
        Column(header, unit, every[n], resolution(every[n], words[n]), f"{file.name} ({header})")
        for n, (_, (header, unit)) in enumerate(sorted(names.items()))
    ]
