"""The tests of a project's linkage files: their names, their runs, and the messages of failures."""

import shlex

import pytest

from comparisons.runs.study import Study
from reports.pytest_plugin import collecting
from tests.commands import linkproof
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


def record(pytester):
    done = linkproof("compare", "--record-baseline", "--jobs", "0", cwd=pytester.path)
    assert done.returncode == 0, done.stderr


def repeated(pytester, done):
    """The outcome of the command in the message of a failed test."""
    (command,) = {line.partition("repeat it: ")[2] for line in done.outlines if "repeat it: " in line}
    name, *words = shlex.split(command)
    assert name == "linkproof"
    return linkproof(*words, "--jobs", "0", cwd=pytester.path)


def test_every_engine_setting_and_quantity_is_a_test_and_a_run_is_made_once_and_only_on_request(pytester, made):
    project(pytester, 'engines = ["direct"]', 'regimes = ["run-up", "constant-speed"]', bar=BAR, rod=BAR)
    done = run(pytester, "-v", "-k", "bar")
    passed = {line.partition(" PASSED")[0] for line in done.outlines if " PASSED" in line}
    runs = [f"linkages/bar.toml::{regime}-direct-tuned" for regime in ("run-up", "constant-speed")]
    assert passed == {f"{run}::{quantity}" for run in runs for quantity in (*QUANTITIES, *INVARIANTS)}
    assert sorted(made) == ["bar/base/constant-speed/direct/tuned", "bar/base/run-up/direct/tuned"]
    run(pytester, "linkages/rod.toml::run-up-direct-tuned::Peq").assert_outcomes(passed=1)
    assert made[2:] == ["rod/base/run-up/direct/tuned"]


def test_an_error_over_its_limit_fails_with_its_reason_and_the_command_that_repeats_it(pytester):
    project(pytester, 'engines = ["direct"]', "[[limit]]", 'quantities = ["Mkr"]', "value = 1e-30")
    done = run(pytester)
    done.assert_outcomes(passed=11, failed=1, skipped=1)
    done.stdout.fnmatch_lines(["*bar (base), run-up, direct *, tuned: Mkr", "error * of peak is over its limit 1e-30"])
    again = repeated(pytester, done)
    assert again.returncode == 1, again.stderr
    assert "Mkr" in again.stdout
    assert "Teq" not in again.stdout


def test_recorded_key_figures_and_sets_are_tests(pytester):
    project(pytester, bar=BAR, rod=HEAVIER)
    figures, sets = ("-k", "figures", "-v"), ("-k", "set-of", "-v")
    run(pytester, *figures).assert_outcomes(skipped=2, deselected=24)
    record(pytester)
    done = run(pytester, *figures)
    assert {line.split("::")[2].split()[0] for line in done.outlines if " PASSED" in line} == FIGURES
    run(pytester, *sets).assert_outcomes(passed=3)
    run(pytester, "linkproof.toml", "linkages", *sets).assert_outcomes(passed=3)
    run(pytester, "linkproof.toml::set-of-files").assert_outcomes(passed=1)

    folder = pytester.path / "linkages"
    (folder / "rod.toml").rename(folder / "arm.toml")
    (folder / "bar.toml").write_text(BAR.replace("mass = 2.0", "mass = 2.02"))
    done = run(pytester, "-k", "figures or set-of")
    done.stdout.fnmatch_lines(["linkages/rod.toml was renamed to linkages/arm.toml, its text is the same: *",
                               "*Mkr.peak was * and is *, +* %",
                               "linkages/bar.toml has changed since its baseline was recorded"])  # fmt: skip
    assert repeated(pytester, done).returncode == 1
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
    failures = done.stdout.str().partition("short test summary info")[0]  # which repeats it on a CI machine
    assert failures.count("took longer than 1e-06 s") == 12


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
