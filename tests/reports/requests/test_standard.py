"""A project's values replace options that are not given; a baseline is recorded into a file that a user names."""

import shutil
from pathlib import Path

import pytest

from analytic.description.loading import read
from analytic.errors import LinkproofError, UnknownNameError
from reports.requests.campaign import files, request
from reports.requests.campaign_options import BenchOptions, CompareOptions, RunLimits, StandardOptions, StressOptions
from reports.requests.options import command_line
from reports.requests.standard import baseline_file, complete_request, complete_study

PROJECT = """
linkages = ["*/*.toml"]
engines = ["direct"]
settings = ["best"]
regimes = ["coast", "run-up"]
time_limit = 30
memory_limit = 2
"""
COAST = "\n[regimes.coast]\nstart_angle = 0\nstart_speed = 10\nduration = 0.5\n"


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """A project of two linkages of one name, the first of which can be released."""
    text = read("juki-mf7923d").text
    for name, more in (("a", COAST), ("b", "")):
        (tmp_path / name).mkdir()
        (tmp_path / name / "press.toml").write_text(text + more, encoding="utf-8")
    (tmp_path / "linkproof.toml").write_text(PROJECT)
    monkeypatch.chdir(tmp_path)
    return tmp_path


def _in_project(choice=None, limits=None):
    return complete_request(choice or CompareOptions(), limits or RunLimits(), StandardOptions())


def test_without_words_a_project_says_everything(folder):
    choice, limits, project, *_ = _in_project()
    assert choice.mechanisms == ("a/press.toml", "b/press.toml")
    assert (choice.engine, choice.setting, choice.regime) == (("direct",), ("best",), ("coast", "run-up"))
    assert (limits.time_limit, limits.memory_limit) == (30.0, 2.0)
    assert baseline_file(StandardOptions(), project) == folder / "linkproof-baseline.json"
    assert "linkproof compare a/press.toml b/press.toml --regime coast" in command_line("compare", choice)


def test_words_go_before_the_project(folder):
    given = CompareOptions(
        mechanisms=("b/press.toml",), engine=("exudyn",), setting=("tuned",), regime=("run-up-cubic",)
    )
    mine = StandardOptions(baseline=Path("mine.json"))
    choice, limits, project, _, known = complete_request(given, RunLimits(time_limit=5.0), mine)
    assert (choice, known) == (given, ())
    assert (limits.time_limit, limits.memory_limit) == (5.0, 2.0)
    assert baseline_file(mine, project) == Path("mine.json")


def test_a_swing_or_no_worker_processes_leave_out_what_would_contradict_them(folder):
    swing = CompareOptions(from_angle=10.0, to_angle=40.0)
    assert _in_project(swing)[0].regime == ()
    none = RunLimits(jobs=0)
    assert _in_project(limits=none)[1] == none


def test_the_project_is_that_of_the_first_file(folder, monkeypatch):
    monkeypatch.chdir("/")
    shipped, own = "juki-mf7923d", str(folder / "b" / "press.toml")
    assert _in_project(CompareOptions(mechanisms=(shipped,)))[2] is None
    assert _in_project(CompareOptions(mechanisms=(shipped, own)))[2].folder == folder
    assert _in_project()[0] == CompareOptions()


def test_a_linkage_without_a_regime_of_the_project_is_not_run_in_it(folder):
    choice, *_, known = _in_project(CompareOptions(mechanisms=("b/press.toml",)))
    assert [motion.regime for motion in request(choice, known).motions] == ["run-up"]
    (folder / "linkproof.toml").write_text(PROJECT.replace("coast", "cost"))
    choice, *_, known = _in_project(CompareOptions(mechanisms=("b/press.toml",)))
    with pytest.raises(UnknownNameError, match="unknown regime 'cost': did you mean 'coast'"):
        request(choice, known)


def test_a_variant_takes_those_of_the_project_that_have_it(folder):
    text = (folder / "b" / "press.toml").read_text(encoding="utf-8")
    (folder / "b" / "press.toml").write_text(text + "\n[variants.light.links.needle_bar]\nmass = 0.01\n", "utf-8")
    assert _in_project(CompareOptions(variant="light"))[0].mechanisms == ("b/press.toml",)


def test_files_of_one_name_have_as_many_folders_before_it_as_tell_them_apart(folder):
    for name in ("a", "b"):
        shutil.copytree(folder / name, folder / name / "parts")
    paths = ("a/press.toml", "a/parts/press.toml", "b/parts/press.toml")
    assert [file.name for file in files(CompareOptions(mechanisms=paths))] == [
        "a-press",
        "a-parts-press",
        "b-parts-press",
    ]


def test_recording_needs_a_file_of_the_users_own(folder, tmp_path):
    with pytest.raises(LinkproofError, match=r"--record-baseline: .* --baseline, or put a linkproof.toml"):
        baseline_file(StandardOptions(record_baseline=True), None)
    assert baseline_file(StandardOptions(record_baseline=True), _in_project()[2])
    for place, words in (
        (tmp_path, "cannot write"),
        (tmp_path / "lib" / "site-packages" / "base.json", r"your own, got .*base\.json' among installed packages"),
    ):
        with pytest.raises(LinkproofError, match=words):
            baseline_file(StandardOptions(baseline=place, record_baseline=True), None)


def test_the_words_ask_for_the_same_standard(tmp_path):
    mine = StandardOptions(limits=Path("my limits.toml"), baseline=Path("b.json"), allow_new=True, allow_missing=True)
    words = "linkproof compare --limits 'my limits.toml' --baseline b.json --allow-new --allow-missing"
    assert command_line("compare", CompareOptions(), mine) == words


def test_an_unknown_engine_of_a_project_is_named_with_its_file(folder):
    (folder / "linkproof.toml").write_text(PROJECT.replace('"direct"', '"adams"'))
    with pytest.raises(UnknownNameError, match=r"unknown engine of .*linkproof\.toml 'adams'"):
        _in_project()
    assert _in_project(CompareOptions(engine=("direct",)))[0].engine == ("direct",)


def test_bench_has_the_linkages_and_engines_of_the_project_and_stress_its_engines(folder):
    assert complete_study(BenchOptions(quick=True)) == BenchOptions(
        mechanisms=("a/press.toml", "b/press.toml"), engine=("direct",), quick=True
    )
    given = BenchOptions(mechanisms=("b/press.toml",), engine=("exudyn",))
    assert complete_study(given) == given
    assert complete_study(StressOptions(words=("mass",))) == StressOptions(words=("mass",), engine=("direct",))
