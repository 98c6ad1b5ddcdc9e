"""Every change that a user may make in a repository turns `linkproof compare` and pytest red."""

import json

import pytest

from reports.pytest_plugin import collecting
from tests.commands import linkproof
from tests.reports.pytest_plugin.projects import BAR, run

pytest_plugins = ["pytester"]
assert collecting  # imported once, for all runs of pytest in this process
PRESS = """\
title = "A four-bar with all that a gate watches"
units = { length = "mm", mass = "kg", inertia = "kg*m^2", angle = "deg" }
crank = "crank"
gravity = [0, -9.81]
ground = { O1 = [0, 0], O2 = [60, 0], G = [90, -20] }
sketch = { angle = 60, points = { B = [60, 45] } }
output = { point = "P", along = [0, 1] }
forces = [{ point = "B", link = "rocker", force = [2.0, 1.0] }]
springs = [{ between = ["G", "B"], links = ["ground", "rocker"], stiffness = 100.0, length = 50.0 }]
links.crank = { points = { O1 = [0, 0], A = [20, 0] }, mass = 0.2, centre = [5, 0], inertia = 2e-5 }
links.rocker = { points = { O2 = [0, 0], B = [45, 0] }, mass = 0.12, centre = [20, 0], inertia = 3e-5 }
[links.coupler]
points = { A = [0, 0], B = [60, 0], P = [28, 28], R = [10, 5], Q = [40, 10] }
mass = 0.15
centre = [30, 5]
inertia = 6e-5
[thread]
stops = [{ guide = [-25, 40, 0], name = "N1" }, { eye = "Q", z = 0 }, { guide = [-20, 25, 0], name = "N2" }]
stretch = 6
feed = "shortening"
reference = 0
[regimes.start]
from = 0
to = 40
time = 0.02
law = "cycloidal"
[variants.heavy.links.crank]
mass = 0.3
"""
PROJECT = """\
linkages = ["linkages/*.toml"]
engines = ["direct"]
regimes = ["start"]
baseline = "linkproof-baseline.json"
figures = ["Mkr@30", "joint_force:A.rms", "omega.max"]
[[limit]]
quantities = ["Mkr"]
regimes = ["start"]
mechanisms = ["press"]
value = 1e-3
"""
REGIME = '[regimes.start]\nfrom = 0\nto = {}\ntime = 0.02\nlaw = "cycloidal"\n'
PLAIN = BAR + REGIME.format(40)
FILE, STANDARD, RECORDED = "linkages/press.toml", "linkproof.toml", "linkproof-baseline.json"


def edited(name, old, new):
    """A change of the text of a file."""

    def change(folder):
        text = (folder / name).read_text()
        assert text.count(old) == 1
        (folder / name).write_text(text.replace(old, new))

    return change


def figure(name, share):
    """A change of a recorded figure of press by a share."""

    def change(folder):
        document = json.loads((folder / RECORDED).read_text())
        (regime,) = document["linkages"][FILE]["variants"]["base"].values()
        regime["figures"][name] *= 1.0 + share
        (folder / RECORDED).write_text(json.dumps(document))

    return change


