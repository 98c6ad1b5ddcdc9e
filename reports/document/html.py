"""A page as HTML, with its figures and data as files beside it: nothing is fetched, so a page works from a disk."""

from __future__ import annotations

import json
import re
import shutil
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import NamedTuple

from markupsafe import Markup, escape

from comparisons.runs.files import write_text
from reports.document.chart import Chart
from reports.document.parts import Figure, Link, Mono, Page, Widget, Words
from reports.document.templates import FOLDER, render

PLOTLY = "plotly-basic.min.js"
PIXELS = 96  # of a style sheet, an inch
LINKPROOF = ("linkproof.css", "linkproof.js")
# A link that leaves the report's folder, or stays on its page.
ELSEWHERE = re.compile(r"#|[a-z][a-z0-9+.-]*:")


class Picture(NamedTuple):
    """A figure as a page shows it: where its file is, its size in CSS pixels, and its axes' edges, shares of the width.

    ``edges`` is empty where the figure has no axis that a page may point at.
    """

    source: str
    width: int
    height: int
    edges: tuple[float, ...] = ()


Pictures = Callable[[Figure], Picture]


def write(page: Page, folder: Path, pages: Sequence[Link], *, png: bool = False) -> Path:
    """Write a page into a report's folder, with its figures and the further data of its widgets; returns its path.

    ``pages`` are the report's pages; ``png`` writes every figure as a picture of dots too.
    """
    for widget in widgets(page):
        for key, data in widget.further.items():
            name = f"{widget.name}.{key}"
            text = f"linkproof.loaded({_json(name)}, {_json(data)});\n"
            write_text(folder / "data" / _stem(page) / f"{name}.js", text)
    write_text(folder / page.file, text_of(page, pages, partial(_drawn, folder, page, png)))
    return folder / page.file


def text_of(page: Page, pages: Sequence[Link], picture: Pictures) -> str:
    """The page's HTML; ``picture`` draws a figure and says where it is, as a path within the report's folder."""
    root = "../" * page.file.count("/")
    words = {
        "inline": partial(inline, root=root),
        "picture": picture,
        "json": lambda data: Markup(_json(data)),
        "data": f"{root}data/{_stem(page)}/",
        "root": root,
    }
    return str(render("page.html", page=page, pages=pages, words=words))


def write_assets(folder: Path) -> None:
    """Write what all pages of a report share: style sheet, scripts, Plotly."""
    assets = folder / "assets"
    style, scripts = LINKPROOF
    write_text(assets / style, (FOLDER / style).read_text(encoding="utf-8"))
    write_text(assets / scripts, own_scripts())
    if not (assets / PLOTLY).exists():
        shutil.copyfile(FOLDER / "scripts" / PLOTLY, assets / PLOTLY)


def own_scripts() -> str:
    """The project's own scripts one after the other, the one that starts the others first."""
    files = sorted((FOLDER / "scripts").glob("*.js"), key=lambda file: (file.name != "boot.js", file.name))
    return "\n".join(file.read_text(encoding="utf-8") for file in files if file.name != PLOTLY)


def inline(words: Words, root: str = "") -> Markup:
    """Words as markup; ``root`` leads from the page to the report's folder."""
    if isinstance(words, tuple):
        return Markup("").join(inline(word, root) for word in words)
    match words:
        case Link(text, href):
            return Markup('<a href="{}">{}</a>').format(href if ELSEWHERE.match(href) else root + href, text)
        case Mono(text):
            return Markup("<code>{}</code>").format(text)
    return escape(words)


def widgets(found: object) -> Iterator[Widget]:
    """Every widget of a page or of anything on it."""
    if isinstance(found, Widget):
        yield found
    elif isinstance(found, tuple):
        for one in found:
            yield from widgets(one)
    else:
        for name in ("parts", "cards", "sections"):
            yield from widgets(getattr(found, name, ()))


def _drawn(folder: Path, page: Page, png: bool, figure: Figure) -> Picture:
    """Draw a figure into its files."""
    from reports.charts import draw  # noqa: PLC0415  a page without figures needs no matplotlib

    chart = figure.drawing
    edges: tuple[float, ...] = ()
    if isinstance(chart, Chart):
        chart = replace(chart, wide=figure.wide)
        edges = draw.edges(chart) if chart.axis else ()
    drawing = draw.figure(chart) if isinstance(chart, Chart) else chart()
    path = folder / "figures" / _stem(page) / f"{figure.name}.svg"
    write_text(path, draw.svg(drawing))
    if png:
        path.with_suffix(".png").write_bytes(draw.png(drawing))
    width, height = drawing.get_size_inches() * PIXELS
    return Picture(path.relative_to(folder).as_posix(), round(width), round(height), edges)


def _stem(page: Page) -> str:
    return Path(page.file).stem


def _json(data: object) -> str:
    """JSON that may stand in a script of a page."""
    text = json.dumps(data, ensure_ascii=False, allow_nan=False, separators=(",", ":"))
    return text.replace("<", "\\u003c").replace("\u2028", "\\u2028").replace("\u2029", "\\u2029")
