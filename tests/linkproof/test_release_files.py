"""What public software has beside its code: one version everywhere, workflows and templates that can be read."""

import tomllib
from pathlib import Path

import jinja2
import yaml

ROOT = Path(__file__).parents[2]
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


def test_every_package_says_that_it_is_typed():
    packages = [path.parent for path in ROOT.glob("*/__init__.py")]
    assert len(packages) == 5
    assert all((package / "py.typed").is_file() for package in packages)
