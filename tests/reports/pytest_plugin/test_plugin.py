"""Where the plug-in is active; its markers, its skipped tests, and a project that cannot be read."""

from importlib.metadata import entry_points

import pytest

from comparisons.campaign import project as project_file
from engines import registry
from engines.pymunk_adapter.adapter import PymunkEngine
from reports.pytest_plugin import ENGINES, FILE, collecting
from tests.reports.pytest_plugin.projects import BAR, project, run

pytest_plugins = ["pytester"]
assert collecting  # imported once, for all runs of pytest in this process


def test_the_names_it_repeats_are_the_projects():
    assert (FILE, ENGINES) == (project_file.FILE, registry.GROUP)


def test_nothing_is_collected_without_a_project(pytester):
    (pytester.path / "bar.toml").write_text(BAR)
    assert run(pytester).ret == pytest.ExitCode.NO_TESTS_COLLECTED
    assert run(pytester, "bar.toml").ret == pytest.ExitCode.USAGE_ERROR


def test_a_file_that_is_named_is_tested_without_a_project(pytester):
    (pytester.path / "bar.toml").write_text(BAR)
    (pytester.path / "other.toml").write_text(BAR)
    done = run(pytester, "--linkproof", "bar.toml", "-k", "direct", "-v")
    done.stdout.fnmatch_lines(["bar.toml::run-up-direct-tuned::Mkr PASSED*"])
    done.stdout.no_fnmatch_line("*other.toml*")
    assert run(pytester, "--linkproof").ret == pytest.ExitCode.NO_TESTS_COLLECTED


def test_other_files_of_a_project_are_no_tests(pytester):
    project(pytester)
    (pytester.path / "settings.toml").write_text("[tool]")
    done = run(pytester, "--collect-only", "-q")
    assert {line.partition("::")[0] for line in done.outlines if "::" in line} == {"linkages/bar.toml"}


@pytest.mark.parametrize(
    ("line", "words"),
    [
        ("engines = 3", "*linkproof.toml:2: *"),
        ("engines = [", "*linkproof.toml:2: *"),
        ('engines = ["dirct"]', "*did you mean*"),
    ],
)
def test_a_project_that_cannot_be_read_is_an_error_in_one_sentence(pytester, line, words):
    project(pytester, line)
    done = run(pytester)
    assert done.ret == pytest.ExitCode.INTERRUPTED
    done.stdout.fnmatch_lines([words])
    done.stdout.no_fnmatch_line("*Traceback*")
    done.stdout.no_fnmatch_line("*INTERNALERROR*")


def test_markers_choose_engines_and_are_known(pytester):
    project(pytester, 'engines = ["direct", "pymunk"]')
    collected = {}
    for words in ("direct", "pymunk", "linkproof", "not linkproof"):
        done = run(pytester, "--strict-markers", "--collect-only", "-q", "-m", words)
        collected[words] = [line for line in done.outlines if "::" in line]
    figures = [line for line in collected["linkproof"] if "key-figures" in line]
    assert collected["linkproof"] == [*collected["direct"], *collected["pymunk"], *figures]
    assert len(collected["direct"]) == len(collected["pymunk"]) == 12
    assert all("-direct-" in line for line in collected["direct"])
    assert collected["not linkproof"] == []
    listed = run(pytester, "--markers").stdout.str()
    assert all(f"@pytest.mark.{name}:" in listed for name in ("linkproof", *entry_points(group=ENGINES).names))


def test_an_engine_that_is_not_installed_is_skipped_and_named(pytester, monkeypatch):
    project(pytester, 'engines = ["pymunk"]')
    monkeypatch.setattr(PymunkEngine, "why_unavailable", lambda _: "engine 'pymunk' is not installed: install it")
    done = run(pytester)
    assert done.ret == pytest.ExitCode.OK
    done.assert_outcomes(skipped=13)
    done.stdout.fnmatch_lines(["12 of: engine 'pymunk' is not installed: install it"])
    output = run(pytester, "-rs").stdout.str()
    assert output.count("is not installed") == 1
    assert "SKIPPED [12] linkages/bar.toml" in output
