"""``linkproof engines``, and ``compare --script``: a line for each check, what is installed, a script of one run."""

import ast
import json
import re
import sys
from dataclasses import replace
from types import SimpleNamespace

import pytest

from analytic import machine_code
from analytic.errors import LinkproofError
from comparisons.trials.conformance import conformance
from comparisons.trials.judging.records import RunRecord, Verdict
from engines.registry import own_names
from reports.api.options import Motion
from reports.api.trials import check_engine, compare
from reports.studies import engines as studied
from tests.commands import linkproof, refused
from tests.comparisons.trials.conformance.wrong_engines import Direct, PrintingEngine
from tests.test_economy import EXTRAS


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
def checked(monkeypatch):
    """Exit code, output and records of ``engines --check`` with a few of its checks, two mutants among them."""
    mutants = [name for name in conformance.CHECKS if name.startswith(conformance.MUTANT)]
    names = ("identity", "installed", "silence", *mutants[:2])
    monkeypatch.setattr(conformance, "CHECKS", {name: conformance.CHECKS[name] for name in names})

    def check(engine):
        found = check_engine(engine, 1)
        return found.exit_code, str(found), json.loads(found.json())["checks"]

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


@pytest.mark.parametrize("names", [("direct",), pytest.param(own_names(), marks=pytest.mark.nightly)])
def test_every_engine_and_the_compiler_are_tried_without_the_packages_of_extras(tmp_path, monkeypatch, names):
    for package in EXTRAS:
        monkeypatch.setitem(sys.modules, package, None)
    monkeypatch.setattr("reports.studies.engines.engine_names", lambda: names)
    done = linkproof("engines", "--try", "--json", cwd=tmp_path)
    facts = json.loads(done.stdout)
    assert done.returncode == 0, done.stdout
    assert [trial["name"] for trial in facts["trials"]] == [*names, "machine code"]
    assert all(trial["works"] is not False for trial in facts["trials"])


def test_an_engine_that_crashes_or_is_absent_does_not_work(monkeypatch):
    run = RunRecord("m", "base", "run-up", "", "barwork", "3", "tuned")
    crashed = run.blank._replace(quantity="Mkr", outcome=Verdict.CRASHED, detail="-11")
    monkeypatch.setattr(studied, "compare", lambda _: [replace(run, errors=(crashed,))])
    monkeypatch.setattr(studied, "engine_names", lambda: ("barwork", "direct"))
    lacking = [SimpleNamespace(name=name, why_unavailable=lambda: "not installed") for name in ("barwork", "direct")]
    monkeypatch.setattr(studied, "registered", lambda _: lacking)
    tried, absent = studied.engine_trials()
    assert (tried.works, tried.detail) == (False, "crashed: -11")
    assert (absent.name, absent.works, absent.detail) == ("direct", None, "not installed")


@pytest.mark.skipif(not machine_code.is_installed(), reason="numba is not installed")
def test_a_broken_compiler_is_exit_code_1(monkeypatch, tmp_path):
    def broken(_):
        raise OSError("no LLVM\nhere")

    monkeypatch.setattr(machine_code, "compile_source", broken)
    monkeypatch.setattr("reports.studies.engines.engine_trials", list)
    done = linkproof("engines", "--try", cwd=tmp_path)
    assert done.returncode == 1
    assert "OSError: no LLVM here" in done.stdout


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        (("--check",), "--check tests one engine, got 0: linkproof engines NAME --check"),
        (("direct", "--try"), "--try tries everything that is installed: leave the names of engines out"),
        (("direct", "--check", "--try"), "--check and --try exclude each other"),
    ],
)
def test_words_that_do_not_go_together_are_refused(words, sentence):
    assert sentence in refused("engines", *words)


SHORT = ("--ramp-time", "0.05", "--hold-time", "0.01")


def test_a_script_names_its_run_and_the_command_that_wrote_it(tmp_path):
    pytest.importorskip("exudyn")
    done = linkproof("compare", "rimoldi-164", *SHORT, "--engine", "exudyn", "--script", "case.py", cwd=tmp_path)
    assert (done.returncode, done.stdout, done.stderr) == (0, "", "wrote case.py\n")
    text = (tmp_path / "case.py").read_text(encoding="utf-8")
    title = " ".join(ast.get_docstring(ast.parse(text)).split())
    assert title.startswith("rimoldi-164 (as-built), run-up, in exudyn ")
    assert f"linkproof compare rimoldi-164 --engine exudyn --script case.py {' '.join(SHORT)}" in title
    assert not {"linkproof", "analytic", "engines", "comparisons"} & set(text.partition("\nimport")[2].split())


@pytest.mark.parametrize(("changes", "sentence"), [
    ({"setting": ("best",)}, "it is 4 runs extrapolated, and a script holds one: export 'tuned'"),
    ({"setting": ("all",)}, "1 motions and 3 settings: name one MECHANISM, --engine, --regime and --setting"),
    ({"engine": ("direct",)}, r"whose loop is a module of its own \(a LoopEngine\), got 'direct': export another"),
    ({"engine": ("exudin",)}, "did you mean 'exudyn'"),
    ({"engine": ("direct", "exudyn")}, "got 1 mechanisms, 2 engines"),
    ({"mechanisms": ()}, r"got \d+ mechanisms, 1 engines"),
    ({"script": "none/case.py"}, "--script none/case.py: the folder 'none' does not exist"),
    ({"quantity": ("Mkr",)}, "--script runs nothing: leave out every option but"),
])  # fmt: skip
def test_what_is_not_one_run_has_no_script_and_one_sentence(changes, sentence, tmp_path):
    pytest.importorskip("exudyn")
    short = Motion(ramp_time=0.05, hold_time=0.01)
    given = {"mechanisms": "rimoldi-164", "engine": "exudyn", "motion": short, "script": tmp_path / "case.py"}
    with pytest.raises(LinkproofError, match=sentence):
        compare(**given | changes)
    assert not list(tmp_path.iterdir())
