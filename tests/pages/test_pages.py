"""The pages of a real report in a real browser: nothing missing, nothing wider than the screen, everything answers."""

from __future__ import annotations

import fcntl
import re
from pathlib import Path

import pytest

from analytic.description.loading import read
from tests.commands import process
from tests.pages.browser import THEMES, WIDTHS, executable, opened, pages, started

pytest.importorskip("playwright", reason="Playwright is not installed")
pytest.importorskip("axe_playwright_python", reason="axe-core is not installed")
pytestmark = pytest.mark.skipif(executable() is None, reason="no Chromium on this machine: pages were not looked at")

MECHANISMS = ("slotted-takeup", "fork-takeup")  # a thread and released regimes; a linkage with neither
TWO = "--engine pymunk --engine direct"
COMMANDS = (
    f"bench slotted-takeup --quick {TWO}",
    "stress start --quick --engine pymunk --time-limit 600",
    f"compare {{brief}} fork-takeup --regime run-up --regime own --setting all {TWO}",
)
MOST_SCREENS, MOST_NODES, MOST_BYTES, MOST_SHEETS = 12, 6_000, 1_500_000, 12
INDEX_SCREENS = 3
NAMES = ["index.html", "bench.html", "stress.html", *(f"mechanisms/{name}" for name in MECHANISMS)]


def _linkproof(*words: str) -> None:
    """A command; exit code 1 says that an engine is over a limit."""
    done = process(*words)
    assert done.returncode in (0, 1), done.stderr


@pytest.fixture(scope="session")
def report(tmp_path_factory: pytest.TempPathFactory, worker_id: str = "") -> Path:
    """A report of two mechanisms in two engines, with a benchmark and a stability map; made once for all workers."""
    root = tmp_path_factory.getbasetemp()
    root = root.parent if "popen-" in root.name else root
    folder = root / "report"
    with (root / "report.lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        if not (folder / "done").exists():
            brief = root / "slotted-takeup.toml"  # half a second of each released regime
            brief.write_text(re.sub("(?m)^duration .*", "duration = 0.5", read("slotted-takeup").text), "utf-8")
            for command in COMMANDS:
                _linkproof(*command.format(brief=brief).split(), "--out", str(folder), "--quiet")
            (folder / "done").touch()
    return folder


@pytest.fixture(scope="module")
def chromium():
    with started() as found:
        yield found


def _page(report: Path, name: str) -> Path:
    return next(page for page in pages(report) if str(page.relative_to(report)).startswith(name))


@pytest.mark.parametrize("name", NAMES)
def test_a_page_is_complete_and_of_a_size_to_be_read(chromium, report, name):
    with opened(chromium, _page(report, name)) as look:
        facts = look.facts()
        assert look.bytes_loaded <= MOST_BYTES
        assert facts["nodes"] <= MOST_NODES
        assert facts["screens"] <= (INDEX_SCREENS if name == "index.html" else MOST_SCREENS)
        assert look.empty() == []
        assert look.faults == []
        assert look.sheets() <= MOST_SHEETS
        if name == "index.html":
            assert facts["verdict"] <= 1.0


@pytest.mark.parametrize(("width", "theme"), [*zip(WIDTHS, THEMES, strict=True)])
@pytest.mark.parametrize("name", NAMES)
def test_a_page_is_legible_on_a_screen_and_on_a_phone_by_day_and_by_night(chromium, report, name, width, theme):
    with opened(chromium, _page(report, name), width, theme) as look:
        facts = look.facts()
        assert facts["overflow"] <= 0
        assert facts["small"] == []
        assert look.grave() == []


@pytest.mark.parametrize("name", NAMES)
def test_every_control_answers(chromium, report, name):
    with opened(chromium, _page(report, name)) as look:
        page = look.page
        for fold in page.locator("summary").all():
            if fold.is_visible():
                fold.click()
        for choice in page.locator(".widget select").all():
            if not choice.is_visible():
                continue
            for value in choice.evaluate("one => [...one.options].map(option => option.value)")[:6]:
                choice.select_option(value)
                page.wait_for_timeout(50)
        for slider in page.locator(".widget input[type=range]").all():
            slider.focus()
            slider.press("ArrowRight")
        for button in page.locator(".widget button").all():
            if button.is_visible() and "Save" not in (button.text_content() or ""):
                button.click()
        page.wait_for_load_state("networkidle")
        assert look.empty() == []
        assert look.faults == []


@pytest.mark.parametrize("name", NAMES)
def test_a_page_says_what_is_missing_without_scripts(chromium, report, name):
    with opened(chromium, _page(report, name), scripts=False) as look:
        assert look.faults == []
        if ".widget" in _page(report, name).read_text(encoding="utf-8"):
            assert look.page.locator("noscript").count()


def test_one_file_holds_the_whole_report(chromium, report, tmp_path):
    mailed = tmp_path / "report.html"
    _linkproof("report", str(report), "--single-file", str(mailed))
    with opened(chromium, mailed) as look:
        assert set(look.loaded) == {str(mailed)}
        assert look.faults == []
        assert look.empty() == []
