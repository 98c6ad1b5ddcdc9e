"""Results of functions, printed as their commands print them: a line, all text, a notebook's cell, a table."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import asdict
from typing import TYPE_CHECKING, Any

from markupsafe import escape

from reports.document.terminal import Printed, Printout, rendered

if TYPE_CHECKING:
    import pandas


class PrintedResult(ABC):
    """A result with the output of its command."""

    @abstractmethod
    def _printout(self) -> Printout:
        """The output of the command."""

    @abstractmethod
    def _rows(self) -> Sequence[Any]:
        """Dataclasses, one for each row of the table."""

    def _sentence(self) -> Printed:
        """The outcome in a sentence."""
        return self._printout().closing[-1]

    def __repr__(self) -> str:
        """A line: the kind of result and the outcome."""
        return f"<{type(self).__name__}: {rendered(self._sentence()).strip()}>"

    def __str__(self) -> str:
        """The output of the command."""
        printed = self._printout()
        return rendered(*printed.tables, *printed.closing).strip("\n")

    def _repr_html_(self) -> str:
        return f"<pre>{escape(str(self))}</pre>"

    def to_pandas(self) -> pandas.DataFrame:
        """A row for every record, verdict or finding, a column for each of its fields."""
        import pandas  # noqa: PLC0415  half a second that results alone do not pay

        return pandas.DataFrame([asdict(row) for row in self._rows()])
