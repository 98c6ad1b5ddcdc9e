"""Changes of a user's repository, one at a time: red in `compare` and in pytest though the engine follows them."""

import json
import pickle
import re
import shutil

import pytest

import linkproof
from engines.direct_adapter.adapter import DirectEngine
from tests.reports.pytest_plugin.projects import run

pytest_plugins = ["pytester"]

PROJECT = """
linkages = ["linkages/*.toml"]
engines = ["direct"]
regimes = ["constant-speed", "own"]
figures = ["Mkr@30", "joint_force:A.rms", "omega.max", "joint_force.max"]
[[limit]]
quantities = ["Jeq"]
mechanisms = ["other"]
regimes = ["coast"]
value = 1e-3
"""
PRESS = """
title = "a four-bar with a coupler point, a spring and a load"
units = { length = "mm", mass = "kg", inertia = "kg*m^2", angle = "deg" }
crank = "crank"
gravity = [0, -9.81]
output = { point = "C", along = [1, 0] }
[ground]
O1 = [0, 0]
O2 = [50, 0]
Q = [90, 10]
[links.crank]
points = { O1 = [0, 0], A = [20, 0] }
mass = 0.5
centre = [5, 0]
inertia = 1e-4
[links.coupler]
points = { A = [0, 0], B = [60, 0], C = [30, 15], P = [10, -5] }
mass = 0.2
centre = [30, 5]
inertia = 6e-5
[links.rocker]
points = { O2 = [0, 0], B = [45, 0] }
mass = 0.1
centre = [20, 0]
inertia = 2e-5
[sketch]
angle = 0
points = { B = [40, 40] }
[[springs]]
between = ["B", "Q"]
stiffness = 120
length = 40
links = ["rocker", "ground"]
[[forces]]
point = "C"
force = [0, -5]
[[dampers]]
between = ["rocker", "ground"]
coefficient = 2e-4
[thread]
stops = [{ guide = [-25, 40, 0], name = "N1" }, { eye = "P", z = 0 }, { guide = [-20, 25, 0], name = "N2" }]
stretch = 6
feed = "shortening"
reference = 0
[variants.light.links.crank]
mass = 0.4
"""
COAST = """
[regimes.coast]
torque = 0.2
start_angle = 0
start_speed = 30
duration = 0.05
"""
FAST = {"quantity": "Jeq", "jobs": 0}
PATH, BASELINE = "linkages/press.toml", "linkproof-baseline.json"


@pytest.fixture(scope="module", autouse=True)
def _every_scene_once():
    """A scene that no change has reached is not run again."""
    run, known = DirectEngine.run, {}

    def run_once(engine, scene, setting):
        key = pickle.dumps((scene, setting))
        if key not in known:
            known[key] = run(engine, scene, setting)
        return known[key]

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(DirectEngine, "run", run_once)
        yield


@pytest.fixture(scope="module")
def recorded(tmp_path_factory):
    """A repository of two linkages, recorded under its project."""
    folder = tmp_path_factory.mktemp("repository")
    (folder / "linkages").mkdir()
    (folder / "linkproof.toml").write_text(PROJECT)
    (folder / PATH).write_text(PRESS + COAST)
    (folder / "linkages" / "other.toml").write_text(PRESS.partition("[[springs]]")[0])
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(folder)
        linkproof.compare(record_baseline=True, **FAST)
        assert linkproof.compare(**FAST).passed
    return folder


@pytest.fixture
def folder(recorded, pytester):
    return shutil.copytree(recorded, pytester.path, dirs_exist_ok=True)


def _edit(old, new, file=PATH):
    """A change of one place in a file."""

    def change(folder):
        text = (folder / file).read_text(encoding="utf-8")
        assert text.count(old) == 1
        (folder / file).write_text(text.replace(old, new), encoding="utf-8")

    return change


def _project(old, new):
    return _edit(old, new, "linkproof.toml")


def _recorded_as_one(name):
    """A figure of the baseline put to 1."""

    def change(folder):
        text = (folder / BASELINE).read_text(encoding="utf-8")
        text, count = re.subn(rf'("{name}": )[\d.e+-]+', r"\g<1>1.0", text)
        assert count
        (folder / BASELINE).write_text(text, encoding="utf-8")

    return change


def _not_listed(folder):
    _project(', "omega.max"', "")(folder)
    _recorded_as_one("omega.max")(folder)


