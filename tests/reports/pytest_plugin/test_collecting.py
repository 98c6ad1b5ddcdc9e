"""What is collected of a project's linkage files, what passes and what fails with which words, in one run an engine."""

import shlex

import pytest

from comparisons.runs.study import Study
from reports.pytest_plugin import collecting
from tests.commands import process
from tests.reports.pytest_plugin.projects import BAR, INVARIANTS, PLUGIN, QUANTITIES, ROOT, project, run

pytest_plugins = ["pytester"]
assert collecting  # imported once, for all runs of pytest in this process
HEAVIER = BAR.replace("mass = 2.0", "mass = 2.02")
FIGURES = {"Mkr.peak", "Mkr.rms", "Peq.peak", "joint_force:O.peak", "Jeq.mean"}


@pytest.fixture
def made(monkeypatch):
    """The keys of the runs that are made."""
    keys, in_order = [], Study.in_order
    monkeypatch.setattr(Study, "in_order", lambda self, tasks, bounds: keys.extend(task.key for task in tasks)
                        or in_order(self, tasks, bounds))  # fmt: skip
    return keys


def repeated(pytester, done):
    """What comes of the command that a failed test names."""
    (command,) = {line.partition("repeat it: ")[2] for line in done.outlines if "repeat it: " in line}
    name, *words = shlex.split(command)
    assert name == "linkproof"
    return process(*words, "--jobs", "0", cwd=pytester.path)


def test_every_engine_setting_and_quantity_is_a_test_and_a_run_is_made_once(pytester, made):
    project(pytester, 'engines = ["direct"]', 'regimes = ["run-up", "constant-speed"]', bar=BAR, rod=BAR)
    done = run(pytester, "-v")
    told = {line.partition(" PASSED")[0] for line in done.outlines if " PASSED" in line}
    runs = [f"linkages/{name}.toml::{regime}-direct-tuned"
            for name in ("bar", "rod") for regime in ("run-up", "constant-speed")]  # fmt: skip
    assert told == {f"{run}::{quantity}" for run in runs for quantity in (*QUANTITIES, *INVARIANTS)}
    assert sorted(made) == sorted(f"{name}/base/{regime}/direct/tuned"
                                  for name in ("bar", "rod") for regime in ("run-up", "constant-speed"))  # fmt: skip


def test_what_is_not_asked_for_is_not_run(pytester, made):
    project(pytester, bar=BAR, rod=BAR)
    run(pytester, "-k", "bar and Mkr").assert_outcomes(passed=1, deselected=25)
    assert made == ["bar/base/run-up/direct/tuned"]
    run(pytester, "linkages/rod.toml::run-up-direct-tuned::Peq").assert_outcomes(passed=1)
    assert made[1:] == ["rod/base/run-up/direct/tuned"]


def test_an_error_over_its_limit_fails_with_its_reason_and_the_command_that_repeats_it(pytester):
    project(pytester, 'engines = ["direct"]', "[[limit]]", 'quantities = ["Mkr"]', "value = 1e-30")
    done = run(pytester)
    done.assert_outcomes(passed=11, failed=1, skipped=1)
    done.stdout.fnmatch_lines(["*bar (base), run-up, direct *, tuned: Mkr", "error * of peak is over its limit 1e-30"])
    again = repeated(pytester, done)
    assert again.returncode == 1, again.stderr
    assert "Mkr" in again.stdout
    assert "Teq" not in again.stdout


def test_a_mass_changed_by_a_percent_fails_by_its_key_figures(pytester):
    project(pytester)
    run(pytester, "-k", "figures").assert_outcomes(skipped=1, deselected=12)
    recording = process("compare", "--record-baseline", "--jobs", "0", cwd=pytester.path)
    assert recording.returncode == 0, recording.stderr
    done = run(pytester, "-v", "-k", "figures")
    assert {line.split("::")[2].split()[0] for line in done.outlines if " PASSED" in line} == FIGURES
    (pytester.path / "linkages" / "bar.toml").write_text(HEAVIER)
    done = run(pytester)
    failed = {line.split("::")[2].split()[0] for line in done.outlines if line.startswith("FAILED")}
    assert failed == FIGURES
    done.stdout.fnmatch_lines(["*Mkr.peak was * and is *, +* %",
                               "linkages/bar.toml has changed since its baseline was recorded"])  # fmt: skip
    assert repeated(pytester, done).returncode == 1


