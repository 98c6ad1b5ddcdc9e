"""Results that are printed: a line, the words of the command, a notebook's cell, a table."""

import numpy as np
import pytest

import linkproof
from comparisons.conformance import conformance
from tests.commands import linkproof as command

NAME = "juki-mf7923d"


@pytest.fixture
def curves(tmp_path, monkeypatch):
    """The closed form's own torque as a file of another tool, in the working folder."""
    monkeypatch.chdir(tmp_path)
    run = linkproof.results(NAME, regime="run-up", time=np.linspace(0.0, 0.7, 141))
    table = np.column_stack([run["time"], run["Mkr"], run["S"]])
    np.savetxt("a<b.csv", table, delimiter=",", header="time [s],Mkr [N*m],S [m]", comments="", fmt="%.9g")
    monkeypatch.setattr(conformance, "CHECKS", {"identity": conformance.CHECKS["identity"]})


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
        (lambda: linkproof.check_engine("direct", 1), ("check-engine", "direct", "--jobs", "1"),
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
    of, came = ("check", "finding") if "check" in table else ("quantity", "outcome")
    assert list(zip(table[of], table[came], strict=True)) == rows


def test_a_judgement_and_findings_are_what_they_were(curves):
    assert [verdict.name for verdict in linkproof.judge(NAME, "a<b.csv", regime="run-up").verdicts] == ["Mkr", "S"]
    checks = linkproof.check_engine("direct", 1)
    assert isinstance(checks, list)
    assert [one.check for one in checks] == ["identity"]
