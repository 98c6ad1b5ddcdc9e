"""``linkproof doctor``: everything installed is tried, and each failure has its reason."""

import json
import sys
from types import SimpleNamespace

import pytest

from analytic.machine_code import compiling
from comparisons.judging.records import Record, Verdict
from engines.registry import engine_names
from reports.requests import doctor
from tests.commands import linkproof
from tests.test_economy import EXTRAS

FACTS = {"mechanism": "m", "variant": "base", "regime": "run-up", "conditions": "", "setting": "tuned"}


def row(outcome, error=None, detail=""):
    facts = {**FACTS, "engine": "barwork", "engine_version": "3"}
    return Record(**facts, quantity="Mkr", outcome=outcome, error_max=error, detail=detail)


@pytest.mark.parametrize("names", [("direct",), pytest.param(engine_names(), marks=pytest.mark.nightly)])
def test_every_engine_and_the_compiler_are_tried_without_the_packages_of_extras(tmp_path, monkeypatch, names):
    for package in EXTRAS:
        monkeypatch.setitem(sys.modules, package, None)
    for module in ("reports.requests.doctor", "reports.requests.campaign"):
        monkeypatch.setattr(f"{module}.engine_names", lambda: names)
    done = linkproof("doctor", "--json", cwd=tmp_path)
    facts = json.loads(done.stdout)
    assert done.returncode == 0, done.stdout
    assert [trial["name"] for trial in facts["trials"]] == [*names, "machine code"]
    assert all(trial["works"] is not False for trial in facts["trials"])
    assert set(facts["places"]) == {"temporary files", "matplotlib's cache"}


@pytest.mark.parametrize(
    ("record", "works", "word"),
    [
        (row(Verdict.CRASHED, detail="exit code -11"), False, "crashed: exit code -11"),
        (row(Verdict.MEASURED, 0.5), True, "error of the torque 5.0e-01"),
    ],
)
def test_an_engine_works_if_it_simulates(monkeypatch, record, works, word):
    run = type("Run", (), {"records": [record]})
    monkeypatch.setattr(doctor, "compare", lambda _: [run])
    monkeypatch.setattr(doctor, "engine_names", lambda: ("barwork", "direct"))
    lacking = [SimpleNamespace(name=name, why_unavailable=lambda: "not installed") for name in ("barwork", "direct")]
    monkeypatch.setattr(doctor, "engines", lambda _: lacking)
    tried, absent = doctor.engine_trials()
    assert tried.works is works
    assert word in tried.detail
    assert (absent.name, absent.works, absent.detail) == ("direct", None, "not installed")


@pytest.mark.skipif(not compiling.is_installed(), reason="numba is not installed")
def test_a_broken_compiler_is_exit_code_1(monkeypatch, tmp_path):
    def broken(_):
        raise OSError("no LLVM\nhere")

    monkeypatch.setattr(compiling, "compile_source", broken)
    monkeypatch.setattr("reports.command_line.commands.doctor.engine_trials", list)
    done = linkproof("doctor", cwd=tmp_path)
    assert done.returncode == 1
    assert "OSError: no LLVM here" in done.stdout
