"""What a column means by its header and by the mapping together, with the corrections that are agreed to."""

from __future__ import annotations

from dataclasses import dataclass

from analytic.errors import UnknownNameError
from comparisons.faults.fault import Correction
from comparisons.imported.columns import NO_CORRECTION, TIME, Column, ResultTable
from comparisons.imported.headers.meaning import Meaning, NotJudgedError, Recognition
from comparisons.imported.headers.units import parsed
from comparisons.imported.mapping.mapping_file import Mapping
from comparisons.imported.mapping.schema import MappedColumn


@dataclass(frozen=True)
class Agreement:
    """A mapping beside what headers say by themselves."""

    recognition: Recognition
    mapping: Mapping

    def meaning(self, column: Column, table: ResultTable, number: int) -> tuple[Meaning, Correction]:
        """What a column of a table is, and the corrections agreed to.

        Raises NotJudgedError for one whose meaning is unknown, DescriptionError for an entry that cannot be.
        """
        found = self.mapping.entry(column, table, number)
        if found is None:
            return self.recognition.meaning(column), NO_CORRECTION
        at, entry = found
        meaning = self._named(at, entry, column)
        unit = meaning.unit.factor if meaning.unit else 1.0
        return meaning, Correction(entry.sign, entry.factor, entry.time_shift, entry.offset * unit)

    def _named(self, at: int, entry: MappedColumn, column: Column) -> Meaning:
        if entry.signal is None:
            meaning = self._by_header(at, column)
        else:
            known = (TIME, *self.recognition.signals)
            if entry.signal not in known:
                raise self.mapping.fail(at, "signal", str(UnknownNameError("signal", entry.signal, known)))
            meaning = self._with_printed_unit(entry.signal, column)
        return meaning if entry.unit is None else self._with_unit(at, entry.unit, meaning)

    def _by_header(self, at: int, column: Column) -> Meaning:
        try:
            return self.recognition.meaning(column)
        except NotJudgedError as reason:
            raise self.mapping.fail(
                at, "header", f'expected a signal for this column, got none, and {reason}; add signal = "..."'
            ) from None

    def _with_printed_unit(self, signal: str, column: Column) -> Meaning:
        """A signal in the unit that the header states, if it states one that measures it."""
        unit, printed = self.recognition.printed_unit(column, signal)
        return Meaning(signal, unit, printed)

    def _with_unit(self, at: int, text: str, meaning: Meaning) -> Meaning:
        unit, si = parsed(text), self.recognition.unit(meaning.signal)
        if unit is None:
            fault = UnknownNameError("unit", text, self.recognition.offered_units(meaning.signal))
            raise self.mapping.fail(at, "unit", str(fault))
        if not unit.measures(si.dimension):
            raise self.mapping.fail(
                at, "unit", f"expected a unit of {meaning.signal}, such as {self.recognition.si(meaning.signal)}, got "
                f"'{text}'; correct it",
            )  # fmt: skip
        return Meaning(meaning.signal, unit, text, meaning.taken)
