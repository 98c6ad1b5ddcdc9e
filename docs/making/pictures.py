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
from comparisons.designer.sheet import Sheet
from reports.charts.draw import DARK, FONT, GHOST, INK, MUTED, PALETTE, PAPER, PLATE, Array
from reports.charts.scheme import KinematicScheme
from reports.charts.symbols import outline

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
SECONDS, LARGEST = 6.0, np.array([302.0, 272.0])  # of a turn; px of the linkage
COLOURS = {"ink": INK, "muted": MUTED, "reference": GHOST, "paper": PAPER, "line": PLATE, "c0": PALETTE[0]}
BAR, PIN = 'stroke="var(--ink)" stroke-width="3"', 'r="4" fill="var(--paper)" stroke="var(--ink)"'
FOOT = "M0 0L-6 9H6ZM-9 9H9"
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
    drawing, rules, (width, height) = _moving_linkage(sheet)
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
    inks = "".join(f"--{name}:{light};" for name, light in COLOURS.items())
    darks = "".join(f"--{name}:{DARK[light]};" for name, light in COLOURS.items())
    whole, ends = height + TALL + 3.0 * EDGE, f"{low:.3g} to {high:.3g} N·m".replace("-", "−")
    (ASSETS / "moving.svg").write_text(
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width:g} {whole:g}" width="{width / 0.75:.0f}" '
        f'height="{whole / 0.75:.0f}" fill="none"><style>:root{{{inks}}}'
        f"@media (prefers-color-scheme:dark){{:root{{{darks}}}}}"
        f"@keyframes torque{{{moves}}}.at{{animation-name:torque!important}}"
        f"[class]{{animation:{SECONDS:g}s linear infinite;transform-box:view-box}}{rules}"
        f"@media (prefers-reduced-motion:reduce){{[class]{{animation-play-state:paused}}}}</style>"
        f"{drawing}"
        f'<path d="M{place(0.0, 0.0)}H{width - EDGE:.1f}" stroke="var(--muted)" stroke-width=".7"/>'
        f'<path d="M{line}" stroke="var(--c0)" stroke-width="1.6"/><circle class="at" r="3.5" fill="var(--c0)"/>'
        f'<text x="{EDGE:g}" y="{whole - 4.0:g}" fill="var(--muted)" font-family="{FONT}, sans-serif" '
        f'font-size="10">torque of the crank over a turn, {ends}</text></svg>\n',
        encoding="utf-8",
    )


def _moving_linkage(sheet: Sheet) -> tuple[str, str, Array]:
    """SVG of a linkage of pins where its motion begins, the rules that carry its links on, its size in px."""
    assert sheet.positions is not None
    scheme = KinematicScheme(sheet.linkage, sheet.positions)
    low, high = scheme.extent
    unit = float(np.min(LARGEST / (high - low)))

    def px(places: Array) -> Array:
        return EDGE + unit * (np.asarray(places) - [low[0], high[1]]) * [1.0, -1.0]

    def course(places: Array) -> str:
        return "L".join(f"{x:.1f} {y:.1f}" for x, y in px(places))

    output = sheet.linkage.output.point if sheet.linkage.output else ""
    strokes = {True: 'stroke="var(--c0)" stroke-width="2"', False: 'stroke="var(--reference)" stroke-dasharray="2 2"'}
    paths = [f'<path d="M{course(path.T)}" {strokes[point == output]}/>' for point, path in scheme.paths.items()]
    bars, pins, rules = [], [], ""
    for number, (name, link) in enumerate(sheet.linkage.links.items()):
        x, y, angle = sheet.positions.bodies[name]
        origin, turned = px(scheme.scale * np.stack([x, y], axis=1)), np.degrees(np.unwrap(angle))
        spots = scheme.path(name, link.points.values())[:, :, 0]
        bars.append(f'<path class="b{number}" d="M{course(outline(spots))}Z" {BAR} fill="var(--line)"/>')
        pins += [f'<circle class="b{number}" cx="{x:.1f}" cy="{y:.1f}" {PIN}/>' for x, y in px(spots)]
        steps = "".join(
            f"{100.0 * n / (len(angle) - 1):.4g}%{{transform:translate({right:.1f}px,{down:.1f}px)"
            f"rotate({turned[0] - turned[n]:.2f}deg)}}"
            for n in np.unique(np.linspace(0, len(angle) - 1, STEPS + 1).round().astype(int))
            for right, down in [origin[n] - origin[0]]
        )
        centre = "{:.1f}px {:.1f}px".format(*origin[0])
        rules += (
            f".b{number}{{transform-origin:{centre};animation-name:b{number}!important}}@keyframes b{number}{{{steps}}}"
        )
    feet = [f'<path d="{FOOT}" transform="translate({x:.1f} {y:.1f})" stroke="var(--ink)"/>'
            for x, y in px([scheme.paths[point][:, 0] for point in sheet.linkage.ground])]  # fmt: skip
    return "".join([*paths, *feet, *bars, *pins]), rules, unit * (high - low) + 2.0 * EDGE


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
