"""A benchmark in words and tables: choices, orders and floors, and the terminal."""

import re

import pytest

from comparisons.trials.work_precision.table import Bench, by_regime, load, save
from reports.bench import page, printout, verdicts
from reports.document import html
from reports.document.terminal import rendered
from tests.made_up import bench_document, made_up_bench, nothing_finished, points, setting_row

BENCH = made_up_bench()


def _regimes(*rows, mechanisms=("m",)):
    return by_regime(Bench(bench_document(mechanisms, ("alpha", "beta")), points(rows)))


def test_the_winner_of_an_error_is_the_cheapest_engine_of_most_mechanisms():
    rows = [
        setting_row("tuned", 1e-4, seconds, engine=engine, mechanism=mechanism)
        for mechanism, alpha, beta in (("m", 1.0, 2.0), ("n", 1.5, 3.0), ("o", 9.0, 4.0))
        for engine, seconds in (("alpha", alpha), ("beta", beta))
    ]
    (told,) = verdicts(_regimes(*rows, mechanisms=("m", "n", "o")), 0.1)
    assert told.role == "verdict"
    assert told.words == (
        "Cheapest for Mkr in run-up-quintic: for 1 % alpha (1.00 s to 1.50 s, on 2 of 3 mechanisms) or beta (4.00 s, "
        "on 1 of 3 mechanisms); for 0.1 % alpha (1.00 s to 1.50 s, on 2 of 3 mechanisms) or beta (4.00 s, on 1 of 3 "
        "mechanisms); for 1e-6 none. Times within 10 % of the least, the noise of the machine, are ties."
    )


def test_times_within_the_noise_are_a_tie():
    rows = [setting_row("tuned", 1e-4, seconds, engine=name) for name, seconds in (("alpha", 1.0), ("beta", 1.1))]
    (tied,), (told,) = verdicts(_regimes(*rows), 0.15), verdicts(_regimes(*rows), 0.05)
    assert "for 1 % alpha (1.00 s) or beta (1.10 s); " in tied.words
    assert "for 1 % alpha (1.00 s); " in told.words


def test_an_engine_that_is_always_the_cheapest_is_named_once():
    rows = [setting_row("tuned", 1e-7, seconds, engine=name) for name, seconds in (("alpha", 1.0), ("beta", 2.0))]
    (told,) = verdicts(_regimes(*rows), 0.05)
    assert told.words.startswith(
        "Cheapest for Mkr in run-up-quintic at every accuracy: alpha, 1.00 s for 1 %, 1.00 s for 0.1 %, 1.00 s for 1e-6"
    )


def _text(bench, quantities=(), width=110):
    tables, closing, _ = printout(bench, quantities)
    return rendered(*tables, *closing, width=width)


def test_methods_choices_and_settings_stand_in_one_block_per_place():
    text = _text(made_up_bench())
    assert text.count("largest error over the peak") == 2
    assert "alpha   1e-2          4.00 ms  plain @ 4\n" in text
    assert "beta    1e-6 to 1e-7   256 ms  higher x2 @ 32\n" in text
    assert "alpha   tuned     4.0e-4  17.0 ms         –\n" in text
    assert "torn: diverged: the joints <gave> way" in text
    assert "of a point's repeats is 10 % longer" in " ".join(text.split())


# A benchmark's diagram, static figures and page.


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """A folder with the page of a benchmark that was saved."""
    found = tmp_path_factory.mktemp("bench")
    save(found, BENCH)
    html.write(page(load(found)), found, ())
    return found


def test_what_engines_say_is_escaped_and_nothing_is_fetched(folder):
    text = (folder / "bench.html").read_text(encoding="utf-8")
    assert "the joints &lt;gave&gt; way" in text
    assert "what &lt;plain&gt; does" in text
    assert not re.search(r"<(gave|made up|plain)>", text)
    assert "NaN" not in text
    assert not re.search(r"(src|href)=\"https?:", text)


@pytest.mark.parametrize(("inside", "named"), [(0.71e-2, False), (0.69e-2, True), (None, False)])
def test_an_overhead_over_30_percent_is_named(tmp_path, inside, named):
    run = setting_row("tuned", 1e-4, None, seconds=1e-2, repeats=(1e-2,), engine_seconds=inside)
    file, *_ = html.write(page(Bench(bench_document(("m",), ("alpha",)), [run])), tmp_path, ())
    text = (tmp_path / file).read_text(encoding="utf-8")
    assert ("work of the adapter, not of the engine: alpha tuned up to 31\u00a0% (m, run-up-quintic)." in text) is named


def test_a_benchmark_that_gave_nothing_has_a_page_that_says_why(tmp_path):
    file, *_ = html.write(page(nothing_finished()), tmp_path, ())
    text = (tmp_path / file).read_text(encoding="utf-8")
    assert "Nothing finished" in text
    assert "gamma: unavailable: not installed" in text
