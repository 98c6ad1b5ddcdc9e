"""The page whose points can be pulled, in a real browser: its numbers are those of linkproof for the copied file."""

from __future__ import annotations

import json
import re
from pathlib import Path
from urllib.parse import urlencode

import numpy as np
import pytest

from analytic.description.loading import catalogue, literature, load
from tests.analytic.linkages import text_of
from tests.commands import linkproof, watching
from tests.pages.browser import NAMES, PATIENCE, WIDTHS, executable, opened
from tests.pages.live_page import (
    AT_HAND,
    FOUR_BAR,
    at_work,
    click,
    copied,
    drag,
    figure,
    grab,
    number,
    of_results,
    touch,
    worst,
)

E11 = (Path(__file__).parents[1] / "linkages" / "designer" / "e11.toml").read_text(encoding="utf-8")
SAME = 1e-13  # of the peak
CHANGES = 2
UNCHANGING = {"n-four-bar", "shaper-quick-return"}  # formulas that branch, and a group without a formula
SHIPPED = [name for name in (*catalogue(), *literature()) if name not in UNCHANGING]
TEXTS = {"four-bar": FOUR_BAR, "laden-press": text_of("laden-press")}
MOST_BYTES = 900_000
ROCKER = '[aria-label="rocker mass, kg, exactly"]'
SAVED = """() => [...document.querySelectorAll('.live-number.changed input[type=number]')]
  .map(one => one.ariaLabel).join() === 'motion and loads speed, rpm, exactly'"""


@pytest.fixture(scope="module")
def browser(request, launched):
    """Chromium, or another one by its name."""
    name = getattr(request, "param", "chromium")
    from playwright.sync_api import Error

    if executable(name) is None:
        pytest.skip(f"no {name} on this machine")
    found = launched(name)
    try:
        found.new_context(offline=True).close()
    except Error as error:
        pytest.skip(f"this Playwright cannot drive this {name}: {error}")
    return found


SLOW = pytest.mark.nightly
OTHERS = [pytest.param(name, marks=SLOW) for name in NAMES if name != "chromium"]
in_every_browser = pytest.mark.parametrize("browser", ["chromium", *OTHERS], indirect=True)


@pytest.fixture(scope="module")
def page_of(tmp_path_factory):
    """The page of a linkage by name, or of a text, written once."""
    made: dict[str, Path] = {}

    def write(name: str, text: str = "") -> Path:
        if name not in made:
            folder = tmp_path_factory.mktemp(name)
            file = folder / f"{name}.toml"
            file.write_text(text or load(name).text, encoding="utf-8")
            done = linkproof("results", file, "--out", folder / "out", "--quiet")
            assert done.returncode == 0, done.stderr
            made[name] = folder / "out" / "index.html"
        return made[name]

    return write


def live_data(page):
    """What a page gives its linkage that can be pulled at."""
    live = re.search(r'data-kind="live".*?json">(.*?)</script>', page.read_text("utf-8"), re.DOTALL)
    assert live
    return json.loads(live[1])


@pytest.mark.parametrize(
    ("browser", "name"),
    [
        ("chromium", "four-bar"),
        ("chromium", "laden-press"),
        *(pytest.param(name, "four-bar", marks=SLOW) for name in NAMES if name != "chromium"),
        *(pytest.param("chromium", name, marks=SLOW) for name in SHIPPED),
    ],
    indirect=["browser"],
)
def test_the_page_computes_the_values_of_results_for_the_copied_file(browser, page_of, tmp_path, name):
    page = page_of(name, TEXTS.get(name, ""))
    chance = np.random.default_rng(5)
    with at_work(browser, page) as seen:
        offered = [one for one in live_data(page)["numbers"] if one["offered"]]
        for _ in range(CHANGES):
            some = chance.choice(len(offered), min(9, len(offered)), replace=False)
            design = {offered[k]["name"]: float(offered[k]["value"] * chance.uniform(0.98, 1.02)) for k in some}
            seen.page.evaluate("hash => { location.hash = hash; }", urlencode(design))
            off = worst(seen.page, tmp_path)
            assert max(off.values()) <= SAME, (design, {one: value for one, value in off.items() if value > SAME})
        assert seen.faults == []


