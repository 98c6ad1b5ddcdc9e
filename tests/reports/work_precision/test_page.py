"""The benchmark's page: complete, escaped, offline, the same text for the same benchmark."""

import re
from dataclasses import asdict

import pytest

from comparisons.work_precision.records import KIND, Bench, MeasuredCost, load, save
from reports.document import html
from reports.document.parts import Fold, Section
from reports.work_precision.page import page
from tests.reports.made_up_bench import made_up_bench, nothing_finished

BENCH = made_up_bench()


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """A folder with the page of a benchmark that was saved."""
    found = tmp_path_factory.mktemp("bench")
    save(found, BENCH)
    html.write(page(load(found)), found, ())
    return found


def test_the_folder_has_the_page_its_figures_and_the_places_that_are_loaded_when_chosen(folder):
    names = {path.relative_to(folder).as_posix() for path in folder.rglob("*") if path.is_file()}
    assert {"bench.html", f"{KIND}/study.json", "figures/bench/run-up-quintic.svg"} <= names
    (further,) = (folder / "data" / "bench").iterdir()
    assert "rimoldi-164" in further.name
    assert "rimoldi-164" in (folder / "bench.html").read_text(encoding="utf-8")


def test_what_engines_say_is_escaped_and_nothing_is_fetched(folder):
    text = (folder / "bench.html").read_text(encoding="utf-8")
    assert "the joints &lt;gave&gt; way" in text
    assert "what &lt;plain&gt; does" in text
    assert not re.search(r"<(gave|made up|plain)>", text)
    assert "NaN" not in text
    assert not re.search(r"(src|href)=\"https?:", text)


def test_the_diagram_comes_first_and_failures_stand_once_with_their_places():
    made = page(BENCH)
    assert [type(part).__name__ for part in made.parts[:2]] == ["Paragraph", "Widget"]
    assert [section.key for section in made.sections] == ["use", "settings", "failed", "measured"]
    (fold,) = _section(made, "failed").parts
    assert isinstance(fold, Fold)
    told = "torn: diverged: the joints <gave> way (everywhere)"
    assert fold.parts[0].items == (f"alpha, {told}", f"beta, {told}")


def _section(made, key) -> Section:
    return next(section for section in made.sections if section.key == key)


def test_costs_have_a_section_where_they_were_measured():
    cost = MeasuredCost("made-up", "base", "alpha", "everything", "", seconds=(1.0, 0.5, 0.75))
    made = page(Bench({**BENCH.document, "costs": [asdict(cost)]}, BENCH.points))
    assert _section(made, "costs").heading == "What each output and load costs"


def test_a_benchmark_that_gave_nothing_has_a_page_that_says_why(tmp_path):
    text = html.write(page(nothing_finished()), tmp_path, ()).read_text(encoding="utf-8")
    assert "Nothing finished" in text
    assert "gamma: unavailable: not installed" in text


def test_two_pages_of_one_benchmark_are_the_same_text(folder, tmp_path):
    again = html.write(page(made_up_bench()), tmp_path, ())
    assert again.read_bytes() == (folder / "bench.html").read_bytes()
