"""``linkproof.check``, ``check_engine`` and ``judge``: the results of the commands as values, printed as they print."""

import json

import numpy as np
import pytest

import linkproof
from comparisons.conformance import conformance
from engines.direct_adapter.adapter import DirectEngine
from engines.registry import Unusable
from tests.commands import linkproof as command

NAME = "juki-mf7923d"


@pytest.fixture
def curves(tmp_path, monkeypatch):
    """The closed form's own torque and stroke as a file of another tool, in the working folder."""
    monkeypatch.chdir(tmp_path)
    run = linkproof.results(NAME, regime="run-up", time=np.linspace(0.0, 0.7, 141))
    table = np.column_stack([run["time"], run["Mkr"], run["S"]])
    np.savetxt("a<b.csv", table, delimiter=",", header="time [s],Mkr [N*m],S [m]", comments="", fmt="%.9g")


@pytest.fixture(autouse=True)
def _one_check(monkeypatch):
    monkeypatch.setattr(conformance, "CHECKS", {"identity": conformance.CHECKS["identity"]})


def test_the_facts_of_a_check_are_the_commands_and_a_fault_is_a_fact(tmp_path):
    printed = command("check", "rimoldi-164", "--json").stdout
    assert json.loads(json.dumps(linkproof.check("rimoldi-164"))) == json.loads(printed)
    text = linkproof.load(NAME).text
    assert "D = [54.5, 0]" in text
    (tmp_path / "short.toml").write_text(text.replace("D = [54.5, 0]", "D = [1, 0]"))
    assert "cannot be assembled" in linkproof.check(tmp_path / "short.toml")["fault"]


def test_results_of_another_tool_are_judged(curves):
    found = linkproof.judge(NAME, "a<b.csv", regime="run-up")
    assert found.passed
    assert [verdict.name for verdict in found.verdicts] == ["Mkr", "S"]
    assert found.check() is found
    wrong = linkproof.judge(NAME, "a<b.csv", regime="run-up", gravity=False, limit=1e-4)
    with pytest.raises(
        AssertionError, match=r"run-up, a<b.csv imported, Mkr: over-limit, .* likely cause: y of gravity"
    ):
        wrong.check()


def test_an_engine_is_checked_by_name_or_as_it_is():
    for engine in ("direct", DirectEngine()):
        found = linkproof.check_engine(engine, 1)
        assert isinstance(found, list)
        assert [(result.check, result.finding) for result in found] == [("identity", "passed")]


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
        (lambda: linkproof.compare(NAME, engine="direct", quantity=("Mkr", "S"), jobs=0),
         ("compare", NAME, "--engine", "direct", "--quantity", "Mkr", "--quantity", "S", "--jobs", "0"),
         "<Comparison: 2 deviations: 2 passed; ", [("Mkr", "passed"), ("S", "passed")]),
        (lambda: linkproof.judge(NAME, "a<b.csv", regime="run-up"),
         ("judge", NAME, "a<b.csv", "--regime", "run-up"),
         "<JudgedResults: Right at the file's samples: all 2 signals are within 1.0 % of",
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
