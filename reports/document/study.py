"""The result of a function of ``linkproof``: printed, drawn, saved and judged in one way, whatever made it."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Mapping, Sequence
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar, Final

from markupsafe import escape

from analytic.errors import LinkproofError, install_words
from comparisons.trials.runs.files import check_writable, write_file
from reports.document.terminal import Printed, Printout, rendered

if TYPE_CHECKING:
    import pandas
    from matplotlib.figure import Figure

# What is saved by the suffix of a file: a text, bytes, or a function that fills the file at a path.
Content = str | bytes | Callable[[Path], object]
PICTURES: Final = (".svg", ".png", ".pdf")
# Packages that write the files of a suffix, each in an extra of the suffix's name.
PACKAGES: Final = {".xlsx": "openpyxl", ".dxf": "ezdxf"}


class Study:
    """A result with the output of its command; ``suffixes`` are those of the files that it can be saved to.

    ``repr`` is a line; ``str`` and a notebook have what the command prints.
    """

    suffixes: ClassVar[tuple[str, ...]] = (".json",)
    exit_code: int = 0
    """The exit code of the command; a study of which nothing could be judged raises LinkproofError here."""
    remark: str = ""
    """What a verbose command adds on stderr."""
    written: tuple[Path, ...] = ()
    """The files that the function has written."""

    def printout(self) -> Printout:
        """The output of the command; each study has its own, else raises NotImplementedError."""
        raise NotImplementedError

    def to_dict(self) -> Mapping[str, Any]:
        """The data that the command prints as JSON; each study has its own, else raises NotImplementedError."""
        raise NotImplementedError

    def json(self) -> str:
        """The output of ``to_dict`` as indented JSON text; raises ValueError for a number that is not finite."""
        from comparisons.trials.runs.store import to_json  # noqa: PLC0415 - a table needs none of it

        return to_json(self.to_dict())

    def brief(self) -> Sequence[Printed]:
        """The parts that a quiet command prints above the closing lines; () by default."""
        return ()

    def sentence(self) -> Printed:
        """The outcome in a sentence: the first brief part, or else the last closing line; IndexError without either."""
        return next(iter(self.brief()), None) or self.printout().closing[-1]

    @property
    def warnings(self) -> Sequence[str]:
        """Sentences on likely mistakes in the files, and on what a reader of the values has to know; () by default."""
        return ()

    @property
    def ok(self) -> bool:
        """Whether the command would exit with 0."""
        return self.exit_code == 0

    def check_content(self) -> None:
        """Raise LinkproofError where there is nothing to show; by default, do nothing."""

    def failures(self) -> Iterable[str]:
        """A line for every result that makes ``check`` fail; () by default."""
        return ()

    def check(self) -> Study:
        """The study itself if it is ``ok``; raises AssertionError with the ``failures`` if it is not."""
        __tracebackhide__ = True  # pytest shows the line of the test
        if self.ok:
            return self
        raise AssertionError("\n".join(self.failures()))

    def plot(self, *_: Any, **__: Any) -> Figure:  # noqa: ANN401 - of each study its own
        """A figure of matplotlib; its arguments differ from study to study. By default raises LinkproofError."""
        raise LinkproofError(f"a {type(self).__name__} has no picture: print it")

    def rows(self) -> Sequence[Mapping[str, Any]]:
        """The rows of its table, a mapping by the names of the columns each; by default ``to_dict`` alone."""
        return [self.to_dict()]

    def to_pandas(self) -> pandas.DataFrame:
        """A DataFrame of ``rows``, a column for each of their fields."""
        import pandas as pd  # noqa: PLC0415  half a second that results alone do not pay

        return pd.DataFrame(self.rows())

    def content(self, suffix: str, *_: Any, **form: Any) -> Content:  # noqa: ANN401 - of each study its own
        """The content of a file with this suffix, such as ".svg": a picture of ``plot``, else the JSON text.

        ``form`` goes to ``plot`` as keywords; raises LinkproofError where the study has no picture.
        """
        if suffix in PICTURES:
            from reports.charts.draw import picture  # noqa: PLC0415 - a second that other files save

            return picture(self.plot(**form), suffix.removeprefix("."))
        return self.json()

    def save(self, *files: str | Path, **form: Any) -> list[Path]:  # noqa: ANN401 - of each study its own
        """Write files in the formats of their suffixes, once every content is made; returns their paths.

        ``form`` goes to ``content`` as keywords. Raises LinkproofError for a suffix that the study lacks and for a file
        that cannot be written.
        """
        paths = [Path(file) for file in files]
        check_saves(paths, self.suffixes)
        for path, content in [(path, self.content(path.suffix.lower(), **form)) for path in paths]:
            write_file(path, content)
        return paths

    def write(self, folder: str | Path) -> Path:
        """Write records and pages into a folder; returns the path of the page to open.

        By default raises LinkproofError.
        """
        raise LinkproofError(f"a {type(self).__name__} has no pages: save a file, not '{folder}'")

    def hint(self, _saved: Sequence[Path]) -> str:
        """A sentence on the user's next step, given the files ``_saved``; "" for none."""
        return ""

    def __repr__(self) -> str:
        """A line: the kind of result and the outcome."""
        return f"<{type(self).__name__}: {rendered(self.sentence()).strip()}>"

    def __str__(self) -> str:
        """The output of the command as plain text, without details."""
        printed = self.printout()
        return rendered(*printed.tables, *printed.closing).strip("\n")

    def _repr_html_(self) -> str:
        """The printed study for a notebook, as preformatted HTML."""
        return f"<pre>{escape(str(self))}</pre>"


def check_saves(
    files: Iterable[Path], suffixes: Sequence[str], read: Iterable[str | Path] = (), made: Path | None = None
) -> None:
    """Raise LinkproofError for a file of ``--save`` that cannot be written, as where its folder is missing.

    So too for one twice, one without its package, one that is read, and one whose suffix is not among the ``suffixes``;
    any will do if there are none. ``read`` are the files to read, among other words; ``made`` is a folder that will be
    there.
    """
    places, read_places = dict[str, Path](), {os.path.realpath(word) for word in read}
    for file in files:
        check_file("--save", file, suffixes, made)
        place = os.path.realpath(file)
        if place in places:
            raise LinkproofError(f"--save {places[place]} and --save {file} are the same file: leave one out")
        places[place] = file
        if place in read_places:
            raise LinkproofError(f"--save {file} would take the place of a file that is read: give another name")
        suffix = file.suffix.lower()
        package = PACKAGES.get(suffix)
        if package is not None and find_spec(package) is None:
            raise LinkproofError(
                f"--save {file}: expected {package}, got none: install it with: "
                f"{install_words(suffix.removeprefix('.'))}"
            )


def check_file(option: str, file: Path, suffixes: Sequence[str] = (), made: Path | None = None) -> None:
    """Raise LinkproofError for a file of an option that cannot be written or has none of the ``suffixes``.

    Any suffix will do if there are none. ``option`` names it in the message; ``made`` is a folder that will be there.
    """
    if suffixes and file.suffix.lower() not in suffixes:
        one = f"one of {', '.join(suffixes)}" if len(suffixes) > 1 else suffixes[0]
        raise LinkproofError(f"{option} {file}: the suffix must be {one}; rename the file")
    if not os.path.lexists(file.parent) and file.parent != made:
        raise LinkproofError(f"{option} {file}: the folder '{file.parent}' does not exist; make it, or name another")
    check_writable(file)
