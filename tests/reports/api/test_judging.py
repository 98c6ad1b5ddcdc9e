"""``linkproof.compare``, ``check``, ``check_engine``, ``judge``: results as values, printed as the commands print."""

import re

import numpy as np
import pytest
from matplotlib.text import Text

import linkproof
from analytic.description.loading import read
from comparisons.trials.conformance import conformance
from engines.registry import Unusable
from tests.commands import linkproof as command

FAST = {"engine": "direct", "bounds": linkproof.Bounds(jobs=0)}


def test_records_are_a_table_and_a_picture_by_run_and_quantity():
    found = linkproof.compare("juki-mf7923d", setting=["naive", "tuned"], **FAST)
    assert found.ok
    assert found.command == "linkproof compare juki-mf7923d --engine direct --setting naive --setting tuned"
    drawn = {text.get_text() for text in found.plot(regime="run-up").findobj(Text)}
    assert {"largest error over its limit", "Mkr"} <= drawn
    with pytest.raises(linkproof.LinkproofError, match="unknown regime 'runup': did you mean 'run-up'"):
        found.plot(regime="runup")
    table = found.dataset
    assert table["setting"].values.tolist() == ["naive", "tuned"]
    for record in found.records:
        row = table.isel(run=["naive", "tuned"].index(record.setting)).sel(quantity=record.quantity)
        assert np.array_equal(row["error_max"], np.float64(record.error_max), equal_nan=True)
        assert row["outcome"].item() == record.outcome
    assert table["steps"].values.tolist() == [run.steps for run in found.results.runs]


def test_a_check_gives_the_comparison_or_shows_every_row_over_its_limit_of_a_file(tmp_path):
    press, limits = tmp_path / "press.toml", tmp_path / "limits.toml"
    press.write_text(read("juki-mf7923d").text, encoding="utf-8")
    limits.write_text('[[limit]]\nquantities = ["Mkr"]\nvalue = 1e-30\nreason = "none can"\n')
    found = linkproof.compare(press, quantity=("Mkr", "Jeq"), **FAST)
    assert found.check() is found
    found = linkproof.compare(press, quantity=("Mkr", "Jeq"), limits=limits, **FAST)
    assert [record.outcome for record in found.records] == ["over-limit", "passed"]
    with pytest.raises(AssertionError) as failed:
        found.check()
    head, row = str(failed.value).splitlines()
    assert head == "1 of 2 errors and checks failed"
    assert re.fullmatch(
        r"press \(as-built\), run-up, direct tuned, Mkr: over-limit, error \S+ of peak is over its limit 1e-30", row
    )


def test_what_changed_since_results_were_recorded_fails_a_check(tmp_path):
    held = tmp_path / "held.csv"
    linkproof.compare("juki-mf7923d", quantity="Jeq", record=held, **FAST)
    assert linkproof.compare("juki-mf7923d", quantity="Jeq", against=held, **FAST).check().changes == ()
    held.write_text(held.read_text(encoding="utf-8").replace("Jeq.mean,,8.02", "Jeq.mean,,8.03"), encoding="utf-8")
    found = linkproof.compare("juki-mf7923d", quantity="Jeq", against=held, **FAST)
    with pytest.raises(AssertionError, match=r"0 of 1 errors and checks failed\n.*Jeq.mean: was 8.03\d+e-05 kg m²"):
        found.check()


def test_a_linkage_is_compared_as_its_file_is_and_nothing_else():
    linkage = linkproof.load("juki-mf7923d", "as-printed")
    found = linkproof.compare(linkage, quantity="Jeq", **FAST)
    assert [(record.mechanism, record.variant) for record in found.records] == [("juki-mf7923d", "as-printed")]
    with pytest.raises(linkproof.LinkproofError, match=r"expected a linkage, its name or path, .*, got 3;"):
        linkproof.compare(3)


NAME = "juki-mf7923d"


@pytest.fixture
def curves(tmp_path, monkeypatch):
    """The closed form's own torque and stroke as a file of another tool, in the working folder."""
    monkeypatch.chdir(tmp_path)
    run = linkproof.results(NAME, linkproof.Motion(regime="run-up"), time=np.linspace(0.0, 0.7, 141)).dataset
    table = np.column_stack([run["time"], run["Mkr"], run["S"]])
    np.savetxt("a<b.csv", table, delimiter=",", header="time [s],Mkr [N*m],S [m]", comments="", fmt="%.9g")


@pytest.fixture(autouse=True)
def _one_check(monkeypatch):
    monkeypatch.setattr(conformance, "CHECKS", {"identity": conformance.CHECKS["identity"]})


def test_results_of_another_tool_are_judged(curves):
    found = linkproof.judge(NAME, "a<b.csv", motion=linkproof.Motion(regime="run-up"))
    assert found.passed
    assert [verdict.name for verdict in found.verdicts] == ["Mkr", "S"]
    assert found.check() is found
    wrong = linkproof.judge(NAME, "a<b.csv", motion=linkproof.Motion(regime="run-up", gravity=False), limit=1e-4)
    with pytest.raises(
        AssertionError, match=r"run-up, a<b.csv imported, Mkr: over-limit, .* likely cause: y of gravity"
    ):
        wrong.check()


@pytest.mark.parametrize(
    ("engine", "words"),
    [
        (
            Unusable("barwork", "linkproof_barwork", None, ImportError("no module named barwork")),
            r"expected an adapter that can be loaded, but .*barwork",
        ),
        ("barwork", "unknown engine 'barwork'"),
        (3, "expected the name of an engine, or an adapter, got 3"),
    ],
)
def test_an_engine_that_cannot_be_used_is_an_error(engine, words):
    with pytest.raises(linkproof.LinkproofError, match=words):
        linkproof.check_engine(engine)


@pytest.mark.parametrize(
    ("make", "words", "line", "rows"),
    [
        (lambda: linkproof.compare(NAME, quantity=("Mkr", "S"), **FAST),
         ("compare", NAME, "--engine", "direct", "--quantity", "Mkr", "--quantity", "S", "--jobs", "0"),
         "<Comparison: 2 deviations: 2 passed; ", [("Mkr", "passed"), ("S", "passed")]),
        (lambda: linkproof.judge(NAME, "a<b.csv", motion=linkproof.Motion(regime="run-up")),
         ("judge", NAME, "a<b.csv", "--regime", "run-up"),
         "<Judgement: Right at the file's samples: all 2 signals are within 1.0 % of",
         [("Mkr", "passed"), ("S", "passed")]),
        (lambda: linkproof.check_engine("direct", 1), ("engines", "direct", "--check"),
         "<EngineFindings: direct: 1 passed>", [("identity", "passed")]),
    ],
    ids=["compare", "judge", "check_engine"],
)  # fmt: skip
def test_a_result_is_printed_as_its_command_prints_it(curves, make, words, line, rows):
    result, done = make(), command(*words)
    assert repr(result).startswith(line)
    assert "\n" not in repr(result)
    timeless = [
        [row for row in text.strip().splitlines() if "seconds" not in row] for text in (str(result), done.stdout)
    ]
    assert timeless[0] == timeless[1]
    assert result._repr_html_().startswith("<pre>")
    assert "a<b" not in result._repr_html_()
    table = result.to_pandas()
    names = ("check", "finding") if "check" in table else ("quantity", "outcome")
    assert list(zip(*(table[name] for name in names), strict=True)) == rows
