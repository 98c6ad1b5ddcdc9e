"""A whole report in a single page, to mail: every page is a section, all figures, scripts and data are inside."""

from __future__ import annotations

import re
import tempfile
from base64 import b64encode
from collections.abc import Sequence
from dataclasses import fields, is_dataclass, replace
from hashlib import sha256
from pathlib import Path
from typing import Any, Final

from comparisons.runs.files import write_text
from engines.contract import Setting
from reports.document import html
from reports.document.parts import Drawn, Page, PageFigure, PageLink, Paragraph, Section, Widget
from reports.document.templates import sentence
from reports.site.site import Contents

PICTURE: Final = re.compile(r'<a class="picture"([^>]*?) href="[^"]*"><img src="([^"]*)"([^>]*)></a>')
SCRIPT: Final = re.compile(r'<script src="([^"]*)" defer></script>\n?')
STYLE: Final = re.compile(r'<link rel="stylesheet" href="([^"]*)">')
NAME: Final = re.compile(r'(?<=\bid=")[^"]+(?=")')
FILES: Final = "'self' file:"  # where scripts come from, in the policy of a page in a folder: the first of it
MAIN: Final = "main"  # the anchor of the first page
MAILED_SETTINGS: Final = frozenset({Setting.TUNED.value, Setting.BEST.value})  # whose curves are mailed


def write_single_file(saved: Path, file: Path) -> Path:
    """Write a page of all data in ``saved``; returns its path."""
    contents = Contents(saved)
    links = contents.links()
    page = joined_page([contents.page(link.href) for link in links])
    places = [PageLink(link.text, f"#{_anchor(link.href) if number else MAIN}") for number, link in enumerate(links)]
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        html.write_assets(folder)
        html.write(page, folder, places)
        write_text(file, _inline_files(folder, page))
    return file


def joined_page(pages: Sequence[Page]) -> Page:
    """Pages as sections of the first page, with names and links changed so that they stay unique."""
    first, *rest = pages
    files = {first.file: "", **{page.file: _anchor(page.file) for page in rest}}
    moved = {page.file: _rename_parts((*page.parts, *page.sections), files[page.file], files) for page in rest}
    sections = (
        Section(files[page.file], page.heading, (Paragraph(page.subtitle, "small"), *moved[page.file])) for page in rest
    )
    parts, first_sections = _rename_parts((first.parts, first.sections), "", files)
    return replace(first, parts=parts, sections=(*first_sections, *sections), charts=any(page.charts for page in pages))


def _anchor(file: str) -> str:
    """The anchor of a page's section on the joined page: the file name without suffix, other signs as hyphens."""
    return re.sub(r"\W+", "-", Path(file).stem)


def _rename_parts(result: Any, stem: str, files: dict[str, str]) -> Any:  # noqa: ANN401  any part of a page
    """A part of a page, with its names and links changed for the joined page."""
    if isinstance(result, tuple):
        return tuple(_rename_parts(entry, stem, files) for entry in result)
    if not is_dataclass(result) or isinstance(result, type):
        return result
    names = ("data", "further", "drawing")
    values = {field.name: getattr(result, field.name) for field in fields(result)}
    changes = {name: _rename_parts(value, stem, files) for name, value in values.items() if name not in names}
    prefix = f"{stem}-" if stem else ""
    if isinstance(result, PageLink):
        file, _, place = result.href.partition("#")
        if file in files or not file:
            target = files.get(file, stem)
            changes["href"] = f"#{'-'.join(filter(None, (target, place))) or MAIN}"
    elif isinstance(result, Section):
        changes["key"] = prefix + result.key
    elif isinstance(result, (PageFigure, Widget)):
        changes["name"] = prefix + result.name
    if isinstance(result, (Drawn, Widget)):
        changes["markup"] = _rename_ids(result.markup, prefix)
    moved = replace(result, **changes)
    return _with_few_curves(moved) if isinstance(moved, Widget) and moved.kind == "curves" else moved


def _with_few_curves(widget: Widget) -> Widget:
    """The chart with only the curves of its first regime at tuned and best, to save space; all errors stay."""
    data, number = widget.data, widget.data["first"].partition("-")[0]
    few = {key: curves for key, curves in widget.further.items() if key.partition("-")[0] == number}
    settings = MAILED_SETTINGS & {*data["settings"]} or {*data["settings"]}
    shown = data["regimes"][int(number or 0)]["name"]
    regimes = [
        {
            **entry,
            "quantities": [
                {**name, "curves": name["curves"] and entry["name"] == shown} for name in entry["quantities"]
            ],
        }
        for entry in data["regimes"]
    ]
    words = sentence("few_curves", regime=shown, settings=sorted(settings, reverse=True))
    changes = {"regimes": regimes, "curves": _runs_at_settings(data["curves"], settings), "left_out": words}
    further = {key: _runs_at_settings(curves, settings) for key, curves in few.items()}
    return replace(widget, data={**data, **changes}, further=further, instead=())


def _runs_at_settings(curves: Any, settings: set[str] | frozenset[str]) -> Any:  # noqa: ANN401  JSON
    return curves and {**curves, "runs": [run for run in curves["runs"] if run["setting"] in settings]}


def _rename_ids(markup: Any, prefix: str) -> Any:  # noqa: ANN401  Markup
    """Markup whose ids, with the classes and motions named after them, begin with a ``prefix``."""
    for name in set(NAME.findall(markup)) if prefix else ():
        pattern = rf'((?:[#.":]|@keyframes )){re.escape(name)}(?=-\d|[^\w-])'
        markup = type(markup)(re.sub(pattern, rf"\g<1>{prefix}{name}", str(markup)))
    return markup


def _inline_files(folder: Path, page: Page) -> str:
    """The page with everything inside that a folder holds for it."""
    text = (folder / page.file).read_text(encoding="utf-8")
    data = sorted((folder / "data").rglob("*.js"))
    scripts = [folder / name for name in SCRIPT.findall(text)]
    codes = [f"\n{_script_text(path)}" for path in (*scripts, *data)]
    digests = (b64encode(sha256(code.encode()).digest()).decode() for code in codes)
    text = text.replace(FILES, " ".join(f"'sha256-{digest}'" for digest in digests), 1)
    code = "".join(f"<script>{code}</script>\n" for code in codes)
    text = STYLE.sub(lambda match: f"<style>\n{(folder / match[1]).read_text(encoding='utf-8')}</style>", text)
    text = PICTURE.sub(lambda match: _picture(folder / match[2], match[1], match[3]), SCRIPT.sub("", text))
    return text.replace("</body>", f"{code}</body>")


def _script_text(path: Path) -> str:
    return path.read_text(encoding="utf-8").replace("</script", r"<\/script")


def _picture(path: Path, style: str, attributes: str) -> str:
    """A drawing inside the page."""
    data = b64encode(path.read_bytes()).decode()
    return f'<span class="picture"{style}><img src="data:image/svg+xml;base64,{data}"{attributes}></span>'