CORNERED = """
torques = [{ link = "crank", interpolation = "linear", angle = [0.3, 100.123, 200.7], torque = [0, -9, 3] }]
"""
FIGURES = """async data => {
  const program = await linkproof.load(document.querySelector('.widget[data-kind="live"]'), "model");
  const model = linkproof.liveModel(await linkproof.liveProgram(program), data);
  return Object.fromEntries(model.figures(model.whole({})).map(({ name, value }) => [name, value]));
}"""


def test_peaks_and_means_of_a_load_of_straight_lines_are_those_of_results(browser, page_of, tmp_path):
    """The peak of the torque is at a corner of the load, between two instants of the page."""
    text = FOUR_BAR.replace("forces =", "#") + CORNERED
    page = page_of("cornered", text)
    with at_work(browser, page) as seen:
        shown = seen.page.evaluate(FIGURES, live_data(page))
        assert seen.faults == []
    table = of_results(tmp_path, text)["figures"]["drive"]
    truth = {row["what"]: row["value"] for row in table if row["signal"] == "Mkr"}
    for name in ("peak torque", "RMS torque"):
        assert shown[name] == pytest.approx(truth[name], rel=1e-11)


PULLS = {  # the numbers in the file, with their values, that a pull at a point changes, and that it leaves
    "P": ({r"P =": 28.0}, {r"B =": 60.0}),
    "B": ({r"A = \[0, 0\], B =": 60.0, r"O2 = \[0, 0\], B =": 45.0}, {r"P =": 28.0}),
    "A": ({r"O1 = \[0, 0\], A =": 20.0}, {r"B =": 60.0}),
    "O2": ({r"O1 = \[0, 0\], O2 =": 60.0}, {r"B =": 60.0}),
}


@in_every_browser
def test_a_point_that_is_pulled_changes_its_lengths_in_steps_and_follows_the_pointer(browser, page_of):
    with at_work(browser, page_of("four-bar", FOUR_BAR)) as seen:
        for point, (changed, same) in PULLS.items():
            x, y = grab(seen.page, point)
            drag(seen.page, point, (25.0, -15.0))
            now, text = grab(seen.page, point), copied(seen.page)
            if point in "PBA":
                assert np.hypot(now[0] - x - 25.0, now[1] - y + 15.0) < 8.0  # px; a step is less
            for name, was in changed.items():
                assert number(text, name) != was
                assert (number(text, name) / 0.5) % 1.0 == pytest.approx(0.0, abs=1e-9)
            assert [number(text, name) for name in same] == [*same.values()]
            assert "# bolted to the frame" in text
            click(seen.page, "Reset")
        assert seen.faults == []


TOPS = """() => [...document.querySelectorAll('.live-curves figure, .live-numbers')]
  .map(one => one.getBoundingClientRect().top)"""
OUTSIDE = """() => {
  const sheet = document.querySelector('.live-scheme').getBoundingClientRect();
  const pins = [...document.querySelectorAll('.pin')].map(one => one.getBoundingClientRect());
  return pins.filter(({ left, right, top, bottom }) => left < sheet.left || right > sheet.right || top < sheet.top
    || bottom > sheet.bottom).length;
}"""


def test_a_curve_is_read_under_the_pointer_and_a_pull_moves_nothing_else_and_leaves_no_point_outside(browser, page_of):
    with at_work(browser, page_of("four-bar", FOUR_BAR)) as seen:
        page, at = seen.page, seen.page.locator(".live-legend b")
        before, tops = at.inner_text(), page.evaluate(TOPS)
        page.locator(".live-plot canvas").first.hover()
        assert at.inner_text() != before
        drag(page, "P", (-300.0, -100.0))
        assert figure(page, "peak torque")[2]
        assert page.evaluate(TOPS) == tops
        assert page.evaluate(OUTSIDE) == 0
        assert seen.faults == []