def _without_figures(folder):
    document = json.loads((folder / BASELINE).read_text(encoding="utf-8"))
    for regimes in document["linkages"][PATH]["variants"].values():
        for regime in regimes.values():
            del regime["figures"]
    (folder / BASELINE).write_text(json.dumps(document), encoding="utf-8")


# A change, and a part of the sentence of the figure that it changes.
FIGURES = {
    "mass by 0.5 %": (_edit("mass = 0.2", "mass = 0.201"), "Mkr.peak was .* N m and is .* N m, "),
    "length by 0.05 mm": (_edit("B = [60, 0]", "B = [60.05, 0]"), "stroke was .* m and is "),
    "inertia": (_edit("inertia = 6e-5", "inertia = 6.01e-5"), "Jeq.mean was .* kg m² and is "),
    "coupler point": (_edit("P = [10, -5]", "P = [10, -5.01]"), "point:P:y@0s was .* m and is "),
    "output's own point": (_edit("C = [30, 15]", "C = [30, 15.05]"), "S.max was .* m and is "),
    "output's name": (_edit('output = { point = "C"', 'output = { point = "P"'), "output:point:x@0s was .* m "),
    "output's direction": (_edit("along = [1, 0]", "along = [-1, 0]"), "output:direction:x was 1 and is -1"),
    "assembly": (_edit("B = [40, 40]", "B = [40, -40]"), "v.max was .* m/s and is "),
    "spring": (_edit("stiffness = 120", "stiffness = 121"), "Mkr.rms was .* N m and is "),
    "load": (_edit("force = [0, -5]", "force = [0, -5.01]"), "Peq.peak was .* W and is "),
    "damper": (_edit("coefficient = 2e-4", "coefficient = 2.01e-4"), "a.max was .* m/s² and is "),
    "gravity": (_edit("-9.81", "-9.8"), "joint_force:A.peak was .* N and is "),
    "listed figure of the baseline": (_recorded_as_one("Mkr@30"), "Mkr@30 was 1 N m and is "),
    "listed figure that is new": (_project('"Mkr@30"', '"S@20"'), "S@20 is .* m and was not recorded"),
    "figure recorded and not listed": (_not_listed, "omega.max was 1 rad/s and is "),
    "number of another variant": (
        _edit("mass = 0.4\n", "mass = 0.402\n"),
        r"\(light\), .*: joint_force:O1.peak was .* N and is ",
    ),
    "guide of the thread": (_edit("[-20, 25, 0]", "[-20, 25.1, 0]"), "thread:length@0s was .* m and is "),
}
MISSING = "is in the baseline and is not compared any more"
SETS = {
    "file deleted": (lambda folder: (folder / PATH).unlink(), f"{PATH} is in the baseline and does not exist any more"),
    "file renamed": (
        lambda folder: (folder / PATH).rename(folder / "linkages" / "punch.toml"),
        f"{PATH} was renamed to linkages/punch.toml",
    ),
    "file added": (
        lambda folder: (folder / "linkages" / "new.toml").write_text(PRESS),
        "linkages/new.toml is not in the baseline",
    ),
    "file left out": (_project("linkages/*.toml", "linkages/o*.toml"), f"{PATH} {MISSING}"),
    "gravity off": (_edit("-9.81", "0"), "gravity off is not in the baseline"),
    "released otherwise": (_edit("torque = 0.2", "torque = 0.21"), r"coast: .* 0.21 N m, .* is not in the base"),
    "regime removed": (_edit(COAST, ""), rf"press.toml \(base\), coast: .* {MISSING}"),
    "regime not requested": (
        _project('"constant-speed", ', ""),
        r"press.toml \(base\), constant-speed: .* is not compared any more",
    ),
    "variant added": (
        _edit("[variants.", "[variants.heavy]\nlinks.crank.mass = 0.6\n[variants."),
        r"press.toml \(heavy\), constant-speed: .* is not in the baseline",
    ),
    "variant removed": (
        _edit("[variants.light.links.crank]\nmass = 0.4", ""),
        rf"press.toml \(light\) {MISSING}",
    ),
    "figures taken out of the baseline": (_without_figures, r"press.toml \(base\), .* is not in the baseline"),
    "baseline emptied": (
        lambda folder: (folder / BASELINE).write_text('{"format": 1, "linkages": {}}'),
        f"{PATH} is not in the baseline",
    ),
}
SLIPS = {
    "linkage of a limit": (_project('["other"]', '["othr"]'), "unknown mechanism of limit 1 'othr': did"),
    "regime of a limit": (_project('["coast"]', '["cost"]'), "unknown regime of limit 1 'cost': did you"),
    "engine of the project": (_project('["direct"]', '["dirct"]'), "unknown engine of .*'dirct': did"),
    "regime of the project": (_project('"own"', '"owm"'), "unknown regime 'owm': did you mean 'own'"),
    "figure of the project": (_project("Mkr@30", "Mkrr@30"), "no linkage has 'Mkrr@30': unknown figure .*"),
    "baseline named and gone": (
        _project("engines =", 'baseline = "gone.json"\nengines ='),
        "expected a baseline at .*gone.json', got no such file",
    ),
}


