"""The output of ``linkproof check``: a line for each property of a linkage."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import Any

from comparisons.datasheet.linkage_check import BINDS
from reports.document.parts import Paragraph
from reports.document.templates import lines
from reports.document.terminal import Printed


def printed(facts: Mapping[str, Any], written: Callable[[float], str]) -> list[Printed]:
    """A line for each fact; ``written`` writes a length, m, in the file's unit."""
    heading = Paragraph(f"{facts['mechanism']} ({facts['variant']}): {facts['title']}", colour="bold")
    about = {"facts": facts, "written": written, "binds": math.degrees(BINDS)}
    rows = (line.partition(": ") for line in lines("check", **about))
    warnings = [Paragraph(f"warning: {text}", colour="yellow") for text in lines("check_warnings", **about)]
    return [heading, *(f"{label:<13}{text}" for label, _, text in rows), *warnings]