@in_every_browser
def test_a_slider_is_undone_redone_and_reset_and_the_address_keeps_it(browser, page_of):
    with at_work(browser, page_of("four-bar", FOUR_BAR)) as seen:
        page, name = seen.page, "crank mass, kg"
        peak, status = figure(page, "peak torque"), page.locator("[aria-live]")
        assert peak == [peak[0], peak[0], ""]
        slider = page.get_by_role("slider", name=name)
        slider.focus()
        for _ in range(9):
            slider.press("ArrowRight")
        mass = page.get_by_role("spinbutton", name=f"{name}, exactly")
        heavy, changed = mass.input_value(), figure(page, "force in O1")
        assert float(heavy) > 0.2
        assert changed[2].endswith("%")
        assert "against the file" in status.inner_text()
        for _ in range(9):
            page.keyboard.press("Control+z")
        assert (mass.input_value(), figure(page, "force in O1")[2]) == ("0.2", "")
        for _ in range(9):
            click(page, "Redo")
        assert mass.input_value() == heavy
        assert f"mass = {heavy}," in copied(page)
        click(page, "Copy address")
        page.wait_for_function("() => document.querySelector('.widget textarea').value.startsWith('#model=')")
        end = page.locator(".widget textarea").input_value()
        page.goto("about:blank")
        page.goto(f"{page_of('e11', E11).as_uri()}{end}")  # the page of another linkage
        page.get_by_text("This linkage came with the address.").wait_for()
        page.locator(".live-scheme").wait_for()
        assert figure(page, "force in O1") == changed
        click(page, "Reset")
        assert copied(page) == FOUR_BAR
        other = page_of("e11", E11).parent.as_uri()
        assert [fault for fault in seen.faults if not fault.startswith(f"asks for {other}")] == []


def test_arrows_point_along_the_joint_forces_of_results(browser, page_of, tmp_path):
    truth = of_results(tmp_path, FOUR_BAR, "--at", "0")["values"]
    with at_work(browser, page_of("four-bar", FOUR_BAR)) as seen:
        seen.page.get_by_role("checkbox", name="joint forces").check()
        ways = seen.page.locator(".arrows path").evaluate_all("every => every.map(one => one.getAttribute('d'))")
        drawn = [np.array(re.findall(r"-?[\d.]+", way)[:6], dtype=float).reshape(3, 2) for way in ways]
        shown = [np.degrees(np.arctan2(start[1] - tip[1], tip[0] - start[0])) for start, _, tip in drawn]
        joints = ("A", "B", "O1", "O2")
        for joint in joints:
            x, y = (truth[f"joint_force:{joint}:{axis}"][0] for axis in "xy")
            assert min(abs((np.degrees(np.arctan2(y, x)) - one + 180.0) % 360.0 - 180.0) for one in shown) < 0.5
        largest = max(float(figure(seen.page, f"force in {joint}")[0].split()[0]) for joint in joints)
        assert f"Longest: joint forces {largest:.3g} N." in seen.page.locator(".live-arrows").inner_text()
        assert seen.faults == []


def test_a_load_over_the_stroke_has_its_arrow(browser, page_of, tmp_path):
    travel = np.array(of_results(tmp_path, TEXTS["laden-press"])["values"]["S"])
    (stroke,) = (one.force for one in load(str(tmp_path / "copied.toml")).forces if one.force.over == "S")
    most = np.max(np.hypot(*stroke(travel)))
    with at_work(browser, page_of("laden-press", TEXTS["laden-press"])) as seen:
        seen.page.get_by_role("checkbox", name="loads").check()
        (longest,) = re.findall(r"Longest: loads ([\d.]+) N", seen.page.locator(".live-arrows").inner_text())
        assert float(longest) == pytest.approx(most, rel=5e-3)
        assert seen.faults == []


