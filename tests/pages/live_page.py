"""The page whose points can be pulled, at work in a browser: what a reader does there, and what stands there then."""

from __future__ import annotations

import csv
import io
import json
import re
from contextlib import contextmanager
from urllib.parse import urlencode

import numpy as np
import pytest

from analytic.description.loading import load
from analytic.description.written import file_unit
from tests.analytic.linkages import file_text
from tests.commands import linkproof
from tests.pages.browser import opened

FOUR_BAR = file_text("four-bar-with-a-coupler-point")
ROUNDING = 8.0 * np.finfo(float).eps  # rad, of the angles that follow from one another
AT_HAND = """
  Object.defineProperty(navigator, 'clipboard', { value: undefined }); // the text goes to a box
  const made = URL.createObjectURL; // not every driver gets downloads
  URL.createObjectURL = (blob) => (blob.type === 'text/csv' ? ((window.saved = blob), '#') : made.call(URL, blob));
  HTMLAnchorElement.prototype.click = () => {};
"""


@contextmanager
def at_work(browser, page, design=None, **look):
    """A page with its script at work; a design is given by the address."""
    with opened(browser, page, fragment=urlencode(design or {}), before=AT_HAND, idle=False, **look) as seen:
        seen.page.locator(".live-scheme").wait_for()
        yield seen


def click(page, name):
    page.get_by_role("button", name=name, exact=True).click()


def copied(page):
    """The file with the page's numbers."""
    click(page, "Copy as TOML")
    return page.locator(".widget textarea").input_value()


def curves(page):
    """The saved curves by name, in the units of the file."""
    click(page, "Save curves")
    head, *rows = csv.reader(io.StringIO(page.evaluate("() => saved.text()")))
    values = np.array(rows, dtype=float).T
    return {name.partition(" [")[0]: row for name, row in zip(head, values, strict=True)}


def figure(page, name):
    """A key figure now, in the file, and its change, as they stand there."""
    row = page.locator(".live-figures tbody tr").filter(has=page.get_by_role("rowheader", name=name, exact=True))
    return row.locator("td").all_inner_texts()


def of_results(tmp_path, text, *words):
    """The JSON of ``linkproof results`` for a file."""
    file = tmp_path / "copied.toml"
    file.write_text(text, encoding="utf-8")
    done = linkproof("results", file, "--save", tmp_path / "out.json", "--quiet", *words)
    assert done.returncode == 0, done.stderr
    return json.loads((tmp_path / "out.json").read_text(encoding="utf-8"))


def grab(page, point):
    """The middle of a handle on the screen."""
    box = page.locator(f'.grip[aria-label^="Point {point}:"]').bounding_box()
    return box["x"] + box["width"] / 2, box["y"] + box["height"] / 2


def drag(page, point, by):
    x, y = grab(page, point)
    page.mouse.move(x, y)
    page.mouse.down()
    page.mouse.move(x + by[0] / 2, y + by[1] / 2)
    page.mouse.move(x + by[0], y + by[1])
    page.mouse.up()


def number(text, name):
    """A number of a link in a file, by the text before it."""
    return float(re.search(name + r"\s*=?\s*\[?(-?[\d.e+-]+)", text)[1])


def worst(page, copy):
    """The largest difference of each signal from ``linkproof results`` of the copied file, as a share of the peak.

    What the rounding of an angle changes does not count: near the end of a range forces change by hundreds of peaks a
    radian, and neither side is the better one there.
    """
    text, words, found = copied(page), page.locator("[aria-live]").inner_text(), curves(page)
    few = slice(None, None, max(1, len(found["phi"]) // 90))
    motion = re.findall(r"--(?:speed \S+|from=\S+|to=\S+)", words)
    time = ",".join(map(repr, found["time"][few].tolist()))
    truth = of_results(copy, text, *" ".join(motion).split(), "--time", time)
    linkage, off = load(str(copy / "copied.toml")), {}
    sizes = {one: file_unit(unit, linkage).size for one, unit in truth["units"].items() if one in found}
    scales: dict[tuple[str, str], float] = {}
    for one, size in sizes.items():
        kind = (one.partition(":")[0], truth["units"][one])
        scales[kind] = max(scales.get(kind, 0.0), size * float(np.max(np.abs(found[one]))))
    for one in {*sizes} - {"phi"}:
        gap = found[one][few] * sizes[one] - np.array(truth["values"][one])
        if one.endswith(":angle"):
            gap -= 2.0 * np.pi * np.round(gap / (2.0 * np.pi))
        turning = np.abs(np.gradient(found[one] * sizes[one], found["phi"]))[few]
        gap = np.maximum(np.abs(gap) - ROUNDING * turning, 0.0)
        off[one] = np.max(gap) / (scales[one.partition(":")[0], truth["units"][one]] or 1.0)
    peak = next((one for one in truth["figures"]["drive"] if one["what"] == "peak torque"), None)
    if peak:
        shown = float(figure(page, "peak torque")[0].split()[0].replace("−", "-"))
        assert shown == pytest.approx(peak["value"] / file_unit("N m", linkage).size, rel=5.01e-4)
    return off


def touch(page, *places):
    """A finger that goes from place to place."""
    finger = page.context.new_cdp_session(page)
    for kind, (x, y) in zip(["touchStart", *["touchMove"] * (len(places) - 1)], places, strict=True):
        finger.send("Input.dispatchTouchEvent", {"type": kind, "touchPoints": [{"x": x, "y": y}]})
    finger.send("Input.dispatchTouchEvent", {"type": "touchEnd", "touchPoints": []})
