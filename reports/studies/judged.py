"""The judgement of another tool's results."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar

from analytic.description.crank_motion import CrankMotion
from analytic.errors import LinkproofError
from comparisons.designer.linkage_check import warnings
from comparisons.filejudge.judge import ImportedJudgement
from comparisons.trials.campaign.campaign import CampaignRequest
from comparisons.trials.campaign.results import document as saved_document
from comparisons.trials.campaign.results import save
from comparisons.trials.judging.records import Error, RunRecord, Verdict
from reports import imported
from reports.document.study import PICTURES, Study
from reports.document.terminal import Printed, Printout, rendered

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def failed_rows(records: Iterable[Error]) -> list[str]:
    """A line for each of these records, failed or not, with its place, outcome and reason."""
    return [
        f"{record.mechanism} ({record.variant}), {record.regime}, {record.engine} {record.setting}, {record.quantity}: "
        f"{record.outcome}, {record.detail}"
        for record in records
    ]


@dataclass(frozen=True, repr=False, kw_only=True)
class Judgement(Study, ImportedJudgement):
    """The ``verdicts`` of every signal, and their probable causes; ``paths`` are the judged files.

    ``command`` is the one that repeats it.
    """

    suffixes: ClassVar = (".json", *PICTURES)
    paths: tuple[Path, ...]
    command: str

    @property
    def _files(self) -> str:
        """The paths of the judged files as one text, with commas."""
        return ", ".join(map(str, self.paths))

    @property
    def _title(self) -> str:
        """The linkage with its variant, and the files that it is held against, as text."""
        linkage = self.model.linkage
        return f"{linkage.name} ({linkage.variant}) against {self._files}"

    @property
    def exit_code(self) -> int:  # type: ignore[override]
        """The exit code: 0 if every signal is within the limit, else 1; raises LinkproofError if none is judged."""
        if all(verdict.outcome is Verdict.UNDEFINED for verdict in self.verdicts):
            raise LinkproofError(f"expected a signal to judge, got none: {self.verdicts[0].detail}")
        return 0 if self.passed else 1

    @property
    def warnings(self) -> Sequence[str]:
        """Warnings about probable slips of the linkage's file; [] without any."""
        return list(warnings(self.model.linkage))

    def printout(self) -> Printout:
        """The printed judgement: verdict, probable causes, a row for every signal."""
        return imported.printout(self, self._title)

    def brief(self) -> Sequence[Printed]:
        """The verdict in a sentence, for a quiet run, as the only member."""
        return [imported.sentence(self)]

    @property
    def _run(self) -> RunRecord:
        """The judgement as a run: each verdict as an error, its detail ending in the likeliest cause."""
        return imported.run_of_judgement(self, self._files)

    def to_dict(self) -> Mapping[str, Any]:
        """Verdicts, causes and errors, JSON-ready, SI, angles in rad."""
        return imported.document(self, self._run, self.command, imported.sentence(self))

    def rows(self) -> Sequence[Mapping[str, Any]]:
        """A row, JSON-ready, for every verdict."""
        return self._run.rows(self._run.errors)

    def failures(self) -> Sequence[str]:
        """The verdict, then a line for every signal that has not passed, over the limit or undecided."""
        rows = failed_rows(record for record in self._run.errors if record.outcome != Verdict.PASSED)
        return [rendered(self.sentence()).strip(), *rows]

    def plot(self) -> Figure:
        """A figure of the three worst curves and their differences from the closed form."""
        return imported.judged_figure(self, self._title)

    def write(self, folder: str | Path) -> Path:
        """Write the judgement into a folder like a campaign, replacing one there, with its pages.

        A judgement and a designer's results there are replaced as well. Returns the path of the page to open. Raises
        LinkproofError where a file cannot be written.
        """
        from reports.site import write_site  # noqa: PLC0415  figures cost seconds that a table does not pay

        linkage, motion = self.model.linkage, self.model.motion
        run = replace(
            imported.run_of_judgement(self, ", ".join(path.name for path in self.paths)),
            steps=max(len(verdict.truth) for verdict in self.verdicts),
            details={f"cause {n}": each.likeliest.words for n, each in enumerate(self.explanation.findings, start=1)},
            curves={verdict.name: verdict.curve(motion) for verdict in self.verdicts},
        )
        motions = (motion,) if isinstance(motion, CrankMotion) else ()
        request = CampaignRequest((linkage,), motions, run.conditions, (run.engine,))
        lines = [*imported.sentences(self), f"The crank's motion is taken from {self.motion_source}."]
        lines += [f"Not judged: column '{column.header}', for {reason}." for column, reason in self.imported.not_judged]
        save(Path(folder), {**saved_document(request, self.command), "judgement": lines}, [run])
        return write_site(Path(folder), processes=0)
