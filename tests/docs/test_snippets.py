"""Every command and Python snippet of the documentation does what its page shows."""

import contextlib
import io
import json
import os
import re
import shlex
import subprocess
import sys
from contextlib import redirect_stdout
from io import StringIO
from pathlib import Path

import matplotlib as mpl
import pytest

from tests import printed
from tests.commands import linkproof
from tests.docs.given import lay_out

ROOT = Path(__file__).parents[2]
PAGES = [ROOT / "README.md", ROOT / "CONTRIBUTING.md", *sorted((ROOT / "docs").glob("*.md"))]
BLOCK = re.compile(r"^```(console|python)\n(.*?)^```$", re.MULTILINE | re.DOTALL)
FILE = re.compile(r"^```toml (\S+)\n(.*?)^```$", re.MULTILINE | re.DOTALL)
PRINTS = re.compile(r"^ *print\(.*\)  # (.*)$", re.MULTILINE)
OWN_TEST = "finds.md"  # its blocks run below
# Commands that set up a machine; docs/your-first-engine.md has a test of its own, which installs its blocks first.
SETTING_UP = {"git", "python3", "pip", "make", "barwork"}
# Their figures are errors and times of engines, which differ from machine to machine.
MEASURING = {"compare", "bench", "stress"}
LONG = {"bench", "stress"}
SLOW = "designs.md"  # it searches and compiles, as do the tests of its commands
# Each page as it is, and in a short form.
PAGES_RUN = [
    pytest.param(page, whole, marks=pytest.mark.nightly if whole or page.name == SLOW else ())
    for whole in (False, True)
    for page in PAGES
    if page.name != OWN_TEST
]


def blocks(page):
    """Kind and text of every block that can be run, in order."""
    return BLOCK.findall(page.read_text(encoding="utf-8"))


def commands(text):
    """Every command of a console block, and the lines shown below it."""
    for part in re.split(r"^\$ ", text, flags=re.MULTILINE)[1:]:
        command, _, shown = part.partition("\n")
        yield command.partition("  #")[0].strip(), shown


def words(command):
    """The words of a command, and the command of ``linkproof`` among them."""
    found = command.split()
    return found, found[1] if found[0] == "linkproof" else found[0]


def quick(command):
    """A command of many engines, mechanisms or seconds of motion, with one or a few of them."""
    found, name = words(command)
    if name == "compare":
        command = command.replace(" slotted-takeup", " brief.toml").replace(" --engine pymunk --engine simbody", "")
    is_cell = "/" in command  # of a stability map, which names its engine
    if (name in LONG and not is_cell) or (
        name == "compare" and not {"--engine", "short.toml", "rocker.toml"} & set(found)
    ):
        command += " --engine direct"
        return command.replace("compare --", "compare juki-mf7923d --").replace("speed start jump", "start")
    return command


def agrees(output, shown, measured):
    """Whether the lines shown are the output, or some of its lines in order where a line of dots is among them."""
    output, shown = (text.rstrip().splitlines() for text in (output, shown))
    is_alike = (lambda line, other: printed.words(line) == printed.words(other)) if measured else printed.is_same
    if "..." not in shown:
        return len(output) == len(shown) and all(map(is_alike, output, shown))
    rest = iter(output)
    return all(any(is_alike(other, line) for other in rest) for line in shown if line != "...")


@pytest.fixture(scope="module")
def shell(tmp_path_factory):
    """Run a line of a shell that knows ``linkproof``, in a folder; a command and nothing else in this process."""
    programs = tmp_path_factory.mktemp("programs")
    for name, module in (("linkproof", " -m reports.command_line.main"), ("python", "")):
        (programs / name).write_text(f'#!/bin/sh\nexec "{sys.executable}"{module} "$@"\n')
        (programs / name).chmod(0o755)
    env = {**os.environ, "PATH": f"{programs}{os.pathsep}{os.environ['PATH']}", "PYTHONPATH": str(ROOT)}

    def run(command, folder):
        if command.startswith("linkproof ") and not {*"|;>&"} & {*command}:
            return linkproof(*shlex.split(command)[1:], cwd=folder, stderr=subprocess.STDOUT)
        return subprocess.run(["bash", "-o", "pipefail", "-c", command], stdout=subprocess.PIPE,
                              stderr=subprocess.STDOUT, text=True, cwd=folder, env=env, check=False)  # fmt: skip

    return run