@pytest.mark.parametrize(("change", "words"), FIGURES.values(), ids=FIGURES)
def test_a_changed_linkage_is_red_by_figures_with_units(folder, change, words):
    change(folder)
    found = linkproof.compare(PATH, **FAST)
    assert not found.passed
    assert not found.departures
    sentences = [figure.sentence for figure in found.figures if figure.changed]
    assert any(re.search(words, sentence) for sentence in sentences), sentences


@pytest.mark.parametrize(("change", "words"), SETS.values(), ids=SETS)
def test_a_changed_set_is_red_unless_it_is_allowed(folder, change, words):
    change(folder)
    found = linkproof.compare(**FAST)
    assert not found.passed
    assert any(re.search(words, sentence) for sentence in found.departures), found.departures
    allowed = linkproof.compare(allow_new=True, allow_missing=True, **FAST)
    assert allowed.passed
    assert {*found.departures} <= {*allowed.notes}


@pytest.mark.parametrize(("change", "words"), SLIPS.values(), ids=SLIPS)
def test_a_slip_in_a_name_is_an_error(folder, change, words):
    change(folder)
    with pytest.raises(linkproof.LinkproofError, match=words):
        linkproof.compare(**FAST)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        FIGURES["mass by 0.5 %"],
        FIGURES["listed figure that is new"],
        SETS["file deleted"],
        SETS["file added"],
        SETS["variant removed"],
        SLIPS["regime of a limit"],
        SLIPS["engine of the project"],
    ],
)
def test_pytest_is_red_with_the_same_sentences(folder, pytester, change, words):
    change(folder)
    done = run(pytester, "-k", "figures or set-of")
    assert done.ret in (pytest.ExitCode.TESTS_FAILED, pytest.ExitCode.INTERRUPTED)
    assert re.search(words, done.stdout.str())


def test_a_new_recording_leaves_out_what_is_missing(folder):
    for change in ("regime removed", "variant removed"):
        SETS[change][0](folder)
    (folder / "linkages" / "other.toml").unlink()
    text = (folder / "linkproof.toml").read_text(encoding="utf-8")
    (folder / "linkproof.toml").write_text(text.partition("[[limit]]")[0], encoding="utf-8")
    linkproof.compare(record_baseline=True, **FAST)
    assert linkproof.compare(**FAST).passed
    entries = json.loads((folder / BASELINE).read_text(encoding="utf-8"))["linkages"]
    assert {path: [*entry["variants"]] for path, entry in entries.items()} == {PATH: ["base"]}
    (regime,) = entries[PATH]["variants"]["base"]
    assert regime.startswith("constant-speed: ")


def test_a_linkage_that_is_named_is_a_part_of_the_set(folder):
    assert linkproof.compare(PATH, **FAST).passed
    assert linkproof.compare(PATH, baseline=BASELINE, **FAST).passed
    other = linkproof.compare(PATH, speed=500, **FAST)
    assert other.passed
    assert "500 rpm" in " ".join(other.notes)
    assert not linkproof.compare(PATH, speed=500, baseline=BASELINE, **FAST).passed
    (folder / "linkages" / "new.toml").write_text(PRESS)
    assert linkproof.compare("linkages/new.toml", **FAST).departures
    assert linkproof.compare("linkages/new.toml", allow_new=True, **FAST).passed


@pytest.mark.parametrize(("name", "change"), [("allow_new", "file added"), ("allow_missing", "file deleted")])
def test_a_project_may_allow_differences(folder, name, change):
    SETS[change][0](folder)
    text = (folder / "linkproof.toml").read_text()
    for value, passed in (("true", True), ("false", False)):
        (folder / "linkproof.toml").write_text(f"{name} = {value}\n{text}")
        assert linkproof.compare(**FAST).passed is passed
