"""Before a release: sdist and wheel, each installed in a new environment, with README's commands and a type checker.

``python -m tests.linkproof.release FOLDER`` builds both into the folder; ``make release-check`` calls it.
"""

from __future__ import annotations

import os
import shlex
import shutil
import subprocess
import sys
import tempfile
import tomllib
import venv
from pathlib import Path

from tests.docs.test_snippets import FILE, MEASURING, SETTING_UP, agrees, blocks, commands

ROOT = Path(__file__).parents[2]
PLACEHOLDER = "example.org"  # of the owner's addresses, which stand in pyproject.toml alone
README = ROOT / "README.md"
EXTRAS = "exudyn"  # what README's commands need
CHECKER = "mypy"
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
curves = linkproof.results(needle, linkproof.Motion(speed=-1200.0)).dataset
force = curves["joint_force"].sel(joint="A", component="x")
try:
    comparison = linkproof.compare("juki-mf7923d", linkproof.Motion(speed=1200), engine="direct")
    passed: bool = comparison.ok
    worst = max(record.error_max or 0.0 for record in comparison.records)
except linkproof.LinkproofError as error:
    print(error)
facts = linkproof.check(needle).to_dict()
print(f"{peak:.3g}", force.attrs["units"], passed, worst < 1e-3, facts["structure"], channels(Mine()))
"""
# Each call is wrong by its types.
WRONG = """
import linkproof

linkproof.load(3)
linkproof.results("juki-mf7923d", linkproof.Motion(speed="fast")).dataset
linkproof.sweep("juki-mf7923d", quantities="Mkr.peak")
linkproof.compare("juki-mf7923d", engines="direct")
linkproof.Mechanism
"""
WRONG_LINES = (4, 5, 6, 7, 8)


def checked(package: Path) -> list[str]:
    """What fails of a package: of its installation, of README's commands, of a typed script."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        programs = folder / "venv" / ("Scripts" if os.name == "nt" else "bin")
        venv.create(folder / "venv", with_pip=True)

        def run(*words: str) -> subprocess.CompletedProcess[str]:
            outside = {name: value for name, value in os.environ.items() if name not in ("PYTHONPATH", "VIRTUAL_ENV")}
            return subprocess.run(
                [str(programs / words[0]), *words[1:]], cwd=folder, env=outside, text=True, check=False,
                stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
            )  # fmt: skip

        done = run("python", "-m", "pip", "install", "--quiet", f"{package}[{EXTRAS}]", CHECKER)
        if done.returncode:
            return [f"pip install {package.name}: {done.stdout}"]
        text = README.read_text(encoding="utf-8")
        for file, content in FILE.findall(text):
            (folder / file).write_text(content, encoding="utf-8")
        for file, content in (("script.py", SCRIPT), ("wrong.py", WRONG)):
            (folder / file).write_text(content, encoding="utf-8")
        faults = [
            _differences(command, shown, run(*shlex.split(command)))
            for kind, block in blocks(README) if kind == "console"
            for command, shown in commands(block)
            if not SETTING_UP & set(command.split())
        ]  # fmt: skip
        for words in (("linkproof", "engines", "--try"), ("mypy", "--strict", "script.py"), ("python", "script.py")):
            faults.append(_differences(shlex.join(words), "", run(*words)))
        output = run("mypy", "--strict", "wrong.py").stdout
        lines = tuple(int(line.split(":")[1]) for line in output.splitlines() if ": error:" in line)
        faults.append("" if lines == WRONG_LINES else f"mypy of wrong calls: {output}")
        return [each for each in faults if each]


def _differences(command: str, shown: str, done: subprocess.CompletedProcess[str]) -> str:
    measured = command.split()[1] in MEASURING
    is_right = not done.returncode and (not shown or agrees(done.stdout, shown, measured))
    return "" if is_right else f"{command}: exit code {done.returncode}, printed\n{done.stdout}"


def main() -> int:
    """Build and check both; returns 1 where anything fails, or an address of the owner's is a placeholder."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    unset = [name for name, address in project["urls"].items() if PLACEHOLDER in address]
    if unset:
        print(f"pyproject.toml, [project.urls]: {', '.join(unset)} is a placeholder; give the owner's address")
    folder = Path(sys.argv[1]).resolve()
    shutil.rmtree(folder, ignore_errors=True)
    subprocess.run([sys.executable, "-m", "hatchling", "build", "-d", str(folder)], cwd=ROOT, check=True)
    failures = {package.name: checked(package) for package in sorted(folder.iterdir())}
    for name, faults in failures.items():
        print(f"{name}: {'passed' if not faults else 'failed'}", *faults, sep="\n")
    return 1 if unset or any(failures.values()) else 0


if __name__ == "__main__":
    sys.exit(main())
