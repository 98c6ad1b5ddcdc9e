"""A page as HTML, with its figures and data as files beside it: nothing is fetched, so a page works from a disk."""

from __future__ import annotations

import json
import re
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Final, NamedTuple

from markupsafe import Markup, escape

from comparisons.trials.runs.files import write_file
from reports.document.parts import Mono, Page, PageFigure, PageLink, Widget, Words
from reports.document.templates import FOLDER, render

STYLE, SCRIPTS, PLOTLY, FIRST = "linkproof.css", "linkproof.js", "plotly-basic.min.js", "boot.js"
# A page may load the files of its own folder, on a disk or a server, and what its own scripts make, but no others.
POLICY: Final = (
    "default-src 'none'; script-src 'self' file: blob:; style-src 'self' file: 'unsafe-inline'; "
    "img-src 'self' file: data: blob:; base-uri 'none'; form-action 'none'"
)
PIXELS: Final = 96  # of a style sheet, an inch
UNBROKEN: Final = re.compile(r"(?<=\d) (?=[A-Za-z%°])|(?<=\bN) (?=mm?\b)|(?<=g) (?=mm?²)")  # a value and its unit
POWER: Final = re.compile(r"\d[\d.]*e-\d+")  # a number that a line may not end in
ELSEWHERE: Final = re.compile(r"#|[a-z][a-z0-9+.-]*:")  # a link that leaves the report's folder, or stays on its page


class Picture(NamedTuple):
    """A figure as a page shows it: where its file is, its size in CSS pixels, whether it is as wide as the page."""

    source: str
    width: int
    height: int
    wide: bool


def write(page: Page, folder: Path, pages: Sequence[PageLink]) -> list[str]:
    """Write a page into a report's folder, with its figures and the further data of its widgets.

    Returns the files' names within the folder, the page's first. ``pages`` are links to the report's pages, for its
    menu. Raises LinkproofError for a file that cannot be written, ValueError for a number of a widget that is not
    finite.
    """
    files = _PageFiles(folder, page)
    policy = Markup(f"{POLICY}; connect-src 'self'" if page.state else POLICY)  # a page that follows a file
    write_file(folder / page.file, render("page.html", page=page, pages=pages, files=files, policy=policy))
    return [page.file, *files.names]


def write_assets(folder: Path) -> None:
    """Write the files that all pages of a report share, style sheet, scripts and Plotly, into ``folder``/assets.

    That is made if missing. Raises LinkproofError for a file that cannot be written.
    """
    assets, scripts = folder / "assets", FOLDER / "scripts"
    files = sorted(scripts.glob("*.js"), key=lambda file: (file.name != FIRST, file.name))
    write_file(assets / STYLE, (FOLDER / STYLE).read_text(encoding="utf-8"))
    write_file(assets / SCRIPTS, "\n".join(file.read_text(encoding="utf-8") for file in files if file.name != PLOTLY))
    write_file(assets / PLOTLY, (scripts / PLOTLY).read_bytes())


@dataclass(frozen=True)
class _PageFiles:
    """The functions of a page's template: words as markup; figures and data, which are written as files."""

    folder: Path
    page: Page
    names: list[str] = field(default_factory=list)

    @property
    def root(self) -> str:
        """The relative path from the page to the report's folder: "" or some "../"."""
        return "../" * self.page.file.count("/")

    def inline(self, words: Words) -> Markup:
        """Words as HTML markup, everything in them escaped; a value and its unit stay on one line.

        A link to another file of the report is made relative to this page.
        """
        match words:
            case tuple():
                return Markup("").join(map(self.inline, words))
            case PageLink(text, href):
                place = href if ELSEWHERE.match(href) else self.root + href
                return Markup('<a href="{}">{}</a>').format(place, text)
            case Mono(text):
                return Markup("<code>{}</code>").format(text)
        text = escape(UNBROKEN.sub("\N{NO-BREAK SPACE}", words))
        return Markup(POWER.sub(r'<span class="whole">\g<0></span>', str(text))) if " " in words else text

    def json(self, data: object) -> Markup:
        """JSON text, as markup, that may stand in a script; raises ValueError for a number that is not finite."""
        text = json.dumps(data, ensure_ascii=False, allow_nan=False, separators=(",", ":"))
        return Markup(text.replace("<", "\\u003c").replace("\u2028", "\\u2028").replace("\u2029", "\\u2029"))

    def data(self, widget: Widget) -> str:
        """Write a widget's further data, a script file each; returns the address of the folder with this page's data.

        It is relative to the page. Raises LinkproofError for a file that cannot be written, ValueError for a number
        that is not finite.
        """
        folder = f"data/{Path(self.page.file).stem}/"
        for key, data in widget.further.items():
            name = f"{widget.name}.{key}"
            code = data if isinstance(data, str) else self.json(data)
            write_file(self._file(f"{folder}{name}.js"), f"linkproof.loaded({self.json(name)}, {code});\n")
        return self.root + folder

    def picture(self, figure: PageFigure) -> Picture:
        """Draw a figure into an SVG file of the page; returns the picture with its address and size.

        Raises LinkproofError for a file that cannot be written.
        """
        from reports.charts import draw  # noqa: PLC0415  a page without figures needs no matplotlib

        drawing = figure.drawing()
        name = f"figures/{Path(self.page.file).stem}/{figure.name}"
        write_file(self._file(f"{name}.svg"), draw.svg(drawing))
        width, height = (round(PIXELS * inches) for inches in drawing.get_size_inches())
        return Picture(f"{self.root}{name}.svg", width, height, draw.is_wide(drawing))

    def _file(self, name: str) -> Path:
        """The path of a file, ``name`` within the report's folder; its name is added to those written."""
        self.names.append(name)
        return self.folder / name