def test_a_released_crank_has_the_same_page_without_handles(browser, tmp_path):
    treadle = Path(__file__).parents[1] / "linkages" / "designer" / "treadle.toml"
    done = linkproof("results", treadle, "--regime", "foot", "--out", tmp_path / "out", "--quiet")
    assert done.returncode == 0, done.stderr
    truth = json.loads(linkproof("results", treadle, "--regime", "foot", "--json").stdout)["values"]

    def most(kind):
        ends = [
            name.removesuffix("x")
            for name in truth
            if re.match(f"{'point' if kind else 'joint_force'}:.*:{kind}x$", name)
        ]
        return max(np.max(np.hypot(truth[f"{end}x"], truth[f"{end}y"])) for end in ends)

    with at_work(browser, tmp_path / "out" / "index.html", width=WIDTHS[1]) as seen:
        values = seen.page.locator(".live-curves b")
        place = seen.page.get_by_role("slider", name="t")
        before = values.all_inner_texts()
        for box in seen.page.locator(".live-arrows").get_by_role("checkbox").all():
            box.check()
        longest = re.findall(r"(\w+) ([\d.]+) \S+[,.](?: |$)", seen.page.locator(".live-arrows").inner_text())
        assert {kind: float(value) for kind, value in longest} == pytest.approx(
            {"loads": 70.3, "velocity": 1e3 * most("v"), "acceleration": 1e3 * most("a"), "forces": most("")}, rel=5e-3
        )  # in the file's mm; the load's spline overshoots the 60 N of its table
        place.evaluate("one => { one.value = 900; one.dispatchEvent(new Event('input')); }")
        assert sum(one != other for one, other in zip(before, values.all_inner_texts(), strict=True)) > 8
        assert seen.page.locator(".grip").count() == 0
        assert seen.facts()["overflow"] <= 0
        assert seen.grave() == []
        assert seen.faults == []


def test_a_linkage_that_cannot_turn_is_drawn_where_it_stops(browser, page_of):
    with at_work(browser, page_of("four-bar", FOUR_BAR), {"ground.O2.x": 88.0}) as seen:
        page = seen.page
        place = page.get_by_role("slider", name="φ")
        assert figure(page, "peak torque")[0] == "–"
        place.evaluate("one => { one.value = 450; one.dispatchEvent(new Event('input')); }")
        # the law of cosines where coupler and rocker are in line
        stops = np.degrees(np.arccos((20.0**2 + 88.0**2 - 105.0**2) / (2.0 * 20.0 * 88.0)))
        assert f"Stops at {stops:.1f}°" in page.locator(".live-status").inner_text()
        assert page.locator(".pin.stopped").count() == 1
        assert seen.faults == []


def test_peaks_at_an_open_end_of_a_range_are_marked(browser, page_of):
    with at_work(browser, page_of("e11", E11), {"rocker.mass": 0.2}) as seen:
        for name in ("peak torque", "force in A", "shaking moment"):
            assert all(cell.endswith("*") for cell in figure(seen.page, name)[:2]), name
        assert "--from 40 --to 127" in seen.page.locator("main").inner_text()
        assert seen.faults == []


@pytest.mark.parametrize(
    ("name", "width", "theme"),
    [pytest.param("stephenson-six-bar", WIDTHS[0], "dark", marks=SLOW), ("four-bar", WIDTHS[1], "light")],
)
def test_it_is_legible_and_answers_keys_on_a_screen_and_on_a_phone(browser, page_of, name, width, theme):
    with at_work(browser, page_of(name, TEXTS.get(name, "")), width=width, theme=theme) as seen:
        page = seen.page
        before = copied(page)
        page.locator('.grip[aria-label^="Point P:"]').focus()
        page.keyboard.press("ArrowRight")
        assert copied(page) != before
        facts = seen.facts()
        assert facts["overflow"] <= 0
        assert facts["small"] == []
        assert seen.grave() == []
        assert seen.faults == []
        assert seen.bytes_loaded <= MOST_BYTES


