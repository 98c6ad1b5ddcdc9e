"""linkproof check-engine: a line of each check, and an exit code."""

import json

import pytest

from analytic.errors import LinkproofError
from reports.command_line.commands import engines
from reports.command_line.destination import Destination
from tests.comparisons.conformance.wrong_engines import Direct, PrintingEngine


class AbsentEngine(Direct):
    """It is not installed."""

    def version(self):
        return None


class ExcusedEngine(PrintingEngine):
    """It prints, and says why."""

    expected_failures = {"silence": "its licence banner"}  # noqa: RUF012


@pytest.fixture
def checked(monkeypatch, tmp_path, capsys):
    def check(engine):
        monkeypatch.setattr(engines, "engine", lambda name: engine)
        code = engines.check("mine", Destination(json=str(tmp_path / "found.json")), 2)
        return code, capsys.readouterr().out, json.loads((tmp_path / "found.json").read_text())["checks"]

    return check


def test_a_failed_check_has_a_sentence_and_exit_code_1(checked):
    code, out, found = checked(PrintingEngine())
    assert code == 1
    (line,) = (line for line in out.splitlines() if line.startswith("silence"))
    assert line.split(None, 2)[1] == "failed"
    assert "got 'stepping" in line
    assert len(out.splitlines()) < len(found)  # mutants that say the same share a line
    assert [each["check"] for each in found if each["finding"] == "failed"] == ["silence"]


def test_an_expected_failure_is_told_with_its_reason_and_is_no_failure(checked):
    code, out, _ = checked(ExcusedEngine())
    assert code == 0
    assert "silence        expected failure  its licence banner (expected silence" in out
    assert "1 expected failure" in out.splitlines()[-1]


def test_an_engine_that_cannot_be_sent_to_another_process_is_not_taken_for_checked(checked):
    engine = Direct()
    engine.handle = lambda: None
    with pytest.raises(LinkproofError, match="cannot be sent to another process"):
        checked(engine)


def test_an_engine_that_is_not_installed_leaves_nothing_to_check(checked):
    with pytest.raises(LinkproofError, match="not installed"):
        checked(AbsentEngine())
