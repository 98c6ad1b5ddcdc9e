"""Where the results of a command go: the screen, JSON, a folder; what is unfinished in the folder."""

from __future__ import annotations

import inspect
import io
import sys
import webbrowser
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import AbstractContextManager, contextmanager, nullcontext, redirect_stdout
from importlib import import_module
from itertools import chain
from pathlib import Path
from typing import TYPE_CHECKING, Any

from analytic.errors import LinkproofError
from comparisons.trials.runs.files import check_folder, check_writable, write_file
from reports.api.options import OutputOptions, ResultsFiles
from reports.document.parts import Paragraph
from reports.document.study import NOTHING, Content, Study, check_saves
from reports.document.terminal import Printed, Printout, harmless, show, write

if TYPE_CHECKING:
    from analytic.description.linkage import Linkage
    from comparisons.trials.judging.changes import Change
    from comparisons.trials.judging.records import Run


Writers = Mapping[str, Callable[..., Content]]


class Destination(OutputOptions):
    """Options of output, with the methods that write and print accordingly."""

    def prepare(self, study: str, read: Mapping[str, Path], form: ResultsFiles | None) -> None:
        """Raise LinkproofError before the work for what cannot be written; ``study`` is the place of its class.

        ``read`` are the files that are read, by what they are.
        """
        if form is not None:
            form.check(self)
        if self.opens and self.out is None:
            raise LinkproofError("--open shows the page that --out writes: name a folder with --out")
        self.check("index.html")
        if self.save:
            module, _, name = study.partition(":")
            kind: type[Study] = getattr(import_module(module), name)
            check_saves(self.save, kind.suffixes, read, self.out)

    def make(self, function: Callable[..., Study], form: ResultsFiles | None) -> int:
        """Call the function, print and write its study; the exit code."""
        if "announce" not in inspect.signature(function).parameters:
            return self.emit(function(), form)
        with self.progress() as announce:
            study = function(announce=announce)
        return self.emit(study, form)

    def emit(self, study: Study, form: ResultsFiles | None = None) -> int:
        """Print a study and write its files, and say which; the exit code."""
        study.check_content()
        self.warn_of(study.warnings)
        if self.json:
            write_to_stdout(study.json())
        elif self.quiet:
            self.print(*study.brief(), *study.printout().closing)
        else:
            self.print_out(study.printout())
        for file in study.save(*self.save, **(vars(form) if form else {})):
            self.remark(f"wrote {file}")
        if self.out is not None:
            page = study.write(self.out)
            self.remark(f"wrote {page}")
            if self.opens:
                webbrowser.open(page.resolve().as_uri())
        hint = "" if self.quiet else study.hint(self.save)
        if hint:
            self.print(hint)
        return study.exit_code

    def check(self, file: str) -> None:
        """Raise LinkproofError before the work if options exclude each other or a file cannot be written.

        ``file`` is a file that will be written into the folder.
        """
        if self.quiet and self.verbose:
            raise LinkproofError("--quiet and --verbose exclude each other: leave one of them out")
        if self.junit is not None:
            check_writable(self.junit)
        if self.out is not None:
            check_folder(self.out)
            check_writable(self.out / file)

    def check_saves(self, writers: Writers, read: Mapping[str, Path] = NOTHING) -> None:
        """Raise LinkproofError before the work for a file of ``save`` that cannot be written."""
        check_saves(self.save, tuple(writers), read, self.out)

    def write_saves(self, writers: Writers, *facts: object) -> None:
        """Write the files of ``save`` whose suffixes have ``writers``, which are called with the ``facts``.

        Every content is made before the first file is written.
        """
        named = [(file, writers[file.suffix.lower()]) for file in self.save if file.suffix.lower() in writers]
        for file, content in [(file, make(*facts)) for file, make in named]:
            write_file(file, content)
            self.remark(f"wrote {file}")

    def progress(self) -> AbstractContextManager[Callable[[str, int, int], None]]:
        """A progress bar, if it is to be seen."""
        return progress(visible=not self.quiet)

    def own_stdout(self) -> AbstractContextManager[object]:
        """Send the output of engines in this process to stderr if stdout is for JSON."""
        return redirect_stdout(sys.stderr) if self.json else nullcontext()

    def print(self, *parts: Printed) -> None:
        """Print, unless stdout is for JSON."""
        if not self.json:
            show(*parts)

    def print_out(self, printout: Printout) -> None:
        """Print as much as requested."""
        for part in chain(() if self.quiet else printout.tables, printout.details if self.verbose else ()):
            self.print(part)  # each as it comes: there may be many
        self.print(*printout.closing)

    def write_pages(self, processes: int | None = None) -> None:
        """Write the pages of the folder from its data and print their place; does nothing without a folder.

        A command calls it last. Raises LinkproofError where they cannot be written; the results are saved.
        """
        if self.out is None:
            return
        from reports.site import write_site  # noqa: PLC0415  figures cost seconds that a table does not pay

        try:
            self.remark(f"report: {write_site(self.out, processes=processes)}")
        except LinkproofError as error:
            raise LinkproofError(f"the results are saved in '{self.out}', but no pages are written: {error}") from error

    def write_json(self, document: Mapping[str, Any]) -> None:
        """Print JSON if requested, in UTF-8 whatever the character set of stdout."""
        if self.json:
            from comparisons.trials.runs.store import to_json  # noqa: PLC0415 - a table needs none of it

            write_to_stdout(to_json(document))

    def write_junit(self, runs: Iterable[Run], changes: Sequence[Change]) -> None:
        """Write the errors of runs, and what has changed, as test cases, if requested."""
        if self.junit is not None:
            from reports.campaign.summary import junit  # noqa: PLC0415

            write_file(self.junit, junit(runs, changes))
            self.remark(f"wrote {self.junit}")

    def warn(self, linkages: Iterable[Linkage], *sentences: str) -> None:
        """Print likely mistakes in the files of linkages, and further warnings, on stderr, be the run quiet or not."""
        from comparisons.designer.linkage_check import warnings  # noqa: PLC0415 - what completes a word needs none

        self.warn_of([*filter(None, sentences), *(text for linkage in linkages for text in warnings(linkage))])

    def warn_of(self, sentences: Iterable[str]) -> None:
        """Print warnings on stderr, be the run quiet or not."""
        show(*(Paragraph(f"warning: {text}", colour="yellow") for text in dict.fromkeys(sentences)), stderr=True)

    def remark(self, text: str) -> None:
        """Print a remark on stderr, unless it is empty or the run quiet."""
        if text and not self.quiet:
            show(text, stderr=True)


def write_to_stdout(text: str) -> None:
    """Write data to stdout, in UTF-8 whatever its character set."""
    if isinstance(sys.stdout, io.TextIOWrapper):
        sys.stdout.reconfigure(encoding="utf-8")
    write(text, sys.stdout)


@contextmanager
def progress(*, visible: bool = True) -> Iterator[Callable[[str, int, int], None]]:
    """A function that shows a run by its label, its number and the number of all runs; the bar starts at the first."""
    if not (visible and sys.stderr.isatty()):
        yield lambda *_: None
        return
    from rich.console import Console  # noqa: PLC0415  a pipe needs none of it
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn  # noqa: PLC0415

    label_column = TextColumn("{task.description}", markup=False)
    columns = (label_column, BarColumn(), MofNCompleteColumn(), TimeElapsedColumn())
    bar = Progress(*columns, console=Console(stderr=True, markup=False), transient=True)
    task = bar.add_task("", total=None)

    def announce(label: str, number: int, total: int) -> None:
        bar.start()
        bar.update(task, description=harmless(label), completed=number, total=total)

    try:
        yield announce
    finally:
        bar.stop()
