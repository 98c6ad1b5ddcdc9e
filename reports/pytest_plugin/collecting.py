"""What pytest collects of a linkage file: a node for every run with a test for every quantity, and the key figures."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from functools import cached_property
from pathlib import Path
from typing import Any, Final

import pytest

from analytic.errors import LinkproofError
from comparisons.campaign.key_figures import KeyFigure
from comparisons.campaign.project import find_project
from comparisons.judging.records import Record, Verdict
from comparisons.runs.plugins import engine
from engines.registry import why_unavailable
from reports.pytest_plugin.campaign import CampaignRun, FileCampaign, file_campaign
from reports.pytest_plugin.words import changed, failure, recording

FIGURES: Final = "key-figures"


def is_listed(path: Path) -> bool:
    """Whether a file is one of its project's linkages; raises CollectError for a project that cannot be read."""
    try:
        project = find_project(path.parent)
    except LinkproofError as error:
        raise pytest.Collector.CollectError(str(error)) from error
    return project is not None and path.resolve() in [linkage.resolve() for linkage in project.linkages]


class LinkageTests(pytest.File):
    """A linkage file: its runs and its key figures."""

    def collect(self) -> Iterator[pytest.Collector]:
        """A node for every run, and one for the key figures of every motion that a baseline may know."""
        self.add_marker("linkproof")
        try:
            campaign = file_campaign(self.path, self.config.invocation_params.dir)
            runs = campaign.runs
            figures = campaign.figures() if campaign.standard.baseline.places else []
        except LinkproofError as error:
            raise self.CollectError(str(error)) from error
        for run in runs:
            yield RunTests.from_parent(self, run=run)
        for regime in dict.fromkeys(figure.regime for figure in figures):
            ours = [figure for figure in figures if figure.regime == regime]
            yield FigureTests.from_parent(self, name=f"{regime}-{FIGURES}", campaign=campaign, figures=ours)


class RunTests(pytest.Collector):
    """One run, made when the first of its quantities is asked for."""

    def __init__(self, *, parent: pytest.Collector, run: CampaignRun, **words: Any) -> None:  # noqa: ANN401 - pytest's own
        self.run = run
        name = f"{run.case.motion.regime}-{run.engine}-{run.setting}"
        super().__init__(name=name, parent=parent, **words)

    def collect(self) -> Iterator[pytest.Item]:
        """A test for every quantity and invariant."""
        self.add_marker(self.run.engine)
        absent = why_unavailable(engine(self.run.engine))
        if absent is not None:
            self.add_marker(pytest.mark.skip(reason=absent))
        for quantity in self.run.quantities:
            yield QuantityTest.from_parent(self, name=quantity)

    @cached_property
    def records(self) -> tuple[Record, ...]:
        """What the run gave."""
        return self.run.records()


class QuantityTest(pytest.Item):
    """A quantity of a run within its limit, and within what is recorded of it."""

    parent: RunTests

    def runtest(self) -> None:
        """Fail with the record's detail; skip what says nothing of the engine."""
        records, run = self.parent.records, self.parent.run
        failed = replace(records[0], quantity=self.name, unit="")  # a failed run has no invariants
        record = next((record for record in records if record.quantity == self.name), failed)
        verdict = Verdict(record.outcome)
        if verdict is Verdict.PASSED:
            return
        if verdict.failed and not run.campaign.decides(run.setting):
            pytest.xfail(f"decides nothing beside other settings: {record.detail}")
        if verdict.failed or verdict is Verdict.SUITE_ERROR:
            pytest.fail(failure(record, run.campaign.asked, run.campaign.notes), pytrace=False)
        pytest.skip(f"{record.outcome}: {record.detail}")

    def reportinfo(self) -> tuple[Path, int, str]:
        """Where the test stands in reports."""
        return self.path, 0, f"{self.parent.name} {self.name}"


class FigureTests(pytest.Collector):
    """The key figures of one motion."""

    def __init__(
        self,
        *,
        parent: pytest.Collector,
        campaign: FileCampaign,
        figures: list[KeyFigure],
        **words: Any,  # noqa: ANN401 - pytest's own
    ) -> None:
        self.campaign, self.figures = campaign, figures
        super().__init__(parent=parent, **words)

    def collect(self) -> Iterator[pytest.Item]:
        """A test for every figure; one that is skipped where none is recorded."""
        if all(figure.recorded is None for figure in self.figures):
            reason = f"no key figure is recorded: {recording(self.campaign.asked)}"
            self.add_marker(pytest.mark.skip(reason=reason))
            yield FigureTest.from_parent(self, name="all", figure=self.figures[0])
            return
        for figure in self.figures:
            yield FigureTest.from_parent(self, name=figure.figure, figure=figure)


class FigureTest(pytest.Item):
    """A key figure as it is recorded."""

    parent: FigureTests

    def __init__(self, *, figure: KeyFigure, **words: Any) -> None:  # noqa: ANN401 - pytest's own
        self.figure = figure
        super().__init__(**words)

    def runtest(self) -> None:
        """Fail with the change in words."""
        if self.figure.changed:
            campaign = self.parent.campaign
            pytest.fail(changed(self.figure, campaign.asked, campaign.notes), pytrace=False)

    def reportinfo(self) -> tuple[Path, int, str]:
        """Where the test stands in reports."""
        return self.path, 0, f"{self.parent.name} {self.name}"
