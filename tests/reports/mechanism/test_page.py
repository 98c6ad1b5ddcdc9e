"""The page of a mechanism: figures in the units of the file, the thread, released cranks, samples of a motion."""

import math
from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from analytic.description.crank_motion import CrankMotion, Segment
from analytic.description.loading import catalogue, load, parse
from comparisons.designer.building import page_sheet, usual_sheet
from comparisons.designer.curves import SignalFigure
from comparisons.motion.case import Case
from reports.document.parts import FigureGroup, PageFigure, Paragraph, Widget
from reports.live import live_widget
from reports.mechanism.page import file_of, page, released_section, thread_section
from reports.mechanism.shown import words
from tests.analytic.linkages import MADE_UP, from_text, mechanism
from tests.made_up import made_up_results, unpacked
from tests.reports.designs.samples import CRANK, MASS, ROD, SPEED, TURN, piston_text, released_sheet


def figures(found):
    """Every figure of a page's sections."""
    if isinstance(found, PageFigure):
        return [found]
    if isinstance(found, FigureGroup):
        return list(found.figures)
    inner = next((getattr(found, name) for name in ("sections", "parts", "cards") if hasattr(found, name)), ())
    return [figure for part in inner for figure in figures(part)]


def section(found, key):
    return next((one for one in found.sections if one.key == key), None)


def key_rows(found):
    """The key figures of a page without scripts."""
    table = next(part for widget in found.parts if isinstance(widget, Widget) for part in widget.instead)
    return {row[0]: row[1:] for row in table.rows}


def test_key_figures_are_those_of_the_formulas_in_the_units_of_the_file():
    rows = key_rows(page_of(piston_text("mm", 1e-3)))
    assert rows["stroke"][0] == "100.0 mm"
    assert rows["RMS torque"][1] == ""  # a mean has no place
    assert rows["peak torque"][0].endswith(" N m")
    assert rows["peak torque"][1].endswith("°")


ORDINARY = ("shaper", "fork-takeup")
NIGHTLY = [pytest.param(name, marks=pytest.mark.nightly) for name in (*MADE_UP, *catalogue()) if name not in ORDINARY]


@cache
def sheet_of(name):
    return usual_sheet(mechanism(name).linkage)


def page_of(text):
    return page(page_sheet(Case(from_text(text), TURN)))


@pytest.mark.parametrize("name", [*ORDINARY, *NIGHTLY])
def test_every_linkage_has_a_page_whose_figures_have_files_of_their_own(name):
    linkage = mechanism(name).linkage
    found = page(sheet_of(name))
    names = [one.name for one in figures(found)]
    assert len(names) == len(set(names))
    assert all(one.alt and one.caption for one in figures(found))
    assert found.file == f"mechanisms/{linkage.name}.{linkage.variant}.html"


def test_its_file_needs_no_quoting_whatever_a_variant_is_called():
    linkage = replace(mechanism("juki-mf7923d").linkage, name="my yoke", variant='50% "#1"')
    assert file_of(linkage) == "mechanisms/my-yoke.50-1-.html"


def test_without_masses_a_sentence_stands_for_torque_and_forces():
    text = piston_text().replace(f"mass = {MASS}", "mass = 0").replace("inertia = 1e-3", "inertia = 0")
    found = page_of(text)
    assert "no torque" in section(found, "drive").parts[0].words
    assert not section(found, "forces")


def test_without_an_output_a_sentence_says_so():
    found = page_of(piston_text().replace('output = { point = "B" }\n', ""))
    assert "names no output" in section(found, "drive").parts[0].words
    assert "stroke" not in key_rows(found)


def test_a_linkage_without_a_list_of_operations_says_why_its_numbers_stay():
    found = page(usual_sheet(load("shaper-quick-return")))
    words = next(part.words for card in found.parts[-1].cards for part in card.parts if isinstance(part, Paragraph))
    assert words == (
        "The numbers of this page cannot be changed in it: one of its groups has no formula and is solved by Newton's "
        "method."
    )


def test_of_a_judged_file_the_verdict_is_first_and_its_errors_come_before_the_designers_figures():
    judged = made_up_results(samples=101)
    judged.document["judgement"] = ["Not right.", "Mkr has the other sign."]
    found = page(sheet_of("juki-mf7923d"), judged)
    assert found.parts[0] == Paragraph("Not right.", "verdict")
    assert found.parts[1].items == ("Mkr has the other sign.",)
    assert found.sections[0].key == "engines"


# The thread and released cranks on their pages.


