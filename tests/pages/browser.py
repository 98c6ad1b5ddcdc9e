"""A report's pages in a headless browser: the files that a page loads, its size, and the violations by axe-core.

``python -m tests.pages.browser`` succeeds where there is a browser; ``make browser`` installs one where it does not.
"""

from __future__ import annotations

import os
import re
import shutil
import sys
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass, field
from functools import cache
from importlib.util import find_spec
from pathlib import Path
from typing import Any

WIDTHS = (1400, 390)
HEIGHT = 1000
PATIENCE = 600_000  # ms that anything may take on a busy machine
THEMES = ("light", "dark")
NAMES = {
    "chromium": ("chromium", "chromium-browser", "google-chrome", "chrome"),
    "firefox": ("firefox", "firefox-esr"),
}
SHARED = "plotly-basic.min.js"  # loaded once for all pages, and not counted

# Everything on a page that a reader may meet, without what stands in closed folds.
FACTS = Path(__file__).with_name("facts.js").read_text(encoding="utf-8")
PAINT = "() => performance.getEntriesByName('first-contentful-paint').map(entry => entry.startTime)[0]"
EMPTY = """() => [
  ...[...document.images].filter(one => !(one.complete && one.naturalWidth)).map(one => one.currentSrc || one.src),
  ...[...document.querySelectorAll('.js-plotly-plot')]
    .filter(one => !one.data.some(trace => (trace.x || trace.y || []).length)).map(one => 'plot without data'),
]"""
LOAD_ALL = """async () => {
  for (const image of document.images) { image.loading = 'eager'; }
  await Promise.all([...document.images].map(one => one.complete || new Promise(done => {
    one.onload = done; one.onerror = done;
  })));
}"""


@dataclass
class Look:
    """An open page: ``faults`` are errors of scripts and requests that failed or left the folder."""

    page: Any
    faults: list[str] = field(default_factory=list)
    loaded: dict[str, int] = field(default_factory=dict)

    @property
    def bytes_loaded(self) -> int:
        """Size of all files that opening took, without the shared library."""
        return sum(size for name, size in self.loaded.items() if not name.endswith(SHARED))

    def facts(self) -> dict[str, Any]:
        """Nodes, screens, overflow in px, words in small print, where the verdict ends in screens."""
        return dict(self.page.evaluate(FACTS))

    def paint(self) -> float:
        """First contentful paint, ms."""
        return float(self.page.evaluate(PAINT) or 0.0)

    def empty(self) -> list[str]:
        """Pictures that did not load and plots without data."""
        self.page.evaluate(LOAD_ALL)
        return list(self.page.evaluate(EMPTY))

    def grave(self) -> list[str]:
        """The violations that axe-core calls serious or critical."""
        from axe_playwright_python.sync_playwright import Axe

        found = Axe().run(self.page, options={"preload": False, "resultTypes": ["violations"]}).response["violations"]
        return [
            f"{one['impact']}: {one['help']}: {one['nodes'][0]['html'][:120]} ({len(one['nodes'])})"
            for one in found
            if one["impact"] in ("serious", "critical")
        ]

    def sheets(self) -> int:
        """Sheets of A4 on paper."""
        return len(re.findall(rb"/Type\s*/Page\b", self.page.pdf(format="A4", prefer_css_page_size=True)))


@cache
def executable(name: str = "chromium") -> str | None:
    """The browser's program, the system's or Playwright's own Chromium; None where there is neither."""
    found = next((found for one in NAMES[name] if (found := shutil.which(one))), None)
    if found or name != "chromium" or find_spec("playwright") is None:
        return found
    from playwright.sync_api import sync_playwright

    with sync_playwright() as driver:
        own = driver.chromium.executable_path
    return own if Path(own).exists() else None


def lacking() -> str:
    """What tests of pages lack on this machine, in a sentence; empty where they lack nothing."""
    for package in ("playwright", "axe_playwright_python"):
        if find_spec(package) is None:
            return f"{package} is not installed: pages were not looked at"
    return "" if executable() else "no Chromium on this machine: pages were not looked at; make browser installs it"


