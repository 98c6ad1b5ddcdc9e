"""The tests of a linkage file: a node for every run with a test for every quantity, and the key figures.

The test of a project's set of files is collected with its first linkage file.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from functools import cached_property
from pathlib import Path
from typing import Any, Final

import pytest

from analytic.errors import LinkproofError
from comparisons.campaign.key_figures import KeyFigure
from comparisons.campaign.project import FILE, find_project, read_project
from comparisons.judging.baseline import Departure
from comparisons.judging.records import Record, Verdict
from comparisons.runs.plugins import engine
from engines.registry import why_unavailable
from reports.pytest_plugin.campaign import (
    CampaignRun,
    FileCampaign,
    changed,
    failure_text,
    file_campaign,
    project_departures,
    recording_command,
)

FIGURES: Final = "key-figures"
SEEN: Final = pytest.StashKey[set[Path]]()  # collected files of projects


def is_listed(path: Path) -> bool:
    """Whether a file is listed in its project; raises CollectError for a project that cannot be read."""
    try:
        project = find_project(path.parent)
    except LinkproofError as error:
        raise pytest.Collector.CollectError(str(error)) from error
    return project is not None and path.resolve() in [linkage.resolve() for linkage in project.linkages]


class LinkageTests(pytest.File):
    """A linkage file: its runs and its key figures."""

    def collect(self) -> Iterator[pytest.Collector | pytest.Item]:
        """A node for every run, and one for the key figures of every motion that a baseline may know."""
        self.add_marker("linkproof")
        try:
            campaign = file_campaign(self.path, self.config.invocation_params.dir)
            runs, baseline = campaign.runs, campaign.standard.baseline
            figures = campaign.figures() if baseline.places else []
            departures = campaign.departures()
            project = find_project(self.path.parent)
        except LinkproofError as error:
            raise self.CollectError(str(error)) from error
        if project is not None and is_first(project.folder / FILE, self.session):
            yield ProjectTests.from_parent(self.session, path=project.folder / FILE)
        if baseline.places and baseline.is_recorded:
            yield SetTest.from_parent(self, name="set-of-motions", departures=departures)
        for run in runs:
            yield RunTests.from_parent(self, run=run)
        (linkage,) = campaign.request.linkages
        for variant, regime in dict.fromkeys((figure.variant, figure.regime) for figure in figures):
            ours = [figure for figure in figures if (figure.variant, figure.regime) == (variant, regime)]
            name = "-".join((regime, *([variant] if variant != linkage.variant else []), FIGURES))
            yield FigureTests.from_parent(self, name=name, campaign=campaign, figures=ours)


def is_first(file: Path, session: pytest.Session) -> bool:
    """Whether the file of a project is new to the session, and is not collected by its own name."""
    seen = session.config.stash.setdefault(SEEN, set())
    is_new = file not in seen and not session.isinitpath(file)
    seen.add(file)
    return is_new


class ProjectTests(pytest.File):
    """A project: its set of files is that of its baseline."""

    def collect(self) -> Iterator[pytest.Item]:
        """A test that no linkage file is new or missing in the baseline; none without a recorded baseline."""
        self.add_marker("linkproof")
        try:
            departures = project_departures(read_project(self.path))
        except LinkproofError as error:
            raise self.CollectError(str(error)) from error
        if departures is not None:
            yield SetTest.from_parent(self, name="set-of-files", departures=departures)


class SetTest(pytest.Item):
    """A set of files, or of motions, is that of the baseline."""

    def __init__(self, *, departures: tuple[Departure, ...], **words: Any) -> None:  # noqa: ANN401 - arguments of pytest
        self.departures = departures
        super().__init__(**words)

    def runtest(self) -> None:
        """Fail with every departure that is not allowed."""
        sentences = [departure.sentence for departure in self.departures if not departure.is_allowed]
        if sentences:
            pytest.fail("\n".join(sentences), pytrace=False)

    def reportinfo(self) -> tuple[Path, int, str]:
        """The place of the test in reports."""
        return self.path, 0, self.name


class RunTests(pytest.Collector):
    """One run, made when the first of its quantities is requested."""

    def __init__(self, *, parent: pytest.Collector, run: CampaignRun, **words: Any) -> None:  # noqa: ANN401 - arguments of pytest
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
        """The records of the run."""
        return self.run.records()


class QuantityTest(pytest.Item):
    """A quantity of a run within its limit and its baseline."""

    parent: RunTests

    def runtest(self) -> None:
        """Fail with the record's detail; skip a record that is not judged."""
        records, run = self.parent.records, self.parent.run
        failed = replace(records[0], quantity=self.name, unit="")  # a failed run has no invariants
        record = next((record for record in records if record.quantity == self.name), failed)
        verdict = Verdict(record.outcome)
        if verdict is Verdict.PASSED:
            return
        if verdict.failed and not run.campaign.decides(run.setting):
            pytest.xfail(f"decides nothing beside other settings: {record.detail}")
        if verdict.failed or verdict is Verdict.SUITE_ERROR:
            pytest.fail(failure_text(record, run.campaign.options, run.campaign.notes), pytrace=False)
        pytest.skip(f"{record.outcome}: {record.detail}")

    def reportinfo(self) -> tuple[Path, int, str]:
        """The place of the test in reports."""
        return self.path, 0, f"{self.parent.name} {self.name}"


class FigureTests(pytest.Collector):
    """The key figures of one motion."""

    def __init__(
        self,
        *,
        parent: pytest.Collector,
        campaign: FileCampaign,
        figures: list[KeyFigure],
        **words: Any,  # noqa: ANN401 - arguments of pytest
    ) -> None:
        self.campaign, self.figures = campaign, figures
        super().__init__(parent=parent, **words)

    def collect(self) -> Iterator[pytest.Item]:
        """A test for every figure; a single skipped test if none is recorded."""
        if all(figure.recorded is None for figure in self.figures):
            reason = f"no key figure is recorded: {recording_command(self.campaign.options)}"
            self.add_marker(pytest.mark.skip(reason=reason))
            yield FigureTest.from_parent(self, name="all", figure=self.figures[0])
            return
        for figure in self.figures:
            yield FigureTest.from_parent(self, name=figure.figure, figure=figure)


class FigureTest(pytest.Item):
    """A key figure equals its recorded value."""

    parent: FigureTests

    def __init__(self, *, figure: KeyFigure, **words: Any) -> None:  # noqa: ANN401 - arguments of pytest
        self.figure = figure
        super().__init__(**words)

    def runtest(self) -> None:
        """Fail with the sentence of the change."""
        if self.figure.changed:
            campaign = self.parent.campaign
            pytest.fail(changed(self.figure, campaign.options, campaign.notes), pytrace=False)

    def reportinfo(self) -> tuple[Path, int, str]:
        """The place of the test in reports."""
        return self.path, 0, f"{self.parent.name} {self.name}"
