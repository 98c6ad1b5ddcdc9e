"""One page that holds a whole report, to mail: every page a section of it, all figures, scripts and data inside."""

from __future__ import annotations

import base64
import re
import tempfile
from collections.abc import Sequence
from dataclasses import fields, is_dataclass, replace
from pathlib import Path
from typing import Any, Final

from comparisons.runs.files import write_text
from reports.document import html
from reports.document.parts import Drawn, Figure, Link, Page, Paragraph, Section, Widget
from reports.site.contents import contents

PICTURE: Final = re.compile(r'<a class="picture"([^>]*?) href="[^"]*"><img src="([^"]*)"([^>]*)></a>')
SCRIPT: Final = re.compile(r'<script src="([^"]*)" defer></script>\n?')
STYLE: Final = re.compile(r'<link rel="stylesheet" href="([^"]*)">')
NAME: Final = re.compile(r'(?<=\bid=")[^"]+(?=")')


def write_single_file(saved: Path, file: Path) -> Path:
    """Write a page of all that ``saved`` holds; returns its path."""
    found = contents(saved)
    page = one_page([found.page(link.href) for link in found.links()])
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        html.write_assets(folder)
        html.write(page, folder, ())
        write_text(file, _whole(folder, page))
    return file


def one_page(pages: Sequence[Page]) -> Page:
    """Pages as sections of the first one; names and links are those of the page that they were on."""
    first, *rest = pages
    files = {page.file: _stem(page.file) for page in rest} | {first.file: "main"}
    sections = tuple(
        Section(
            _stem(page.file),
            page.heading,
            (Paragraph(page.subtitle, "small"), *_moved((*page.parts, *page.sections), _stem(page.file), files)),
        )
        for page in rest
    )
    parts, own = _moved((first.parts, first.sections), "", files)
    return replace(first, parts=parts, sections=(*own, *sections), charts=any(page.charts for page in pages))


def _stem(file: str) -> str:
    return re.sub(r"\W+", "-", Path(file).stem)


def _moved(found: Any, stem: str, files: dict[str, str]) -> Any:  # noqa: ANN401  any part of a page
    """A part of a page, with its names and links as they are on the one page."""
    if isinstance(found, tuple):
        return tuple(_moved(one, stem, files) for one in found)
    if not is_dataclass(found) or isinstance(found, type):
        return found
    values = {field.name: getattr(found, field.name) for field in fields(found)}
    values = {name: value for name, value in values.items() if name not in ("data", "further", "drawing")}
    changes = {name: _moved(value, stem, files) for name, value in values.items()}
    own = f"{stem}-" if stem else ""
    if isinstance(found, Link):
        file, _, place = found.href.partition("#")
        if file in files or not file:
            target = own if not file else f"{files[file]}-" if file != "index.html" else ""
            changes["href"] = f"#{target}{place}" if place else f"#{files[file]}"
    elif isinstance(found, Section):
        changes["key"] = own + found.key
    elif isinstance(found, (Figure, Widget)):
        changes["name"] = own + found.name
    if isinstance(found, (Drawn, Widget)):
        changes["markup"] = _renamed(found.markup, own)
    return replace(found, **changes)


def _renamed(markup: Any, own: str) -> Any:  # noqa: ANN401  Markup
    """Markup whose ids, and the classes and motions named after them, begin with the page that they were on."""
    for name in set(NAME.findall(markup)) if own else ():
        pattern = rf'((?:[#.":]|@keyframes )){re.escape(name)}(?=-\d|[^\w-])'
        markup = type(markup)(re.sub(pattern, rf"\g<1>{own}{name}", str(markup)))
    return markup


def _whole(folder: Path, page: Page) -> str:
    """The page with everything inside that a folder holds for it."""
    text = (folder / page.file).read_text(encoding="utf-8")
    data = sorted((folder / "data").rglob("*.js"))
    scripts = [folder / name for name in SCRIPT.findall(text)]
    code = "".join(f"<script>\n{_code(path)}</script>\n" for path in (*scripts, *data))
    text = STYLE.sub(lambda found: f"<style>\n{(folder / found[1]).read_text(encoding='utf-8')}</style>", text)
    text = PICTURE.sub(lambda found: _picture(folder / found[2], found[1], found[3]), SCRIPT.sub("", text))
    return text.replace("</body>", f"{code}</body>")


def _code(path: Path) -> str:
    return path.read_text(encoding="utf-8").replace("</script", r"<\/script")


def _picture(path: Path, style: str, attributes: str) -> str:
    packed = base64.b64encode(path.read_bytes()).decode("ascii")
    attributes = attributes.replace(' loading="lazy"', "")
    return f'<span class="picture"{style}><img src="data:image/svg+xml;base64,{packed}"{attributes}></span>'