def test_a_finger_pulls_and_slides_without_scrolling_the_page(browser, page_of):
    with at_work(browser, page_of("four-bar", FOUR_BAR), width=WIDTHS[1], is_phone=True) as seen:
        page = seen.page
        page.locator(".live-scheme").scroll_into_view_if_needed()
        top, (x, y) = page.evaluate("scrollY"), grab(page, "P")
        touch(page, (x, y), (x + 10.0, y + 15.0), (x + 20.0, y + 30.0))
        assert page.evaluate("scrollY") == top
        assert np.hypot(*np.subtract(grab(page, "P"), (x + 20.0, y + 30.0))) < 8.0
        page.locator(".live-figures summary").click()
        slider = page.get_by_role("slider", name="crank mass, kg")
        slider.scroll_into_view_if_needed()
        box, before = slider.bounding_box(), figure(page, "force in O1")[0]
        touch(page, *((box["x"] + share * box["width"], box["y"] + box["height"] / 2) for share in (0.5, 0.6, 0.8)))
        assert figure(page, "force in O1")[0] != before
        assert number(copied(page), r"P =") != 28.0
        assert seen.facts()["overflow"] <= 0
        assert seen.faults == []


def test_names_from_a_file_and_addresses_are_data(browser, page_of):
    hostile = "</script><img src=x onerror=alert(1)>"
    text = FOUR_BAR.replace("Crank-rocker", hostile).replace("P =", f"'{hostile}' =").replace('"P"', f"'{hostile}'")
    design = {"__proto__": 1, "crank.mass": "1e999", "sketch.B.x": 3, hostile: 2, "rocker.mass": "0.5"}
    with at_work(browser, page_of("hostile", text), design) as seen:
        assert seen.page.locator("img[src=x]").count() == 0
        assert copied(seen.page) == text.replace("mass = 0.12", "mass = 0.5")
        assert seen.faults == []


@pytest.mark.parametrize("end", [pytest.param("AAAA", marks=SLOW), "q1YqSyxSslJKSy0qVqoFAA"])  # no stream, no linkage
def test_an_address_without_a_linkage_is_refused_in_a_sentence(browser, page_of, end):
    with opened(browser, page_of("four-bar", FOUR_BAR), fragment=f"model={end}") as seen:
        seen.page.locator("h1").get_by_text("This address has no linkage").wait_for()
        assert seen.faults == []


@in_every_browser
def test_a_watched_page_follows_its_file_and_saves_to_it(browser, tmp_path):
    file, faults = tmp_path / "mine.toml", []
    file.write_text(FOUR_BAR, encoding="utf-8")
    with watching(file) as address:
        page = browser.new_context(reduced_motion="reduce", permissions=[]).new_page()
        page.set_default_timeout(PATIENCE)
        page.add_init_script(AT_HAND)
        page.on("console", lambda one: faults.append(one.text))
        page.on("pageerror", lambda one: faults.append(str(one)))
        page.goto(f"{address}#crank.mass=0.3&speed=500")
        page.locator(ROCKER).wait_for(state="attached")
        file.write_text(FOUR_BAR.replace("mass = 0.12", "mass = 0.14"), encoding="utf-8")
        page.wait_for_function("one => document.querySelector(one)?.value === '0.14'", arg=ROCKER)
        text = copied(page)
        assert "mass = 0.14" in text
        assert "mass = 0.3" in text
        assert "# bolted to the frame" in text
        click(page, "Copy address")
        page.wait_for_function("() => document.querySelector('.widget textarea').value.startsWith('#model=')")
        click(page, "Save to mine.toml")
        page.wait_for_url(f"{address}#speed=500")
        page.wait_for_function(SAVED)
        assert (file.read_text(encoding="utf-8"), faults) == (text, [])

        file.write_text("crank = 3\n", encoding="utf-8")
        page.locator(".banner").get_by_text("mine.toml:1:").wait_for()
        page.locator(".live-scheme").wait_for()  # as it was before
        file.write_text(FOUR_BAR, encoding="utf-8")
        page.locator(".banner").wait_for(state="detached")
        page.locator(".live-scheme").wait_for()
        state = page.locator("meta[name=linkproof-state]").get_attribute("content")
        page.route("**/state", lambda route: route.fulfill(body=state))  # the page has not noticed yet
        file.write_text(text, encoding="utf-8")
        click(page, "Save to mine.toml")
        page.get_by_text("has changed since this page was built: nothing was written").wait_for()
        assert file.read_text(encoding="utf-8") == text