REQUIRED = "[[0, 7.0], [60, 40.0], [-60, 14.0]]"


@pytest.fixture(scope="module")
def fed():
    text = load("slotted-takeup").text.replace("[thread]", f"[thread]\nrequired = {REQUIRED}")
    return usual_sheet(parse(text, "slotted-takeup", "slotted-takeup.toml"))


def test_the_section_of_a_thread_has_its_contour_feed_and_tables(fed):
    section = thread_section(fed, fed.thread, fed.positions)
    pictures, table, required = section.parts
    curve, points = pictures.figures[1].drawing().axes[0].lines[:2]
    assert points.get_xydata() == pytest.approx(np.array([(0.0, 7.0), (60.0, 40.0), (300.0, 14.0)]))
    assert np.ptp(curve.get_ydata()) == pytest.approx(50.469, abs=1e-3)
    rows = {row[0]: row[1:] for row in table.rows}
    assert rows["range of the feed"][0] == "50.47"
    assert [rows[what][-1] for what in ("P7 highest", "P7 lowest")] == ["117.97", "352.35"]
    assert rows["farthest from required"] == ("-3.593", "–", "60.00")
    assert required.rows[1] == ("60.00", "40.00", "36.41", "-3.593")


def test_what_cannot_be_computed_anew_is_given_as_samples_of_the_motion():
    sheet = shown()
    widget = live_widget(sheet, "its crank is released", ())
    names = [*(one["name"] for one in widget.data["results"]), *widget.data["further"]]
    phi, *rows = unpacked(widget.further["model"]["samples"])
    found = dict(zip(names, rows, strict=True))
    time = np.linspace(0.0, widget.data["motion"]["duration"], len(phi))
    assert phi == pytest.approx(SPEED * time, abs=1e-4)
    assert found["S"] == pytest.approx(np.interp(phi, sheet.values["phi"], sheet.values["S"]), abs=1e-4 * CRANK)
    assert found["point:A:x"] == pytest.approx(CRANK * np.cos(phi), abs=1e-4 * CRANK)
    assert not widget.data["numbers"]
    assert not widget.data["pulls"]


@pytest.fixture(scope="module")
def driven():
    return released_sheet()


def test_a_regime_is_told_in_sentences_and_shown_to_its_last_turn(driven):
    found = released_section(driven)
    (regime,) = found.parts
    sentences_of, figures = regime.parts
    assert "energy and work balance" in sentences_of.items[-1]
    assert [one.name for one in figures.figures] == ["released-driven", "released-driven-last-turn"]


# A data sheet in the units of its file, over the crank angle of a turn.


def shown(speed=SPEED, start=0.0, length="mm", metres=1e-3):
    motion = CrankMotion("constant-speed", (Segment(0.0, 2.0 * math.pi / abs(speed), (start, speed)),))
    return page_sheet(Case(from_text(piston_text(length, metres)), motion))


@pytest.mark.parametrize(("speed", "start"), [(SPEED, 0.0), (-SPEED, 0.0), (SPEED, 2.0), (-SPEED, 1.0)])
def test_a_turn_is_shown_from_0_to_360_degrees_however_it_is_made(speed, start):
    found = shown(speed, start)
    assert found.is_turn
    assert np.all(np.diff(found.x) > 0.0)
    assert found.x[-1] - found.x[0] == pytest.approx(360.0)
    phi = np.radians(found.x)
    place = 1e3 * (CRANK * np.cos(phi) + np.sqrt(ROD**2 - (CRANK * np.sin(phi)) ** 2))
    travel = (place - np.min(place)) if abs(found.y("S")[0] - np.ptp(place)) < 1.0 else np.max(place) - place
    assert found.y("S") == pytest.approx(travel, abs=1e-3)


@pytest.mark.parametrize(
    ("length", "metres", "one", "text"),
    [
        ("mm", 1e-3, SignalFigure("stroke", "S", 0.1, "m"), "100.0 mm"),
        ("m", 1.0, SignalFigure("stroke", "S", 0.1, "m"), "0.1000 m"),
        ("mm", 1e-3, SignalFigure("peak a", "a", -2.0, "m/s²"), "−2000 mm/s²"),
        ("mm", 1e-3, SignalFigure("peak v", "v", 1e-13, "m/s"), "0 mm/s"),  # rounding beside its signal
        ("mm", 1e-3, SignalFigure("A", "joint_force:A:magnitude", None, "N"), "–"),
    ],
)
def test_a_figure_stands_in_the_units_of_the_file(length, metres, one, text):
    assert words(shown(length=length, metres=metres), one) == text
