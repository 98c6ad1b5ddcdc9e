"""The documentation's pictures, drawn anew from today's output; ``make pictures`` runs it.

A picture comes from a command, given the files that its page shows, or from the report that ``make report`` left in
build/report; the tutorial is executed. ``quantities.svg`` is drawn by hand.
"""

from __future__ import annotations

import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path
from urllib.parse import unquote

ROOT = Path(__file__).resolve().parents[2]
ASSETS, REPORT = ROOT / "docs" / "assets", ROOT / "build" / "report"
FILE = re.compile(r"^```toml (\S+)\n(.*?)^```$", re.MULTILINE | re.DOTALL)
MAP = "sweep rimoldi-164 --vary rod.B.x=165:185:81 --vary rocker.B.x=19:24:81 --quantity Mkr.peak --quantity stroke"
COMMANDS = {  # by picture: the page that shows the command's files, and the command
    "results.svg": ("README.md", "results mine.toml"),
    "first-linkage.svg": ("docs/first-linkage.md", "check pump.toml"),
    "sweep.svg": ("docs/designs.md", MAP),
}
DRAWING = "plot => Plotly.toImage(plot, { format: 'svg', width: 1100, height: 560 })"
PREVIEW = {"x": 0, "y": 0, "width": 1400, "height": 1480}  # px of the report's first page


def draw(picture: str, page: str, command: str) -> None:
    """Run a command in a folder with the files that a page shows, and put its picture into the documentation."""
    with tempfile.TemporaryDirectory() as folder:
        for name, text in FILE.findall((ROOT / page).read_text(encoding="utf-8")):
            (Path(folder) / name).write_text(text, encoding="utf-8")
        words = [sys.executable, "-m", "reports.command_line.main", *command.split(), "--save", picture]
        subprocess.run(words, cwd=folder, check=True, stdout=subprocess.DEVNULL)
        shutil.copy(Path(folder) / picture, ASSETS / picture)


def photograph_report() -> None:
    """Take the upper part of the report's first page, and the diagram of its benchmark as that page draws it."""
    from tests.pages.browser import opened, started

    with started() as browser:
        with opened(browser, REPORT / "index.html") as look:
            look.page.screenshot(path=ASSETS / "preview.png", clip=PREVIEW, full_page=True)
        with opened(browser, REPORT / "bench.html") as look:
            drawing = look.page.locator(".js-plotly-plot").first.evaluate(DRAWING)
            (ASSETS / "work-precision.svg").write_text(unquote(drawing.partition(",")[2]), encoding="utf-8")


def execute_tutorial() -> None:
    """Run the notebook and save its output."""
    import nbformat
    from nbclient import NotebookClient

    path = ROOT / "docs" / "tutorial.ipynb"
    notebook = nbformat.read(path, as_version=4)
    NotebookClient(notebook, record_timing=False, timeout=None, coalesce_streams=True).execute()
    nbformat.write(notebook, path)


def main() -> None:
    """Draw every picture; those of the report only where there is a report."""
    for picture, (page, command) in COMMANDS.items():
        draw(picture, page, command)
    execute_tutorial()
    if (REPORT / "bench.html").is_file():
        photograph_report()
    else:
        print(f"no report in {REPORT}: run 'make report' first for work-precision.svg and preview.png")


if __name__ == "__main__":
    main()