def test_the_set_of_files_is_one_test_and_motions_are_one_of_every_file(pytester):
    project(pytester, bar=BAR, rod=HEAVIER)
    assert process("compare", "--record-baseline", "--jobs", "0", cwd=pytester.path).returncode == 0
    sets = ("-k", "set-of", "-v")
    run(pytester, *sets).assert_outcomes(passed=3)
    run(pytester, "linkproof.toml", "linkages", *sets).assert_outcomes(passed=3)
    run(pytester, "linkproof.toml::set-of-files").assert_outcomes(passed=1)
    folder = pytester.path / "linkages"
    (folder / "rod.toml").rename(folder / "arm.toml")
    (folder / "bar.toml").write_text(BAR.replace("gravity = [0, -9.81]", ""))
    done = run(pytester, *sets)
    done.assert_outcomes(passed=1, failed=2)
    done.stdout.fnmatch_lines(["linkages/rod.toml was renamed to linkages/arm.toml, its text is the same: *",
                               "linkages/bar.toml (base), run-up: *gravity off is not in the baseline: *"])  # fmt: skip
    with (pytester.path / "linkproof.toml").open("a") as file:
        file.write("\nallow_new = true\nallow_missing = true\n")
    run(pytester, *sets).assert_outcomes(passed=3)


def test_a_naive_failure_decides_only_where_nothing_else_is_run(pytester):
    limit = ("[[limit]]", 'quantities = ["Mkr"]', 'settings = ["naive"]', "value = 1e-30")
    project(pytester, 'engines = ["direct"]', 'settings = ["naive", "tuned"]', *limit)
    run(pytester, "-k", "Mkr and not figures").assert_outcomes(passed=1, xfailed=1, deselected=23)
    text = (pytester.path / "linkproof.toml").read_text()
    (pytester.path / "linkproof.toml").write_text(text.replace('"naive", "tuned"', '"naive"', 1))
    run(pytester, "-k", "Mkr").assert_outcomes(failed=1, deselected=12)


def test_a_run_that_is_lost_fails_in_every_quantity_and_invariant(pytester):
    project(pytester, 'engines = ["direct"]', "time_limit = 1e-6")
    done = run(pytester, "-k", "not figures")
    done.assert_outcomes(failed=12, deselected=1)
    failures = done.stdout.str().partition("short test summary info")[0]  # which tells it again on a CI machine
    assert failures.count("took longer than 1e-06 s") == 12


@pytest.mark.parametrize(("line", "words"), [('engines = ["dirct"]', "did you mean"), ('regimes = ["run"]', "regime")])
def test_what_does_not_exist_is_an_error_in_one_sentence(pytester, line, words):
    project(pytester, line)
    done = run(pytester)
    assert done.ret == pytest.ExitCode.INTERRUPTED
    assert words in done.stdout.str()
    assert "Traceback" not in done.stdout.str()


def test_a_linkage_without_the_regimes_of_its_project_has_no_tests(pytester):
    project(pytester, 'engines = ["direct"]', 'regimes = ["own"]')
    assert run(pytester).ret == pytest.ExitCode.NO_TESTS_COLLECTED


@pytest.mark.nightly
@pytest.mark.parametrize("dist", ["load", "loadscope"])
def test_tests_are_the_same_on_several_workers(pytester, dist, monkeypatch):
    monkeypatch.setenv("PYTHONPATH", str(ROOT))
    project(pytester, 'engines = ["direct"]', 'regimes = ["run-up", "constant-speed"]', bar=BAR, rod=BAR)
    done = pytester.runpytest_subprocess("-p", PLUGIN, "-n", "2", "--dist", dist)
    done.assert_outcomes(passed=48, skipped=4)
