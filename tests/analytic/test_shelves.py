"""Linkages that packages announce: known by name to every command, clashes refused in a sentence."""

import json
import os
import subprocess
import sys

import pytest

from analytic import shelves
from analytic.description.loading import CATALOGUE, find, installed, load, read
from analytic.errors import LinkproofError
from tests.comparisons.faults import announce

TEXT = (CATALOGUE / "juki-mf7923d.toml").read_text(encoding="utf-8")


def _package(folder, name, *linkages):
    """A package whose import fails, with linkages in a folder of its own; announced from the same folder."""
    held = folder / name / "linkages"
    held.mkdir(parents=True)
    (folder / name / "__init__.py").write_text("raise RuntimeError('imported')\n")
    for linkage in linkages:
        (held / f"{linkage}.toml").write_text(TEXT, encoding="utf-8")
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


def test_commands_know_what_is_installed_and_what_the_project_here_names(tmp_path):
    _package(tmp_path, "mill", "ram")
    project = tmp_path / "project"
    project.mkdir()
    (project / "press.toml").write_text(TEXT, encoding="utf-8")
    (project / "linkproof.toml").write_text('linkages = ["*.toml"]\n')
    paths = os.pathsep.join([str(tmp_path), *filter(None, [os.environ.get("PYTHONPATH")])])

    def said(*words):
        command = [sys.executable, "-m", "reports.command_line.main", *words, "--json", "-"]
        done = subprocess.run(
            command, capture_output=True, text=True, cwd=project, check=True, env={**os.environ, "PYTHONPATH": paths}
        )
        return json.loads(done.stdout)

    shelf = {row["mechanism"]: row["shelf"] for row in said("list")["records"]}
    assert (shelf["ram"], shelf["press.toml"], shelf["juki-mf7923d"]) == ("installed", "project", "catalogue")
    records = said("compare", "ram", "--engine", "direct", "--quantity", "S")["records"]
    assert {(row["mechanism"], row["outcome"]) for row in records} == {("ram", "passed")}