def demand() -> None:
    """Skip a test where there is no browser; with LINKPROOF_REQUIRE=browser, as CI sets it, the test fails."""
    import pytest

    reason = lacking()
    if reason:
        (pytest.fail if os.environ.get("LINKPROOF_REQUIRE") == "browser" else pytest.skip)(reason)


@contextmanager
def launching() -> Iterator[Callable[[str], Any]]:
    """A function from a browser's name to that browser without a window, which is started once and closed at the end.

    A Firefox as its makers ship it speaks WebDriver BiDi.
    """
    from playwright.sync_api import sync_playwright

    options = {"chromium": {"args": ["--no-sandbox", "--disable-gpu"]}, "firefox": {"channel": "moz-firefox"}}
    executable()  # which may start a driver of its own, and two cannot run at a time
    with sync_playwright() as driver, ExitStack() as stack:

        @cache
        def launched(name: str) -> Any:
            browser = getattr(driver, name).launch(executable_path=executable(name), **options[name])
            stack.callback(browser.close)
            return browser

        yield launched


@contextmanager
def started() -> Iterator[Any]:
    """Chromium without a window."""
    with launching() as launched:
        yield launched("chromium")


@contextmanager
def opened(
    browser: Any,
    path: Path,
    width: int = 1400,
    theme: str = "light",
    *,
    scripts: bool = True,
    is_phone: bool = False,
    fragment: str = "",
    before: str = "",
    idle: bool = True,
) -> Iterator[Look]:
    """A page of a report's folder, open and, unless ``idle`` is False, idle; on a phone it is touched.

    ``fragment`` ends its address, and ``before`` is a script that runs ahead of its own; no curves move.
    """
    own: dict[str, Any] = {"is_mobile": True, "has_touch": True, "device_scale_factor": 2} if is_phone else {}
    context = browser.new_context(
        viewport={"width": width, "height": HEIGHT},
        color_scheme=theme,
        java_script_enabled=scripts,
        offline=True,
        reduced_motion="reduce",
        **own,
    )
    context.set_default_timeout(PATIENCE)
    try:
        look = Look(context.new_page())
        folder = _root(path)
        look.page.on("pageerror", lambda error: look.faults.append(f"error: {error}"))
        look.page.on("console", lambda one: _hear(look, one.type, one.text))
        look.page.on("requestfailed", lambda request: look.faults.append(f"failed: {request.url}"))
        look.page.on("request", lambda request: _note(look, request.url, folder))
        look.page.add_init_script(before)
        look.page.goto(f"{path.resolve().as_uri()}#{fragment}", wait_until="load")
        if idle:
            look.page.wait_for_load_state("networkidle")  # half a second without a request
        yield look
    finally:
        context.close()


def _root(path: Path) -> Path:
    """The folder of the report that a page belongs to."""
    parent = path.resolve().parent
    return parent.parent if parent.name == "mechanisms" else parent


def _hear(look: Look, kind: str, text: str) -> None:
    if kind in ("error", "warning"):
        look.faults.append(f"{kind}: {text}")


def _note(look: Look, url: str, folder: Path) -> None:
    """Count a file of the folder; a request for anything else is a fault."""
    from urllib.parse import unquote, urlparse

    if url.startswith(("data:", "blob:")):
        return
    place = Path(unquote(urlparse(url).path))
    if urlparse(url).scheme == "file" and place.is_relative_to(folder):
        look.loaded[str(place)] = place.stat().st_size if place.is_file() else 0
    else:
        look.faults.append(f"asks for {url}")


def pages(folder: Path) -> list[Path]:
    """Every page of a report, the first one first."""
    rest = sorted({*folder.glob("*.html"), *folder.glob("mechanisms/*.html")} - {folder / "index.html"})
    return [folder / "index.html", *rest]


if __name__ == "__main__":
    sys.exit(lacking() or 0)
