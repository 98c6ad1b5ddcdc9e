"""The package linkproof: its names and never a stranger's module in their place; one version in all files around it."""

import os
import re
import runpy
import subprocess
import sys
import tomllib
from pathlib import Path

import jinja2
import pytest
import yaml

import linkproof
from engines import contract, scene

ROOT = Path(__file__).parents[2]


def test_each_of_its_names_can_be_imported():
    assert all(getattr(linkproof, name) is not None for name in linkproof.__all__)
    assert dir(linkproof) == sorted(linkproof.__all__)
    with pytest.raises(AttributeError, match="'Mechanism': it has Bounds, Comparison, Linkage"):
        _ = linkproof.Mechanism


def test_the_contract_for_plug_ins_has_every_class_of_which_an_adapter_is_made():
    assert all(hasattr(linkproof.engine, name) for name in linkproof.engine.__all__)
    assert sorted(linkproof.engine.__all__) == linkproof.engine.__all__
    made = {
        name
        for module in (contract, scene)
        for name, value in vars(module).items()
        if isinstance(value, type) and value.__module__ == module.__name__
    }
    shared = {"GuidedJoint", "TwoPoints"}  # what slider and slot, or pin and spring, have in common
    assert made - set(linkproof.engine.__all__) <= shared


STARTING = """
import sys
HEAVY = {"numpy", "scipy", "pydantic", "xarray", "matplotlib", "rich", "analytic.kinematics", "engines.registry"}

def loaded(*more):
    print(*sorted({*HEAVY, *more} & {*sys.modules}))

import linkproof
loaded("click", "reports")
sys.argv = ["linkproof", "--help"]
from reports.command_line.main import main
try:
    main()
except SystemExit:
    loaded()
linkproof.results
print("matplotlib" in sys.modules)
"""


def test_each_entrance_imports_nothing_heavy_before_it_is_used(tmp_path):
    environment = {**os.environ, "PYTHONPATH": str(ROOT)}
    command = [sys.executable, "-c", STARTING]
    done = subprocess.run(command, capture_output=True, text=True, cwd=tmp_path, env=environment, check=True)
    package, *help_text, command_line, results = done.stdout.splitlines()
    assert "  compare" in "\n".join(help_text)
    assert (package, command_line, results) == ("", "", "False")


@pytest.fixture
def stranger(tmp_path, monkeypatch):
    """Make a folder the place from which one of linkproof's packages would be imported; returns its path."""

    def install(name, file="__init__.py"):
        path = tmp_path / name / file
        path.parent.mkdir(exist_ok=True)
        path.touch()
        monkeypatch.delitem(sys.modules, name)
        monkeypatch.syspath_prepend(tmp_path)
        return path.parent

    return install


def refused(name, place):
    words = f"expected linkproof's package '{name}' in '{ROOT}', got another one in '{place}': "
    return re.escape(f"{words}rename that one, or take its folder out of sys.path")


@pytest.mark.parametrize("name", ["analytic", "engines", "comparisons", "reports"])
def test_a_strangers_package_is_named_with_the_cure_by_every_entrance(name, stranger):
    sentence = refused(name, stranger(name))
    with pytest.raises(ImportError, match=sentence):
        _ = linkproof.load
    for entrance in ("engine.py", "__main__.py"):
        with pytest.raises(ImportError, match=sentence):
            runpy.run_path(str(ROOT / "linkproof" / entrance), run_name="__main__")


PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]


def read(path):
    return yaml.safe_load((ROOT / path).read_text(encoding="utf-8"))


def test_the_citation_has_the_version_of_the_package():
    assert read("CITATION.cff")["version"] == PROJECT["version"]


def test_workflows_and_templates_can_be_read():
    for path in (ROOT / ".github").rglob("*.yml"):
        parts = read(path)
        assert {"jobs"} <= parts.keys() or {"name", "description", "body"} <= parts.keys(), path


def test_the_recipe_lists_every_dependency():
    text = (ROOT / "conda" / "meta.yaml").read_text(encoding="utf-8")

    def load_file_data(name, *, from_recipe_dir):  # as conda-build does
        place = ROOT / "conda" if from_recipe_dir else Path()
        return tomllib.loads((place / name).read_text(encoding="utf-8"))

    rendered = jinja2.Template(text).render(PYTHON="python", load_file_data=load_file_data)
    recipe = yaml.safe_load(rendered)
    assert recipe["package"] == {"name": "linkproof", "version": PROJECT["version"]}
    needed = [each.partition(" ")[0].replace("matplotlib-base", "matplotlib") for each in recipe["requirements"]["run"]]
    assert needed == ["python", *(each.partition(">")[0] for each in PROJECT["dependencies"])]