@pytest.mark.parametrize(("page", "is_whole"), PAGES_RUN, ids=lambda one: getattr(one, "stem", None))
def test_a_page_shows_what_its_commands_print(page, is_whole, shell, tmp_path):
    lay_out(tmp_path)
    for name, text in FILE.findall(page.read_text(encoding="utf-8")):
        (tmp_path / name).write_text(text, encoding="utf-8")
    known = {}
    for kind, text in blocks(page):
        if kind == "python":
            with contextlib.redirect_stdout(io.StringIO()) as stream:
                exec(compile(text, str(page), "exec"), known)
            assert agrees(stream.getvalue(), "\n".join(PRINTS.findall(text)), measured=False)
            continue
        for command, shown in commands(text):
            if SETTING_UP & set(command.split()):
                continue
            is_long = words(command)[1] in LONG or "--jobs" in command  # with the engines that happen to be installed
            done = shell(command if is_whole and not is_long else quick(command), tmp_path)
            expected = {2} if shown.startswith("linkproof: ") else {0, 1}
            assert done.returncode in expected, f"{command}\n{done.stdout}"
            if shown and not (is_long or (quick(command) != command and not is_whole)):
                measured = words(command)[1] in MEASURING | {"python"}
                assert agrees(done.stdout, shown, measured), f"{command} shows\n{done.stdout}"


def test_every_block_says_what_it_is():
    pages = {page.name: page.read_text(encoding="utf-8") for page in PAGES}
    hidden = re.compile(r"^(    \$ |```\n(?=\$ |linkproof ))", re.MULTILINE)
    assert not {name for name, text in pages.items() if hidden.search(text)}
    assert sum(len(list(commands(text))) for page in PAGES for kind, text in blocks(page) if kind == "console") > 25


# Every script of docs/finds.md still shows its fault: its output has the words and the differences of the page.


(PAGE,) = (page for page in PAGES if page.name == "finds.md")
SCRIPTS = [text for kind, text in blocks(PAGE) if kind == "console"]
STILL = 0.01  # of a difference: where a linkage comes apart, processors differ
ROUNDING = 1e-9
GIVEN_UP = re.compile(r"solved (\d+) of (\d+) frames")


def differences(text):
    """The last number of every row, by the row's name."""
    rows = (line.rsplit(maxsplit=5) for line in text.splitlines() if "  " in line and "difference" not in line)
    return {row[0]: abs(float(row[-1])) for row in rows}


def name(text):
    """The engine of a block."""
    return re.search(r"ondsel|simbody|mujoco|pymunk", text)[0]


@pytest.mark.parametrize(
    "text",
    [text if name(text) == "mujoco" else pytest.param(text, marks=pytest.mark.nightly) for text in SCRIPTS],
    ids=name,
)
def test_a_fault_of_an_engine_is_still_there(text, shell, tmp_path):
    for path, file in FILE.findall(PAGE.read_text(encoding="utf-8")):
        (tmp_path / path).write_text(file, encoding="utf-8")
    (export, _), (script, shown) = commands(text)
    assert shell(export, tmp_path).returncode == 0
    output = shell(script, tmp_path).stdout
    assert agrees(output, shown, measured=True), output
    if "solved" in shown:
        assert GIVEN_UP.search(output)[1] != GIVEN_UP.search(output)[2]
        return
    found, expected = differences(output), differences(shown)
    assert max(expected.values()) > ROUNDING
    assert not {name for name, off in expected.items() if off > ROUNDING and found[name] < STILL * off}


# So does every script that stands on the page itself, where what it imports is installed.


FAULTS = re.findall(
    r"^```python (\w+\.py)\n(.*?)^```\n\n```text\n(.*?)^```$", PAGE.read_text(encoding="utf-8"), re.M | re.S
)
assert len(FAULTS) >= 7


@pytest.mark.parametrize(("file", "text", "shown"), FAULTS, ids=[file for file, _, _ in FAULTS])
def test_a_script_of_a_fault_prints_what_its_page_shows(file, text, shown, shell, tmp_path):
    for module in re.findall(r"^(?:import|from) (\w+)", text, re.MULTILINE):
        pytest.importorskip(module)
    (tmp_path / file).write_text(text, encoding="utf-8")
    output = shell(f"python {file} 2> warnings.txt", tmp_path).stdout
    assert agrees(output, shown, measured=False), output


# The tutorial runs from its first cell to its last, and prints what it shows.


NOTEBOOK = Path(__file__).parents[2] / "docs" / "tutorial.ipynb"


@pytest.mark.nightly  # docs/python.md shows the same calls
def test_every_cell_prints_what_the_notebook_shows(monkeypatch):
    """Cells are run in this process, which knows what they defined as a kernel does; pictures are counted."""
    known, pictures = {}, []
    mpl.use("agg")
    monkeypatch.setattr("matplotlib.pyplot.show", lambda: pictures.append("display_data"))
    cells = json.loads(NOTEBOOK.read_text(encoding="utf-8"))["cells"]
    code = [cell for cell in cells if cell["cell_type"] == "code"]
    assert sum(bool(cell["outputs"]) for cell in code) > 3
    for cell in code:
        pictures.clear()
        with redirect_stdout(StringIO()) as text:
            exec("".join(cell["source"]), known)
        shown = [part for output in cell["outputs"] for part in output.get("text", ())]
        assert printed.is_same(text.getvalue(), "".join(shown))
        assert pictures == [kind for output in cell["outputs"] if (kind := output["output_type"]) != "stream"]
