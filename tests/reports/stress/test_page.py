"""The stability page: the verdict first, every axis with its map, every incident with its reason and command."""

import json
import re

import pytest

from comparisons.stress.cell_result import StressVerdict
from reports.document import html
from reports.stress.page import MOST_OPEN, OPEN, page
from reports.stress.tables import incident_table
from tests.reports.made_up_stress import made_up_stress

STRESS = made_up_stress()


@pytest.fixture(scope="module")
def written(tmp_path_factory):
    return html.write(page(STRESS), tmp_path_factory.mktemp("report"), [])


@pytest.fixture(scope="module")
def text(written):
    return written.read_text(encoding="utf-8")


def test_the_verdict_stands_before_everything(text):
    assert text.index('class="verdict"') < text.index("<section") < text.index('class="widget"')


def test_the_first_map_is_on_the_page_and_the_others_beside_it(written, text):
    first, *others = STRESS.axes
    (data,) = re.findall(r'<script type="application/json">(.*?)</script>', text, re.DOTALL)
    assert json.loads(data)["map"]["axis"] == first
    folder = written.parent / "data" / "stress"
    assert {file.name for file in folder.iterdir()} == {f"maps.{axis}.js" for axis in others}
    for axis in others:
        call = (folder / f"maps.{axis}.js").read_text(encoding="utf-8")
        assert call.startswith(f'linkproof.loaded("maps.{axis}",')


def test_every_axis_leads_to_its_map_and_has_a_figure_as_a_file(written, text):
    for axis in STRESS.axes:
        assert f'href="#map-{axis}"' in text
        assert (written.parent / "figures" / "stress" / f"map-{axis}.svg").is_file()


def test_what_was_missed_raised_or_crashed_stands_open_with_its_reason_and_command(text):
    for verdict in (*OPEN, StressVerdict.CAUGHT):
        cells = STRESS.of(verdict)
        (fold,) = re.findall(rf"<details( open)?>\s*<summary>{verdict.value.capitalize()} \({len(cells)}\)", text)
        assert bool(fold) == (verdict in OPEN and len(incident_table(cells).rows) <= MOST_OPEN)
    (missed, *_) = STRESS.of(StressVerdict.MISSED)
    assert missed.cell.command.replace("'", "&#39;") in text
    assert "velocity of &lt;rod&gt; off" in text
    assert "<rod>" not in text
    assert "a &lt;folder&gt;" in text


def test_what_did_not_occur_is_said(written):
    within = STRESS.of(StressVerdict.WITHIN)
    found = page(made_up_stress(cells=within, borders=[]))
    (incidents,) = [section for section in found.sections if section.key == "incidents"]
    assert (
        incidents.parts[-1].words == f"None: {', '.join(verdict.value for verdict in (*OPEN, StressVerdict.CAUGHT))}."
    )


def test_two_pages_of_one_test_are_the_same_text(text, tmp_path):
    assert html.write(page(made_up_stress()), tmp_path, []).read_text(encoding="utf-8") == text
