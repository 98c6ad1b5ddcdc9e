"""The installed wheel: a type checker reads its types, and a script of the public names runs."""

import os
import subprocess
import sys
import venv
import zipfile
from pathlib import Path

import numpy as np
import pytest

from tests.printed import is_same

ROOT = Path(__file__).parents[2]
SCRIPT = """
import numpy as np
import linkproof
from linkproof.engine import Abilities, Channel, Engine, Run, Scene, Setting, SteppedEngine


def heaviest(linkage: linkproof.Linkage) -> float:
    values = linkproof.evaluate(linkage, np.linspace(0.0, 6.0, 50), "Jeq")
    return float(values["Jeq"].max())


def channels(engine: Engine) -> list[Channel]:
    return list(engine.abilities.readouts)


class Mine:
    name = "mine"
    is_control = False
    abilities = Abilities({}, frozenset(), frozenset(), frozenset())

    def version(self) -> str | None:
        return None

    def run(self, scene: Scene, setting: Setting) -> Run:
        raise NotImplementedError


needle = linkproof.load("juki-mf7923d")
peak: float = heaviest(needle)
curves = linkproof.results(needle, speed=1200.0, clockwise=True)
force = curves["joint_force"].sel(joint="A", component="x")
try:
    comparison = linkproof.compare("juki-mf7923d", engine="direct", speed=1200)
    passed: bool = comparison.passed
    worst = max(record.error_max or 0.0 for record in comparison.records)
except linkproof.LinkproofError as error:
    print(error)
facts = linkproof.check(needle)
print(f"{peak:.3g}", force.attrs["units"], passed, worst < 1e-3, facts["structure"], channels(Mine()))
"""
WRONG = """
import linkproof

linkproof.load(3)
linkproof.results("juki-mf7923d", speed="fast")
linkproof.compare("juki-mf7923d", engines="direct")
linkproof.Mechanism
"""


@pytest.fixture(scope="module")
def python(tmp_path_factory):
    """A Python with the built wheel and, from this one, what the wheel depends on."""
    folder = tmp_path_factory.mktemp("installed")
    built = [sys.executable, "-m", "hatchling", "build", "-t", "wheel", "-d", str(folder)]
    subprocess.run(built, cwd=ROOT, check=True, capture_output=True)
    venv.create(folder / "venv", symlinks=os.name != "nt")
    place = next((folder / "venv").rglob("site-packages"))
    with zipfile.ZipFile(next(folder.glob("*.whl"))) as wheel:
        wheel.extractall(place)
    (place / "dependencies.pth").write_text(str(Path(np.__file__).parents[1]))
    return next((folder / "venv").glob("*/python"))


def _run(folder, *command):
    environment = {name: value for name, value in os.environ.items() if name not in ("PYTHONPATH", "MYPYPATH")}
    return subprocess.run(command, capture_output=True, text=True, cwd=folder, env=environment, check=False)


@pytest.mark.nightly
def test_a_users_script_is_clean_under_strict_types_and_runs(python, tmp_path):
    for name, text in (("script", SCRIPT), ("wrong", WRONG)):
        (tmp_path / f"{name}.py").write_text(text)
    mypy = (sys.executable, "-m", "mypy", "--strict", "--config-file=", "--cache-dir=.mypy_cache")
    output = _run(tmp_path, *mypy, f"--python-executable={python}", "script.py", "wrong.py").stdout
    errors = [line.partition(": error:")[0] for line in output.splitlines() if ": error:" in line]
    assert errors == [f"wrong.py:{line}" for line in (4, 5, 6, 7)], output
    done = _run(tmp_path, str(python), "script.py")
    assert is_same(done.stdout, "9.13e-05 N True True I (crank) -> coupler + needle_bar (RRP) []\n"), done.stderr


@pytest.mark.nightly
def test_every_package_of_the_wheel_says_that_it_is_typed(python):
    place = next(python.parents[1].rglob("site-packages"))
    packages = [path.parent for path in place.glob("*/__init__.py")]
    assert len(packages) == 5
    assert all((package / "py.typed").is_file() for package in packages)
