"""The package linkproof: few names, imported when they are used, and never a stranger's module in their place."""

import ast
import os
import subprocess
import sys
from pathlib import Path

import pytest

import linkproof
from tests.linkproof import stub

ROOT = Path(__file__).parents[2]
MOST_NAMES, MOST_LINES = 20, 110


def _run(folder, *words):
    """What Python says to words in a folder, which comes before the source in its path."""
    environment = {**os.environ, "PYTHONPATH": str(ROOT)}
    environment.pop("PYTHONSAFEPATH", None)
    command = [sys.executable, *words]
    return subprocess.run(command, capture_output=True, text=True, cwd=folder, env=environment, check=False)


def test_it_has_few_names_and_each_is_there():
    assert len(linkproof.__all__) <= MOST_NAMES
    assert all(getattr(linkproof, name) is not None for name in linkproof.__all__)
    assert dir(linkproof) == sorted(linkproof.__all__)


def test_another_name_is_refused_with_those_that_there_are():
    with pytest.raises(AttributeError, match="'Mechanism': it has Comparison, Linkage"):
        _ = linkproof.Mechanism


def test_a_type_checker_sees_the_declared_options():
    assert stub.FILE.read_text(encoding="utf-8") == stub.text(), "python -m tests.linkproof.stub writes it anew"
    tree = ast.parse(stub.FILE.read_text(encoding="utf-8"))
    imported = {name.asname for node in tree.body if isinstance(node, ast.ImportFrom) for name in node.names}
    functions = {node.name for node in tree.body if isinstance(node, ast.FunctionDef)}
    assert {*linkproof.__all__} <= imported | functions | {"__version__"}


def test_its_re_exports_are_short():
    files = [ROOT / "linkproof" / name for name in ("__init__.py", "engine.py")]
    assert sum(len(file.read_text(encoding="utf-8").splitlines()) for file in files) <= MOST_LINES


def test_importing_it_imports_nothing_heavy(tmp_path):
    code = (
        "import sys, linkproof; "
        "print(*sys.modules.keys() & {'numpy', 'scipy', 'xarray', 'pydantic', 'typer', 'reports.python', 'engines'})"
    )
    assert _run(tmp_path, "-c", code).stdout == "\n"


@pytest.mark.parametrize("name", ["analytic", "engines", "comparisons", "reports"])
def test_a_strangers_package_is_named_with_the_cure(name, tmp_path):
    (tmp_path / name).mkdir()
    (tmp_path / name / "__init__.py").touch()
    told = f"expected linkproof's package '{name}' in '{ROOT}', got another one in '{tmp_path / name}'"
    for words in (("-c", "from linkproof import load"), ("-c", "import linkproof.engine"), ("-m", "linkproof", "list")):
        answer = _run(tmp_path, *words).stderr.splitlines()[-1]
        assert answer == f"ImportError: {told}: rename that one, or take its folder out of sys.path"


def test_a_strangers_module_is_named_too(tmp_path):
    (tmp_path / "engines.py").touch()
    assert f"got another one in '{tmp_path}'" in _run(tmp_path, "-c", "import linkproof; linkproof.load").stderr


def test_a_module_put_in_place_of_a_package_is_refused(tmp_path):
    code = "import sys, types; sys.modules['reports'] = types.ModuleType('reports'); from linkproof import load"
    assert "expected linkproof's package 'reports'" in _run(tmp_path, "-c", code).stderr


def test_a_folder_of_that_name_without_python_does_no_harm(tmp_path):
    (tmp_path / "reports").mkdir()
    done = _run(tmp_path, "-m", "linkproof", "--version")
    assert done.stdout == f"linkproof {linkproof.__version__}\n", done.stderr
