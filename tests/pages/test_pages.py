"""The pages of a report in a real browser: nothing missing, nothing wider than the screen, everything answers.

The figures of its engines are made up: what engines compute does not change a page's layout.
"""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from analytic.description.loading import load, parse, read
from comparisons.trials.campaign.results import save
from comparisons.trials.stress.campaign import save as save_stress
from comparisons.trials.work_precision.table import save as save_bench
from reports.document.html import _PageFiles
from reports.site import write_site
from tests.commands import empty_picture
from tests.made_up import made_up_bench, made_up_results, made_up_stress
from tests.pages.browser import WIDTHS, opened

MOST_SCREENS, MOST_NODES, MOST_BYTES, MOST_SHEETS = 12, 6_000, 1_500_000, 12
INDEX_SCREENS = 3
INDEX, MECHANISM = "index.html", "mechanisms/slotted-takeup.corrected.html"
STUDIES = ("bench.html", "stress.html")


@pytest.fixture(scope="module")
def report(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A report of two mechanisms in two engines, with a benchmark and a stability map; only the first is drawn."""
    folder = tmp_path_factory.mktemp("report")
    brief = re.sub("(?m)^duration .*", "duration = 0.5", read("slotted-takeup").text)  # of each released regime
    linkages = [parse(brief, "slotted-takeup", "slotted-takeup.toml"), load("fork-takeup")]
    results = made_up_results(linkages)
    save(folder, results.document, results.runs)
    save_bench(folder, made_up_bench())
    save_stress(folder, made_up_stress())
    picture = _PageFiles.picture
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(_PageFiles, "picture", lambda *of: (empty_picture if "fork" in of[0].page.file else picture)(*of))
        write_site(folder, processes=0)
    return folder


@pytest.fixture
def chromium(launched):
    return launched("chromium")


def _use_every_control(page) -> None:
    for fold in page.locator("summary").all():
        if fold.is_visible():
            fold.click()
    for choice in page.locator(".widget select").all():
        if choice.is_visible():
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


@pytest.mark.parametrize("name", [INDEX, MECHANISM, *STUDIES])
def test_a_page_is_complete_legible_and_of_a_size_to_be_read_and_its_controls_answer(chromium, report, name):
    with opened(chromium, report / name) as look:
        facts = look.facts()
        assert look.bytes_loaded <= MOST_BYTES
        assert facts["nodes"] <= MOST_NODES
        assert facts["screens"] <= (INDEX_SCREENS if name == INDEX else MOST_SCREENS)
        assert (facts["overflow"] <= 0, facts["small"], look.grave(), look.empty()) == (True, [], [], [])
        assert look.sheets() <= MOST_SHEETS
        if name == INDEX:
            assert facts["verdict"] <= 1.0
        _use_every_control(look.page)
        assert look.empty() == []
        assert look.faults == []


@pytest.mark.parametrize(
    "name", [MECHANISM, *(pytest.param(page, marks=pytest.mark.nightly) for page in (INDEX, *STUDIES))]
)
def test_a_page_is_legible_on_a_phone_at_night(chromium, report, name):
    with opened(chromium, report / name, WIDTHS[1], "dark") as look:
        facts = look.facts()
        assert (facts["overflow"] <= 0, facts["small"], look.grave()) == (True, [], [])


def test_a_printed_page_names_the_engines_of_its_dots_and_has_no_controls(chromium, report):
    with opened(chromium, report / MECHANISM) as look:
        look.page.emulate_media(media="print")
        assert look.page.get_by_role("group", name="Engines").inner_text().split() == [
            "Engines",
            "●",
            "alpha",
            "■",
            "beta",
        ]
        assert look.page.locator("select:visible, input:visible, button:visible").count() == 0
