"""The benchmark's page: complete, escaped, offline; its tables and sentences say what the records say."""

import json
import re

import pytest

from comparisons.work_precision.records import FILE, Bench, load, save
from reports.work_precision import page as bench_page
from reports.work_precision.facts import failed_methods, places
from reports.work_precision.section import choice_tables, section
from reports.work_precision.words import choice_words, standing_words
from tests.comparisons.bench_rows import points, row, setting_row
from tests.reports.made_up_bench import document, made_up_bench, nothing_finished

BENCH = made_up_bench()


@pytest.fixture(scope="module")
def page():
    return bench_page.page(BENCH)


def test_the_page_stands_alone_beside_its_script(page):
    assert page.startswith("<!doctype html>")
    assert '<script src="plotly.min.js"></script>' in page
    assert not re.search(r"(src|href)=\"https?:", page)
    assert "cdn" not in page


def test_every_place_has_a_plot_a_table_and_an_anchor(page):
    for place in places(BENCH):
        key = f"bench-{place.mechanism}-{place.variant}-{place.regime}"
        assert f'<section id="{key}"' in page
        assert f'href="#{key}"' in page
        assert f'id="{key}-plot"' in page


def test_what_engines_say_is_escaped(page):
    outside = re.sub(r"<script.*?</script>", "", page, flags=re.DOTALL)
    assert "the joints &lt;gave&gt; way" in outside
    assert "what &lt;plain&gt; does" in outside
    assert "<gave>" not in outside
    assert "NaN" not in outside


def test_orders_floors_and_causes_stand_in_the_tables(page):
    assert "still falling" in page
    assert "10 iterations: 3.0e-2; 100 iterations: 6.1e-6" in page
    assert page.count('<td class="num">2.0</td>') >= 2
    assert page.count('<td class="num">4.0</td>') >= 2


def test_how_it_was_measured_is_said_in_figures(page):
    assert "some additions" in page
    assert "1.00 ms at best, 10 % longer in the median" in page
    assert "alpha 200 ms, beta 200 ms" in page


def test_the_folder_has_page_script_and_plots(tmp_path):
    save(tmp_path / FILE, BENCH.document)
    bench_page.write(load(tmp_path), tmp_path)
    assert {path.name for path in tmp_path.iterdir()} == {
        FILE, "bench.html", "plotly.min.js", "bench-run-up-quintic.svg", "bench-run-up-quintic.png",
    }  # fmt: skip
    assert json.loads((tmp_path / FILE).read_text())["format"] == 3
    assert (tmp_path / "bench-run-up-quintic.png").read_bytes().startswith(b"\x89PNG")


def test_two_pages_of_one_benchmark_are_the_same_text(page):
    assert bench_page.page(made_up_bench()) == page


def test_a_benchmark_that_gave_nothing_has_a_page_that_says_why():
    text = bench_page.page(nothing_finished())
    assert "unavailable: not installed" in text


def test_the_fragment_has_a_table_for_every_engine():
    told = section(BENCH)
    assert list(choice_tables(BENCH)) == ["alpha", "beta"]
    assert told.count('<table class="choices">') == 2
    assert told.count("<svg") == 1
    assert "<made up>" not in told


def test_a_choice_names_its_way_its_step_and_its_price():
    (alpha, _) = places(BENCH)[0].engines("Mkr")
    cells = [choice_words(choice, alpha) for choice in alpha.choices]
    assert cells[0][:3] == ("4.00 ms", "plain", "4")
    cost, way, *_ = cells[-1]
    assert cost
    assert way == "best x4"
    assert "higher x2" in {way for _, way, *_ in cells}


def test_the_control_has_a_table_under_its_name_and_is_held_against_nothing(page):
    bench = made_up_bench(control="alpha")
    assert list(choice_tables(bench)) == ["beta", "alpha (control)"]
    _, alpha = places(bench)[0].engines("Mkr")
    assert alpha.is_control
    assert standing_words(alpha, 0.1) == []
    assert "alpha (control)" in bench_page.page(bench)
    assert "(control)" not in page


def test_what_an_engine_does_not_tell_is_said_once_where_it_is_missing():
    told = {"left_out": {"Jeq": "Jeq computed by the adapter"}}
    rows = [row(**told), setting_row("tuned", 1e-3, 1e-2, **told), row(quantity="Jeq", engine="beta")]
    bench = Bench(document(points(rows), ("m",), ("alpha", "beta")))
    alpha, beta = places(bench)[0].engines("Jeq")
    assert failed_methods(alpha) == ("plain, tuned: not-provided: Jeq computed by the adapter",)
    assert failed_methods(beta) == failed_methods(places(bench)[0].engines("Mkr")[0]) == ()
    partly = row(quantity="joint_force", left_out={"joint_force": "joint_force:A not offered"})
    (alpha,) = places(Bench(document(points([partly]), ("m",), ("alpha",))))[0].engines("joint_force")
    assert failed_methods(alpha) == ("joint_force:A not offered",)


def test_a_setting_is_said_to_be_on_ahead_of_or_off_the_front():
    (alpha, _) = places(BENCH)[0].engines("Mkr")
    told = {words.split()[1].rstrip(":"): words for words in standing_words(alpha, 0.1)}
    assert told["naive"].endswith(": no solution")
    assert told["best"].endswith("no method measured gets there")
    assert "x2" not in told["tuned"]
    assert "on the front of single runs: plain takes 15.8 ms" in told["tuned"]
    assert "1.1 × the front of single runs" in " ".join(standing_words(alpha, 0.01))