CHANGES = {
    "mass +0.5 %": (edited(FILE, "mass = 0.15", "mass = 0.15075"), "Mkr.peak was"),
    "length +0.05 mm": (edited(FILE, "O2 = [0, 0], B = [45, 0]", "O2 = [0, 0], B = [45.05, 0]"), "stroke was"),
    "coupler point 0.1 mm": (edited(FILE, "R = [10, 5]", "R = [10, 5.1]"), "point:R:y@0s was"),
    "another output point": (edited(FILE, 'output = { point = "P"', 'output = { point = "R"'), "output:point:x@0s was"),
    "another output direction": (edited(FILE, "along = [0, 1]", "along = [0.02, 1]"), "output:direction:x was"),
    "file deleted": (lambda folder: (folder / FILE).unlink(), "press.toml is in the baseline and does not exist"),
    "file renamed": (lambda folder: (folder / FILE).rename(folder / "linkages/mill.toml"), "was renamed to"),
    "file added": (lambda folder: (folder / "linkages/a.toml").write_text(PLAIN), "a.toml is not in the baseline"),
    "variant deleted": (edited(FILE, "[variants.heavy.links.crank]\nmass = 0.3\n", ""), "(heavy) is in the baseline"),
    "variant added": (edited(FILE, "[variants.", "[variants.light]\nlinks.crank.mass = 0.1\n[variants."),
                      "(light), start: "),
    "variant changed": (edited(FILE, "mass = 0.3", "mass = 0.303"), "joint_force:O1.peak was"),
    "regime deleted": (edited("linkages/bar.toml", REGIME.format(40), ""), "bar.toml (base), start: "),
    "regime changed": (edited(FILE, "to = 40\n", "to = 41\n"), "press.toml (base), start: "),
    "limit of an unknown mechanism": (edited(STANDARD, '["press"]', '["pres"]'), "did you mean 'press'?"),
    "limit of an unknown quantity": (edited(STANDARD, '["Mkr"]', '["Mkrr"]'), "did you mean 'Mkr'?"),
    "limit of an unknown regime": (edited(STANDARD, 'regimes = ["start"]\nmech', 'regimes = ["stat"]\nmech'),
                                   "did you mean 'start'?"),
    "baseline edited": (figure("Jeq.mean", 2e-6), "Jeq.mean was"),
    "listed figure edited": (figure("Mkr@30", 2e-6), "Mkr@30 was"),
    "figure listed anew": (edited(STANDARD, '"omega.max"', '"omega.max", "S@20"'), "S@20"),
    "figure of an unknown name": (edited(STANDARD, "Mkr@30", "Mkrr@30"), "no linkage has 'Mkrr@30'"),
    "baseline deleted": (lambda folder: (folder / RECORDED).unlink(), "linkproof-baseline.json', got no such file"),
    "spring +1 %": (edited(FILE, "stiffness = 100.0", "stiffness = 101.0"), "Mkr.peak was"),
    "load +1 %": (edited(FILE, "force = [2.0, 1.0]", "force = [2.02, 1.01]"), "Mkr.peak was"),
    "thread point moved": (edited(FILE, "Q = [40, 10]", "Q = [40.1, 10]"), "thread:length@0s was"),
    "thread guide moved": (edited(FILE, "guide = [-20, 25, 0]", "guide = [-20, 25.1, 0]"), "thread:length@0s was"),
    "gravity": (edited(FILE, "gravity = [0, -9.81]", "gravity = [0, -9.8]"), "joint_force:A.peak was"),
}  # fmt: skip


@pytest.fixture(scope="module")
def recorded(tmp_path_factory):
    """Files of a project whose baseline is recorded, by path."""
    folder = tmp_path_factory.mktemp("recorded")
    (folder / "linkages").mkdir()
    for name, text in ((FILE, PRESS), ("linkages/bar.toml", PLAIN), (STANDARD, PROJECT)):
        (folder / name).write_text(text)
    done = linkproof("compare", "--record-baseline", "--jobs", "0", cwd=folder)
    assert done.returncode == 0, done.stderr
    return {name: (folder / name).read_text() for name in (FILE, "linkages/bar.toml", STANDARD, RECORDED)}


@pytest.fixture
def repository(pytester, recorded):
    """The folder of a project that is as it was recorded."""
    pytester.mkdir("linkages")
    for name, text in recorded.items():
        (pytester.path / name).write_text(text)
    return pytester.path


def test_an_unchanged_repository_is_green(repository, pytester):
    assert linkproof("compare", "--jobs", "0", cwd=repository).returncode == 0
    assert run(pytester).ret == pytest.ExitCode.OK


@pytest.mark.parametrize("name", CHANGES)
def test_a_change_turns_compare_and_pytest_red(repository, pytester, name):
    change, words = CHANGES[name]
    change(repository)
    done = linkproof("compare", "--quantity", "Mkr", "--jobs", "0", cwd=repository)
    assert done.returncode in (1, 2)
    assert words.removesuffix(" was") in done.stdout + done.stderr
    tests = run(pytester, "-k", "figures or set-of")  # the engine is not what has changed
    assert tests.ret in (pytest.ExitCode.TESTS_FAILED, pytest.ExitCode.INTERRUPTED)
    assert words in tests.stdout.str()
