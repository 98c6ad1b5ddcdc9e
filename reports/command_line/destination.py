"""Where the results of a command go: the screen, JSON, files, a folder."""

from __future__ import annotations

import inspect
import io
import sys
import webbrowser
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager, nullcontext, redirect_stdout
from importlib import import_module
from itertools import chain
from pathlib import Path

from analytic.errors import LinkproofError
from comparisons.trials.runs.files import check_folder, check_writable
from reports.api.options import Announce, OutputOptions, changed, words
from reports.document.parts import Paragraph
from reports.document.study import PICTURES, Study, check_saves
from reports.document.terminal import harmless, show, write


class Destination(OutputOptions):
    """Options of output, with the methods that write and print accordingly."""

    def prepare(self, study: str, given: Iterable[object]) -> None:
        """Raise LinkproofError, before the work, for options of output that exclude each other or cannot be met.

        ``study`` is module:class, whose suffixes files may have. ``given`` are the values of the command's arguments,
        whose files no output may replace. Creates nothing that stays.
        """
        self._check_form()
        if self.quiet and self.verbose:
            raise LinkproofError("--quiet and --verbose exclude each other: leave one of them out")
        if self.opens and self.out is None:
            raise LinkproofError("--open shows the page that --out writes: name a folder with --out")
        if self.out is not None:
            check_folder(self.out)
            check_writable(self.out / "index.html")
        if self.save:
            module, _, name = study.partition(":")
            kind: type[Study] = getattr(import_module(module), name)
            read = [word for each in given for word in words(each) if isinstance(word, str | Path)]
            check_saves(self.save, kind.suffixes, read, self.out)

    def _check_form(self) -> None:
        """Raise LinkproofError for a --decimal other than . and , and for a comma or --figure without its file."""
        suffixes = {file.suffix.lower() for file in self.save}
        if self.decimal not in {".", ","}:
            raise LinkproofError(
                f"--decimal: expected . or , in the numbers of a .csv, got '{self.decimal}'; correct it"
            )
        if self.decimal == "," and ".csv" not in suffixes:
            raise LinkproofError("--decimal belongs to a table, and none is written: name a file with --save FILE.csv")
        if self.figure is not None and not suffixes & {*PICTURES}:
            raise LinkproofError("--figure needs a file: name a .svg, .png or .pdf with --save")

    def make(self, function: Callable[..., Study | None]) -> int:
        """Call the function, print its study and write its files; returns the exit code, 0 without a study.

        The function gets ``announce``, which shows the progress, if it takes it. With --json what engines in this
        process print goes to stderr. Raises what the function and ``emit`` raise.
        """
        with redirect_stdout(sys.stderr) if self.json else nullcontext():
            if "announce" not in inspect.signature(function).parameters:
                study = function()
            else:
                with progress(visible=not self.quiet) as announce:
                    study = function(announce=announce)
        return 0 if study is None else self.emit(study)

    def emit(self, study: Study) -> int:
        """Print a study with its warnings, write its files and name them; returns the exit code.

        Warnings and the names of files go to stderr. Opens its page if asked to. Raises LinkproofError for a study
        without content or one of which nothing could be judged, and for a file that cannot be written.
        """
        study.check_content()
        warnings = (f"warning: {text}" for text in dict.fromkeys(study.warnings))  # be the run quiet or not
        show(*(Paragraph(text, colour="yellow") for text in warnings), stderr=True)
        if self.verbose:
            self.tell(study.remark)
        if self.json:
            write_to_stdout(study.json())
        elif self.quiet:
            show(*study.brief(), *study.printout().closing)
        else:
            printout = study.printout()
            for part in chain(printout.tables, printout.details if self.verbose else ()):  # each as soon as it is made
                show(part)
            show(*printout.closing)
        given = changed(OutputOptions, vars(self))
        form = {name: given[name] for name in ("decimal", "figure") if name in given}
        for file in [*study.written, *study.save(*self.save, **form)]:
            self.tell(f"wrote {file}")
        code = study.exit_code
        if self.out is not None:
            page = study.write(self.out)
            self.tell(f"wrote {page}")
            if self.opens:
                webbrowser.open(page.resolve().as_uri())
        if not (self.quiet or self.json):
            show(*filter(None, [study.hint(self.save)]))
        return code

    def tell(self, text: str) -> None:
        """Print a remark on stderr, unless it is empty or the run is quiet."""
        if text and not self.quiet:
            show(text, stderr=True)


def write_to_stdout(text: str) -> None:
    """Write text to stdout, in UTF-8 whatever its character set."""
    if isinstance(sys.stdout, io.TextIOWrapper):
        sys.stdout.reconfigure(encoding="utf-8")
    write(text, sys.stdout)


@contextmanager
def progress(*, visible: bool = True) -> Iterator[Announce]:
    """A context whose value shows each begun run in a progress bar on stderr, or does nothing if that is no terminal.

    It does nothing either unless ``visible``. The value takes the label of a run, its number and the number of all.
    """
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
        """Show on the bar that the run of this label and number, of so many, has begun."""
        bar.start()
        bar.update(task, description=harmless(label), completed=number, total=total)

    try:
        yield announce
    finally:
        bar.stop()
