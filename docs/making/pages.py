"""What MkDocs makes of these pages: README as the first one, tables from their data, files' names over their blocks.

In place of README's picture the first page has the same linkage as ``results --out`` writes it, which can be pulled at.
"""

from __future__ import annotations

import inspect
import re
from collections.abc import Iterator, Mapping
from dataclasses import is_dataclass
from functools import cached_property
from importlib import import_module, util
from pathlib import Path
from typing import Any

from analytic.description.json_schema import json_schema
from comparisons.trials.judging.limits import Limit, shipped_limits
from comparisons.trials.runs.files import STORE
from reports.document.markdown import table
from reports.document.numbers import bound
from reports.document.parts import Mono, Table, Words

ROOT = Path(__file__).parents[2]
SHOWN = {"README.md": "index.md", "CONTRIBUTING.md": "contributing.md", "CHANGELOG.md": "changelog.md",
         "reports/RESULTS.md": "results.md"}  # fmt: skip
NAMED_BLOCK = re.compile(r"^```(\w+) (\S+)$", re.MULTILINE)
FILE_NAME = re.compile(r"\[(?:docs/)?([\w-]+)\.md\](?=\()")
LIVING, FOLDER = "coupler-curve", "living"
PICTURE = re.compile(r"<img [^>]*moving\.svg[^>]*>")
FRAME = (
    f'<iframe src="{FOLDER}/index.html" title="The crank-rocker {LIVING} in motion: pull its points" loading="lazy" '
    'style="width: 100%; height: 36rem; border: 0"></iframe>'
)
LINK = re.compile(r"(\]\(|src=\")(?:\.\./)?(?:docs/)?([^)#:\"]+)")


def on_config(config: Any) -> Any:  # noqa: ANN401 - MkDocs need not be installed
    """Leave pages that do not exist out of the navigation."""
    config.nav = [entry for entry in map(_existing, config.nav) if entry]
    return config


def _existing(entry: Any) -> Any:  # noqa: ANN401 - nested lists of dictionaries
    if isinstance(entry, str):
        return entry if entry in SHOWN.values() or (ROOT / "docs" / entry).exists() else None
    ((title, below),) = entry.items()
    kept = [one for one in map(_existing, below) if one] if isinstance(below, list) else _existing(below)
    return {title: kept} if kept else None


def on_files(files: Any, config: Any) -> Any:  # noqa: ANN401
    """Add the pages that lie outside of the folder."""
    from mkdocs.structure.files import File  # noqa: PLC0415 - the tables need no MkDocs

    for source, page in SHOWN.items():
        files.append(File.generated(config, page, content=(ROOT / source).read_text(encoding="utf-8")))
    return files


def on_post_build(config: Any, **_: Any) -> None:  # noqa: ANN401
    """Write the folder of the first page's linkage."""
    folder = Path(config.site_dir) / FOLDER
    import_module("linkproof").results(LIVING).write(folder)
    (folder / STORE).unlink()


def on_page_markdown(markdown: str, page: Any, **_: Any) -> str:  # noqa: ANN401
    """A page's text with its links, the names of its files and what is made from data."""
    if page.file.src_uri == SHOWN["README.md"]:
        markdown = PICTURE.sub(FRAME, markdown)
    markdown = FILE_NAME.sub(lambda name: f"[{name[1].replace('-', ' ')}]", markdown)
    text = NAMED_BLOCK.sub(r'```\1 title="\2"', LINK.sub(lambda link: link[1] + SHOWN.get(link[2], link[2]), markdown))
    made = MADE.get(page.file.src_uri)
    return f"{text}\n\n{made()}\n" if made else text


def limits() -> str:
    """The table of limits that comes with the suite."""
    head = ("quantities", "settings", "regimes", "engines", "limit", "reason")
    return table(Table("", head, tuple(map(_limit, shipped_limits().rows)), align="llllrl"))


def _limit(row: Limit) -> tuple[str, ...]:
    names = (row.quantities, row.settings, row.regimes, row.engines)
    return (*(", ".join(sorted(one)) or "all" for one in names), bound(row.value), row.reason)


def keys() -> str:
    """Every key of a linkage file, a table for the file and one for each kind of table in it."""
    schema = json_schema()
    tables = {"TheWholeFile": schema} | {
        name: part for name, part in schema["definitions"].items() if not name.startswith("Variant")
    }
    return "\n\n".join(f"### {_title(name)}\n\n{_keys(part)}" for name, part in tables.items())


def _title(name: str) -> str:
    return " ".join(re.findall(r"[A-Z][a-z]*", name.removesuffix("Table"))).capitalize()


def _keys(part: Mapping[str, Any]) -> str:
    needed = part.get("required", ())
    rows = tuple(
        (Mono(key), "needed" if key in needed else _default(value), words(value.get("description", "")))
        for key, value in part["properties"].items()
    )
    about = part.get("description", "").partition("\n\n")[0]
    return table(Table(words(about), ("key", "default", "what is expected"), rows, align="l"))


def _default(value: Mapping[str, Any]) -> Words:
    default = value.get("default")
    return "" if default in (None, "", [], {}) or isinstance(default, dict) else Mono(str(default))


def words(text: str) -> Words:
    """A text whose parts between double backticks are code."""
    return tuple(Mono(part) if number % 2 else part for number, part in enumerate(text.split("``")))


def reference() -> str:
    """Every name that ``import linkproof`` offers, from its docstring."""
    if util.find_spec("linkproof") is None:
        return ""
    package = import_module("linkproof")
    return "\n\n".join(["## Reference", *_documented(package, "linkproof", 3)])


def _documented(place: Any, within: str, level: int) -> Iterator[str]:  # noqa: ANN401 - a module or a class
    """What a module announces, or a class offers, in the order of the alphabet."""
    for name in sorted(getattr(place, "__all__", vars(place))):
        thing = getattr(place, name)
        is_value = isinstance(thing, property | cached_property)
        is_module = inspect.ismodule(thing) and inspect.ismodule(place)  # not one that a class works with
        if name.startswith("_") or not (inspect.isroutine(thing) or inspect.isclass(thing) or is_module or is_value):
            continue
        called = not is_value and (inspect.isroutine(thing) or is_dataclass(thing))
        signature = f"```python\n{_signature(name, thing)}\n```\n\n" if called else ""
        text = (inspect.getdoc(thing) or "").replace("``", "`").replace(":class:", "")
        yield f"{'#' * level} `{within}.{name}`\n\n{signature}{text}"
        if inspect.ismodule(thing) or (inspect.isclass(thing) and within == "linkproof"):
            yield from _documented(thing, f"{within}.{name}", level + 1)


def _signature(name: str, function: Any) -> str:  # noqa: ANN401 - any function, or a class by its fields
    given = [one for one in inspect.signature(function).parameters.values() if one.name != "self"]
    lines = [re.sub(r"'|<factory>", lambda found: "" if found[0] == "'" else "…", f"    {one},\n") for one in given]
    return f"{name}(\n{''.join(lines)})" if lines else f"{name}()"


MADE = {"quantities.md": limits, "linkage-files.md": keys, "python.md": reference}
