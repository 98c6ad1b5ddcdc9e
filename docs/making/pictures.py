"""The documentation's pictures, drawn anew from today's output; ``make pictures`` runs it.

A picture comes from a command, given the files that its page shows, or from the report that ``make report`` left in
build/report; the tutorial is executed. ``moving.svg`` is README's linkage over its torque, at the same angle of the
crank. ``quantities.svg`` is drawn by hand.
"""

from __future__ import annotations

import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path
from urllib.parse import unquote

import numpy as np

import linkproof
from comparisons.designer.building import page_sheet
from reports.charts.draw import DARK, FONT
from reports.charts.moving import COLOURS, SECONDS, moving_scheme

ROOT = Path(__file__).resolve().parents[2]
ASSETS, REPORT = ROOT / "docs" / "assets", ROOT / "build" / "report"
FILE = re.compile(r"^```toml (\S+)\n(.*?)^```$", re.MULTILINE | re.DOTALL)
MAP = "sweep rimoldi-164 --vary rod.B.x=165:185:81 --vary rocker.B.x=19:24:81 --quantity Mkr.peak --quantity stroke"
COMMANDS = {  # by picture: the page that shows the command's files, and the command
    "results.svg": ("docs/designs.md", "results coupler-curve"),
    "pump.svg": ("docs/linkage-files.md", "check pump.toml"),
    "sweep.svg": ("docs/designs.md", MAP),
}
DRAWING = "plot => Plotly.toImage(plot, { format: 'svg', width: 1100, height: 560 })"
TALL, EDGE, STEPS = 120.0, 14.0, 72  # px of the torque below the moving linkage, px around it, steps of a turn
PREVIEW = {"x": 0, "y": 0, "width": 1400, "height": 1480}  # px of the report's first page


def draw(picture: str, page: str, command: str) -> None:
    """Run a command in a folder with the files that a page shows, and put its picture into the documentation."""
    with tempfile.TemporaryDirectory() as folder:
        for name, text in FILE.findall((ROOT / page).read_text(encoding="utf-8")):
            (Path(folder) / name).write_text(text, encoding="utf-8")
        words = [sys.executable, "-m", "reports.command_line.main", *command.split(), "--save", picture]
        subprocess.run(words, cwd=folder, check=True, stdout=subprocess.DEVNULL)
        shutil.copy(Path(folder) / picture, ASSETS / picture)


def animate() -> None:
    """Put the linkage of README's first command in motion over its torque; a dot and the crank are at one angle."""
    sheet = page_sheet(linkproof.results("coupler-curve").case)
    assert sheet.positions is not None
    drawing = str(moving_scheme(sheet.linkage, sheet.positions, "moving"))
    width, height = map(float, re.findall(r'viewBox="0 0 (\S+) (\S+)"', drawing)[0])
    drawing = re.sub(r'width="\d+" height="\d+"', f'width="{width:g}" height="{height:g}"', drawing, count=1)
    torque, share = sheet.y("Mkr"), (sheet.x - sheet.x[0]) / np.ptp(sheet.x)
    low, high = float(np.min(torque)), float(np.max(torque))

    def place(at: float, value: float) -> str:
        return f"{EDGE + at * (width - 2.0 * EDGE):.1f} {height + EDGE + (high - value) / (high - low) * TALL:.1f}"

    times = np.linspace(0.0, 1.0, STEPS + 1)
    steps = zip(times, np.interp(times, share, torque), strict=True)
    moves = "".join(
        f"{100.0 * at:.4g}%{{transform:translate({place(at, value).replace(' ', 'px,')}px)}}" for at, value in steps
    )
    line = "L".join(place(at, value) for at, value in zip(share, torque, strict=True))
    inks = "".join(f"--{name}:{light};" for light, name in COLOURS.items())
    darks = "".join(f"--{name}:{DARK[light]};" for light, name in COLOURS.items())
    whole, ends = height + TALL + 3.0 * EDGE, f"{low:.3g} to {high:.3g} N·m".replace("-", "−")
    (ASSETS / "moving.svg").write_text(
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width:g} {whole:g}" width="{width / 0.75:.0f}" '
        f'height="{whole / 0.75:.0f}" fill="none"><style>:root{{{inks}}}'
        f"@media (prefers-color-scheme:dark){{:root{{{darks}}}}}"
        f"@keyframes torque{{{moves}}}.at{{animation:torque {SECONDS:g}s linear infinite}}"
        f"@media (prefers-reduced-motion:reduce){{.at{{animation-play-state:paused}}}}</style>"
        f"{drawing}"
        f'<path d="M{place(0.0, 0.0)}H{width - EDGE:.1f}" stroke="var(--muted)" stroke-width=".7"/>'
        f'<path d="M{line}" stroke="var(--c0)" stroke-width="1.6"/><circle class="at" r="3.5" fill="var(--c0)"/>'
        f'<text x="{EDGE:g}" y="{whole - 4.0:g}" fill="var(--muted)" font-family="{FONT}, sans-serif" '
        f'font-size="10">torque of the crank over a turn, {ends}</text></svg>\n',
        encoding="utf-8",
    )


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
    animate()
    execute_tutorial()
    if (REPORT / "bench.html").is_file():
        photograph_report()
    else:
        print(f"no report in {REPORT}: run 'make report' first for work-precision.svg and preview.png")


if __name__ == "__main__":
    main()
