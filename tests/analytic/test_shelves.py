"""Linkages that packages announce: known by name to every command, clashes refused in a sentence."""

import json

import pytest

from analytic import shelves
from analytic.description.loading import CATALOGUE, find, installed, load, read
from analytic.errors import LinkproofError
from tests.commands import linkproof
from tests.comparisons.faults import announce

TEXT = (CATALOGUE / "juki-mf7923d.toml").read_text(encoding="utf-8")


def _package(folder, name, *linkages):
    """A package whose import fails, with linkages in a folder of its own; announced from the same folder."""
    inside = folder / name / "linkages"
    inside.mkdir(parents=True)
    (folder / name / "__init__.py").write_text("raise RuntimeError('imported')\n")
    for linkage in linkages:
        (inside / f"{linkage}.toml").write_text(TEXT, encoding="utf-8")
    announce(folder, name, {"own": f"{name}.linkages"}, shelves.GROUP)


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.syspath_prepend(str(tmp_path))
    shelves.announced.cache_clear()
    yield tmp_path
    shelves.announced.cache_clear()


def test_a_packages_linkages_are_known_by_name(folder):
    _package(folder, "mill", "ram", "feeder")
    assert installed() == ("feeder", "ram")
    assert find("ram") == folder / "mill" / "linkages" / "ram.toml"
    assert load("ram").text == TEXT
    assert read("ram").is_known
    assert not read(str(find("ram"))).is_known
    with pytest.raises(LinkproofError, match=r"unknown mechanism 'rem'.*did you mean 'ram'"):
        find("rem")


@pytest.mark.parametrize(
    ("packages", "sentence"),
    [
        ({"mill": ["ram"], "press": ["ram"]}, "'ram': expected one package that announces it, got mill and press; "),
        ({"mill": ["juki-mf7923d"]}, "'juki-mf7923d': expected a name of its own, got one of linkproof's from mill; "),
        ({"mill": []}, "mill: expected linkage files in the folder 'mill.linkages' that it announces"),
    ],
)
def test_a_clash_or_an_empty_folder_is_refused_in_a_sentence_and_leaves_our_own_names(folder, packages, sentence):
    for package, linkages in packages.items():
        _package(folder, package, *linkages)
    with pytest.raises(LinkproofError, match=sentence) as refused:
        installed()
    assert "\n" not in str(refused.value)
    assert find("juki-mf7923d").parent == CATALOGUE


def test_one_folder_announced_twice_is_no_clash(folder):
    _package(folder, "mill", "ram")
    announce(folder, "mill-again", {"own": "mill.linkages"}, shelves.GROUP)
    assert installed() == ("ram",)


@pytest.mark.nightly
def test_commands_know_the_linkages_of_packages_and_of_the_project(folder):
    _package(folder, "mill", "ram")
    project = folder / "project"
    project.mkdir()
    (project / "press.toml").write_text(TEXT, encoding="utf-8")
    (project / "linkproof.toml").write_text('linkages = ["*.toml"]\n')
    shelf = {row["mechanism"]: row["shelf"] for row in _records(project, "list")}
    assert (shelf["ram"], shelf["press.toml"], shelf["juki-mf7923d"]) == ("installed", "project", "catalogue")
    records = _records(project, "compare", "ram", "--engine", "direct", "--quantity", "S", "--jobs", "0")
    assert {(row["mechanism"], row["outcome"]) for row in records} == {("ram", "passed")}


def _records(project, *words):
    done = linkproof(*words, "--json", "-", cwd=project)
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)["records"]
