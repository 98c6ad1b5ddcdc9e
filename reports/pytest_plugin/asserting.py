"""The comparison of the fixture: as ``linkproof.compare``; the test fails if the comparison does not pass."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import pytest

from comparisons.judging.records import Verdict
from comparisons.judging.verdicts import deciding
from comparisons.runs.plugins import engine
from engines.registry import why_unavailable
from reports.pytest_plugin.campaign import changed, failure
from reports.python.campaign import Comparison, compare
from reports.python.keywords import words


@dataclass
class Assertion:
    """Comparisons of a session, each made once."""

    made: dict[str, Comparison] = field(default_factory=dict)

    def __call__(self, *mechanisms: str | Path, **options: Any) -> Comparison:  # noqa: ANN401 - the options of compare
        """Compare mechanisms under the options of ``linkproof.compare``; fail the test with every failed record.

        Skips the test if a named engine is not installed, and if no record is judged.
        """
        for name in words(options.get("engine", ())):
            absent = why_unavailable(engine(name))
            if absent is not None:
                pytest.skip(absent)
        key = repr((mechanisms, sorted(options.items())))
        if key not in self.made:
            self.made[key] = compare(*mechanisms, **{"jobs": 1, **options})
        comparison = self.made[key]
        requested = comparison.campaign.options
        texts = [
            failure(record, requested, comparison.notes)
            for record in deciding(comparison.records)
            if _fails(record.outcome)
        ]
        texts += [changed(figure, requested, comparison.notes) for figure in comparison.figures if figure.changed]
        texts += comparison.departures
        if texts:
            pytest.fail("\n\n".join(texts), pytrace=False)
        if not any(Verdict(record.outcome).judged for record in comparison.records):
            pytest.skip("; ".join(sorted({f"{record.outcome}: {record.detail}" for record in comparison.records})))
        return comparison


def _fails(outcome: str) -> bool:
    return Verdict(outcome).failed or outcome == Verdict.SUITE_ERROR
