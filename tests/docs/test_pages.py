"""The documentation: a complete site that loads nothing from a network, with the tables and names of the program."""

import re
import subprocess
import sys
from pathlib import Path

import pytest

import linkproof
from analytic.description.json_schema import json_schema
from comparisons.trials.judging.limits import shipped_limits
from docs.making.pages import FOLDER, keys, limits, reference
from docs.making.tables import renewed
from tests.pages.browser import PATIENCE
from tests.sources import PACKAGES

ROOT = Path(__file__).parents[2]
LOADED = re.compile(r"<(?:script|img|iframe|source)[^>]* src=\"?([^\" >]+)|<link[^>]* href=\"?([^\" >]+)")
COUNT = re.compile(r"(?<=\| )[\d,]+(?= \| (?:nothing|layers? 1)[ ,])")
FONTS = re.compile(r"url\((https?:[^)]+)\)|@import")


@pytest.fixture(scope="module")
def site(tmp_path_factory):
    """The built site."""
    pytest.importorskip("material", reason="the documentation is built with linkproof[docs]")
    folder = tmp_path_factory.mktemp("site")
    command = [sys.executable, "-m", "mkdocs", "build", "--strict", "--quiet", "--site-dir", str(folder)]
    subprocess.run(command, cwd=ROOT, check=True, capture_output=True, text=True)
    return folder


def test_a_page_loads_nothing_from_a_network(site):
    pages = list(site.glob("*.html"))
    loaded = {next(filter(None, found)) for page in pages for found in LOADED.findall(page.read_text(encoding="utf-8"))}
    assert len(pages) > 15
    assert any(address.startswith("assets/") for address in loaded)
    assert f"{FOLDER}/index.html" in loaded
    assert 'data-name="live"' in (site / FOLDER / "index.html").read_text(encoding="utf-8")
    assert not {address for address in loaded if re.match(r"(https?:)?//", address)}
    assert not [sheet for sheet in site.rglob("*.css") if FONTS.search(sheet.read_text(encoding="utf-8"))]


def test_every_page_of_the_folder_is_in_the_navigation(site):
    index = (site / "index.html").read_text(encoding="utf-8")
    missing = [page.stem for page in (ROOT / "docs").glob("*.md") if f'href="{page.stem}.html"' not in index]
    assert not missing


def test_the_site_is_searched_from_the_disk(site, launched):
    with launched("chromium").new_context() as context:
        page = context.new_page()
        page.set_default_timeout(PATIENCE)
        requested = []
        page.on("request", lambda request: requested.append(request.url))
        page.goto((site / "index.html").as_uri())
        page.keyboard.press("/")
        page.keyboard.type("shaking force")
        page.wait_for_selector(".md-search-result__item a[href*='quantities.html']")
    assert not [url for url in requested if url.startswith("http")]


def test_the_tables_have_every_limit_every_key_and_every_read_out():
    assert all(f"| {row.reason} |" in limits() for row in shipped_limits().rows)
    schema = json_schema()
    names = set(schema["properties"]) | set(schema["definitions"]["RegimeTable"]["properties"])
    assert not {name for name in names if f"| `{name}` |" not in keys()}
    page = ROOT / "docs" / "engines.md"
    assert page.read_text(encoding="utf-8") == renewed(page), f"write it anew: python -m docs.making.tables {page}"


def test_the_page_of_the_rooms_has_every_room_and_is_as_the_contracts_are():
    page = ROOT / "docs" / "rooms.md"
    shown, made = page.read_text(encoding="utf-8"), renewed(page)
    again = f"write it anew: python -m docs.making.tables {page}"
    assert COUNT.sub("", shown) == COUNT.sub("", made), again
    counts = [[int(count.replace(",", "")) for count in COUNT.findall(text)] for text in (shown, made)]
    assert [pair for pair in zip(*counts, strict=True) if abs(pair[0] - pair[1]) > 0.2 * pair[1]] == [], again
    folders = [path.parent.relative_to(ROOT) for name in PACKAGES for path in (ROOT / name).glob("*/__init__.py")]
    assert [str(folder) for folder in folders if f"`{folder.as_posix()}`" not in shown] == []


def test_the_page_about_python_has_every_public_name_and_every_variable_of_results():
    text = (ROOT / "docs" / "python.md").read_text(encoding="utf-8")
    assert [name for name in linkproof.__all__ if f"`{name}" not in text and name != "__version__"] == []
    assert [name for name in linkproof.results("juki-mf7923d", at=[0]).dataset if f"`{name}`" not in text] == []


def test_the_reference_has_every_public_name_with_its_arguments():
    text = reference()
    assert not [name for name in linkproof.__all__ if f"### `linkproof.{name}`" not in text and name != "__version__"]
    assert not [name for name in linkproof.engine.__all__ if f"#### `linkproof.engine.{name}`" not in text]
