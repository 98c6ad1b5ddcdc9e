"""What keeps N linkages and M engines from becoming N × M."""

import ast
import subprocess
import sys
import tomllib
from graphlib import TopologicalSorter

import grimp
import pytest

from analytic.description.loading import known_names
from engines.contract import Engine
from engines.registry import engine, own_names
from tests.sources import PACKAGES, ROOT, SOURCES, docstrings, nodes


def _strings(every):
    """All string constants among nodes."""
    return {node.value for node in every if isinstance(node, ast.Constant) and isinstance(node.value, str)}


def test_no_code_names_a_mechanism():
    mechanisms = {*known_names()}
    assert not [path for path in SOURCES if (_strings(nodes()[path]) - {*docstrings(path)}) & mechanisms]


def _compared(path):
    """All string constants that a file compares something with."""
    comparisons = (node for node in nodes()[path] if isinstance(node, ast.Compare))
    return _strings(part for node in comparisons for part in ast.walk(node))


def test_no_code_outside_an_adapter_compares_with_an_engines_name():
    outside = [p for p in SOURCES if not p.parent.name.endswith("_adapter") and p.name != "environment.py"]
    assert len(outside) > 100
    assert not [path for path in outside if _compared(path) & set(own_names())]


def test_no_files_import_each_other_in_a_circle():
    """Imports within functions and those for types alone count as well; a CycleError names the circle."""
    graph = grimp.build_graph(*PACKAGES)
    imports = {module: graph.find_modules_directly_imported_by(module) for module in graph.modules}
    assert {*TopologicalSorter(imports).static_order()} == graph.modules


@pytest.mark.parametrize("name", own_names())
def test_every_announced_engine_keeps_the_contract(name):
    adapter: Engine = engine(name)
    assert adapter.name == name
    assert adapter.version() is None or isinstance(adapter.version(), str)


def test_finding_adapters_and_their_methods_imports_no_engine():
    script = (
        f"import sys; from engines.registry import engine; [engine(name) for name in {own_names()!r}]; "
        "engine('exudyn').methods(None); print([module for module in ('exudyn', 'pymunk') if module in sys.modules])"
    )
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True, cwd=ROOT)
    assert done.stdout.strip() == "[]"


SEEN = {
    "engines": {"description", "numerics", "files", "errors", "catalogue"},
    "reports.document": {"description", "files", "errors", "catalogue"},
}


@pytest.mark.parametrize("room", SEEN)
def test_engines_and_pages_are_kept_from_every_room_of_the_closed_form(room):
    contracts = tomllib.loads((ROOT / "pyproject.toml").read_text())["tool"]["importlinter"]["contracts"]
    (forbidden,) = (
        one["forbidden_modules"] for one in contracts if one["type"] == "forbidden" and room in one["source_modules"]
    )
    files = (path.relative_to(ROOT) for path in SOURCES)
    rooms = {path.parts[1].removesuffix(".py") for path in files if path.parts[0] == "analytic"} - {"__init__"}
    analytic = {name for name in forbidden if name.startswith("analytic.")}
    assert analytic == {f"analytic.{name}" for name in rooms - SEEN[room]}
