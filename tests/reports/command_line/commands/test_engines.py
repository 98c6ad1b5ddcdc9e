"""``linkproof check-engine`` and ``export``: a line for each check, a script of one run, refusals in one sentence."""

import ast
import json
import re

import pytest

from analytic.errors import LinkproofError
from comparisons.conformance import conformance
from reports.command_line.commands import engines
from reports.command_line.commands.engines import export
from reports.command_line.destination import Destination
from reports.requests.campaign_options import ExportOptions
from tests.comparisons.conformance.wrong_engines import Direct, PrintingEngine

CELL = "jump/four-bar/0.1/exudyn/tuned"


class AbsentEngine(Direct):
    """It is not installed."""

    def version(self):
        return None


class ExcusedEngine(PrintingEngine):
    """It prints, with a reason."""

    expected_failures = {"silence": "its licence banner"}  # noqa: RUF012


class UnsendableEngine(Direct):
    """It cannot be sent to another process."""

    def __init__(self):
        self.handle = lambda: None


@pytest.fixture
def checked(monkeypatch, capsys):
    """Exit code, output and records of ``check-engine`` with a few of its checks, two mutants among them."""
    mutants = [name for name in conformance.CHECKS if name.startswith(conformance.MUTANT)]
    names = ("identity", "installed", "silence", *mutants[:2])
    monkeypatch.setattr(conformance, "CHECKS", {name: conformance.CHECKS[name] for name in names})

    def check(engine):
        monkeypatch.setattr(engines, "engine", lambda name: engine)
        code = engines.check("mine", Destination(), 1)
        printed = capsys.readouterr().out
        engines.check("mine", Destination(json=True), 1)
        return code, printed, json.loads(capsys.readouterr().out)["checks"]

    return check


def test_a_failed_check_has_a_sentence_and_exit_code_1(checked):
    code, out, found = checked(PrintingEngine())
    assert code == 1
    (line,) = (line for line in out.splitlines() if line.startswith("silence"))
    assert line.split(None, 2)[1] == "failed"
    assert "got 'stepping" in line
    assert "2 mutants" in out  # which share a line
    assert [each["check"] for each in found if each["finding"] == "failed"] == ["silence"]


def test_an_expected_failure_has_its_reason_and_is_no_failure(checked):
    code, out, _ = checked(ExcusedEngine())
    assert code == 0
    assert re.search(r"silence +expected failure +its licence banner \(expected silence", out)
    assert "1 expected failure" in out.splitlines()[-1]


@pytest.mark.parametrize(
    ("engine", "words"), [(UnsendableEngine, "cannot be sent to another process"), (AbsentEngine, "not installed")]
)
def test_an_engine_that_cannot_be_checked_is_refused(checked, engine, words):
    with pytest.raises(LinkproofError, match=words):
        checked(engine())


def _options(**changed):
    given = {"mechanism": "rimoldi-164", "engine": "exudyn", "ramp_time": 0.05, "hold_time": 0.01}
    return ExportOptions(**given | changed)


def test_a_script_names_its_run_and_the_command_that_wrote_it(tmp_path, capsys):
    pytest.importorskip("exudyn")
    export(_options(), tmp_path / "case.py")
    text = (tmp_path / "case.py").read_text(encoding="utf-8")
    title = ast.get_docstring(ast.parse(text))
    assert title.startswith("rimoldi-164 (as-built), run-up, in exudyn ")
    assert "linkproof export rimoldi-164 --ramp-time 0.05 --hold-time 0.01 --engine exudyn" in " ".join(title.split())
    assert not {"linkproof", "analytic", "engines", "comparisons"} & set(text.partition("\nimport")[2].split())
    export(ExportOptions(cell=CELL), None)
    assert f"linkproof export --cell {CELL}" in ast.get_docstring(ast.parse(capsys.readouterr().out))


@pytest.mark.parametrize(("options", "words"), [
    (_options(setting="best"), "it is 4 runs extrapolated, and a script holds one: export 'tuned'"),
    (_options(setting="all"), "got 1 and 3"),
    (_options(engine="direct"), "whose loop is a module of its own \\(a LoopEngine\\), got 'direct': export another"),
    (_options(engine="exudin"), "did you mean 'exudyn'"),
    (_options(engine=None), "expected one --engine"),
    (_options(cell=CELL), "not both"),
    (ExportOptions(), "not both"),
    (ExportOptions(speed=900.0, cell=CELL), "--cell already defines"),
    (
        ExportOptions(cell="start/positions/0.01/exudyn/tuned"),
        "cannot be exported: the start state violates joint 'A'",
    ),
])  # fmt: skip
def test_a_run_that_cannot_be_exported_is_one_sentence(options, words, tmp_path):
    pytest.importorskip("exudyn")
    with pytest.raises(LinkproofError, match=words):
        export(options, tmp_path / "case.py")
    assert not list(tmp_path.iterdir())
