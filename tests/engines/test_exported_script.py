"""A run as a script: it needs the engine alone, and says to rounding what the adapter says."""

import ast
import shlex
import subprocess
import sys
import tomllib
from dataclasses import replace

import numpy as np
import pytest
import tomlkit

from analytic.description.crank_motion import crank_motion
from analytic.description.loading import load
from analytic.kinematics.mechanism import Mechanism
from comparisons.motion.case import Case, case_of_file_regime, scene
from comparisons.trials.conformance.trial import case as sample_case
from comparisons.trials.exported_run import exported
from engines.contract import Outcome, Setting
from engines.exported_script import script
from engines.mujoco_adapter import EXPERT, MujocoEngine
from engines.registry import engine
from engines.scene import Channel, Prescribed
from engines.stepping.intervals import UnsupportedError
from tests.analytic.linkages import double_rocker_text, from_text, mechanism
from tests.engines.closed_form import installed

SWITCHED = """
[regimes.switched]
torque = [0.0, 1.0, -1.0]
time = [0.01, 0.02, 0.04]
start_angle = 30
duration = 0.05
"""
# Without its user's environment, and without us wherever we are installed.
ALONE = """
import runpy, sys
sys.modules.update(dict.fromkeys(("analytic", "engines", "comparisons", "reports")))
import numpy as np
samples = dict(runpy.run_path("case.py")["samples"])
samples |= {f"force in {joint}": pair for joint, pair in samples.pop("joint_force", {}).items()}
np.savez("samples.npz", **{f"{name}/{n}": np.array(v) for name, pair in samples.items() for n, v in enumerate(pair)})
"""


def _case(linkage, regime):
    if regime == "sample":
        return sample_case(linkage)
    found = from_text(double_rocker_text(regimes=SWITCHED)) if regime == "switched" else mechanism(linkage)
    regimes = [each for each in found.linkage.regimes if each.name == regime]
    return (
        case_of_file_regime(found, replace(regimes[0], duration=min(0.4, regimes[0].duration)))
        if regimes
        else Case(found, crank_motion(regime, ramp_time=0.02, hold_time=0.01))
    )


def _run_alone(text, folder):
    (folder / "case.py").write_text(text, encoding="utf-8")
    done = subprocess.run([sys.executable, "-I", "-c", ALONE], cwd=folder, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    samples = np.load(folder / "samples.npz")
    return {name: (samples[f"{name}/0"], samples[f"{name}/1"]) for name in {key[:-2] for key in samples}}, done.stdout


# Every engine with a load over φ or one over time, or with a linear driver; the rest nightly.
USUAL = [
    ("dart", "slotted-takeup", "run-up", "naive"),
    ("exudyn", "driven slider", "sample", "naive"),
    ("mujoco", "double-rocker", "switched", "tuned"),
    ("ondsel", "slotted-takeup", "run-up", "tuned"),
    ("pymunk", "double-rocker", "switched", "naive"),
]
NIGHTLY = [
    ("simbody", "double-rocker", "switched", "tuned"),
    *(("exudyn", *case) for case in (("spring-and-damper", "run-up", "naive"), ("slotted-takeup", "free", "tuned"))),
    ("exudyn", "double-rocker", "switched", "tuned"),
    ("ondsel", "cylinder", "sample", "tuned"),
    ("mujoco", "spring-and-damper", "run-up", "tuned"),
    ("pinocchio", "force-over-angle", "run-up", "tuned"),
    ("pybullet", "slotted-takeup", "run-up", "naive"),  # which prints nothing: a change of its solver does
    ("pymunk", "slotted-takeup", "driven", "tuned"),
    *((name, "force-over-angle", "run-up", "tuned") for name in ("exudyn", "mujoco", "pymunk", "simbody")),
    *((name, "cylinder", "sample", "tuned") for name in ("exudyn", "mujoco", "pymunk", "simbody")),
]  # fmt: skip


@pytest.mark.parametrize(
    ("name", "linkage", "regime", "setting"),
    [*USUAL, *(pytest.param(*case, marks=pytest.mark.nightly) for case in NIGHTLY)],
)
def test_a_script_alone_says_what_the_adapter_says(name, linkage, regime, setting, tmp_path):
    adapter, case = installed(name), _case(linkage, regime)
    samples, printed = _run_alone(exported(case, name, Setting(setting), "linkproof compare"), tmp_path)
    run = adapter.run(case.scene(frozenset(Channel)), Setting(setting))
    assert run.outcome is Outcome.FINISHED
    signals = {channel: getattr(run.history, channel) for channel in ("position", "velocity", "acceleration", "torque")}
    signals |= {f"force in {joint}": signal for joint, signal in run.history.joint_force.items()}
    assert samples.keys() == {key for key, signal in signals.items() if signal is not None}
    # The script's samples are in the engine's units: their unit is one factor for all of them, but for angles.
    for key, (time, values) in samples.items():
        right = signals[key].values
        np.testing.assert_allclose(time, signals[key].time, rtol=0, atol=1e-12)
        for part in (np.s_[..., :2], np.s_[..., 2:]) if right.ndim > 2 else (np.s_[...],):
            unit = np.vdot(values[part], right[part]) / (np.vdot(values[part], values[part]) or 1.0)
            np.testing.assert_allclose(unit * values[part], right[part], rtol=0, atol=1e-9 * np.abs(right[part]).max())
    figures = [row.split() for row in printed.splitlines()[1:]]
    assert len(figures) >= 6 + (run.history.torque is not None)
    for *_, read, exported_figure, _true, _difference in figures:
        assert float(read) == pytest.approx(float(exported_figure), rel=1e-8, abs=1e-10)


@pytest.mark.nightly
def test_a_run_that_an_engine_gives_up_is_given_up_by_its_script(tmp_path):
    pytest.importorskip("pyondsel")
    at_change_point = Mechanism(load("comparisons/trials/stress/linkages/parallel-cranks.toml"))
    motion = crank_motion("run-up-quintic", ramp_time=0.24, hold_time=0.06, start_angle=0.5 * np.pi)
    text = exported(Case(at_change_point, motion), "ondsel", Setting.TUNED, "linkproof compare")
    (tmp_path / "case.py").write_text(text, encoding="utf-8")
    done = subprocess.run([sys.executable, "-I", "case.py"], cwd=tmp_path, capture_output=True, text=True, check=False)
    assert done.returncode == 1
    assert done.stderr.startswith("Ondsel solved 25 of 101 frames")


CODE = '__import__("os").mkdir("pwned")'
NAMES = ("O1", "O2", "A", "B", "C", "D", "crank", "rod", "rocker", "link", "needle_bar")
HOSTILE = (  # as many times as there are names
    f'""";{CODE};"""', f"\'\'\';{CODE};\'\'\'", f'");{CODE};("', f"');{CODE};('", f'\\";{CODE};\\"', f"#\u2028{CODE}",
    f"{{{CODE}}}", f"#\ufeff{CODE}", "ends in \\", "a, \"b', c" * 30, "long, " * 500,
    '""', "'", "\ue0003\ue001", "<a b='1'/>", "\\x00\\N{BELL}", "# -*- coding: utf-7 -*-", "e\u0301", "inf",
    " ", "{0}{name}{", "\u200b%s\\",
)  # fmt: skip


def _renamed(value, names):
    if isinstance(value, dict):
        return {names.get(key, key): _renamed(each, names) for key, each in value.items()}
    return names.get(value, value) if isinstance(value, str) else value


@pytest.mark.parametrize(
    ("name", "first"),
    [("ondsel", 0), ("mujoco", 11),  # which write files or names of their own
     *(pytest.param(*case, marks=pytest.mark.nightly) for case in (
         ("simbody", 0), ("exudyn", 0), ("pymunk", 11), ("ondsel", 11), ("mujoco", 0), ("simbody", 11)))],
)  # fmt: skip
def test_no_name_becomes_code_or_breaks_a_script(name, first, tmp_path):
    pytest.importorskip(engine(name).package)
    hostile = HOSTILE[first : first + len(NAMES)]
    given, names = tomllib.loads(load("rimoldi-164").text), dict(zip(NAMES, hostile, strict=True))
    document = {key: _renamed(given[key], names) for key in ("units", "crank", "output", "ground", "links", "sketch")}
    swing = {"from": 0, "to": 20, "time": 0.05}
    document |= {"title": "\n".join(HOSTILE), "variant": hostile[0], "regimes": {hostile[1]: swing}}
    found = from_text(tomlkit.dumps(document), f"{hostile[0]}\\")
    case = case_of_file_regime(found, found.linkage.regimes[0])
    scene = case.scene(frozenset())
    text = exported(case, name, Setting.TUNED, shlex.join(["linkproof", "compare", *HOSTILE]))
    script = ast.parse(text)
    assert "__import__" not in {node.id for node in ast.walk(script) if isinstance(node, ast.Name)}
    assert HOSTILE[0] in ast.get_docstring(script)
    samples, printed = _run_alone(text, tmp_path)
    assert {path.name for path in tmp_path.iterdir()} == {"case.py", "samples.npz"}
    assert samples.keys() >= {f"force in {joint.name}" for joint in (*scene.pins, *scene.guided)}
    for line in printed.strip("\n").split("\n")[1:]:
        read, exported_figure = line.split()[-4:-2]
        assert float(read) == pytest.approx(float(exported_figure), rel=1e-8, abs=1e-10)


@pytest.mark.parametrize("line", [
    "from engines.scene import Scene", "import numpy, linkproof.engine", "from . import other",
    "from analytic import x",
])  # fmt: skip
def test_a_loop_that_needs_linkproof_is_refused(line, monkeypatch, tmp_path):
    pytest.importorskip("mujoco")
    (tmp_path / "own_loop.py").write_text(f'"""A loop."""\nimport numpy\ndef unused():\n    {line}\n')
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.delitem(sys.modules, "own_loop", raising=False)
    adapter = MujocoEngine()
    monkeypatch.setattr(adapter, "loop", "own_loop", raising=False)
    given = scene(mechanism("juki-mf7923d"), Prescribed(crank_motion()), frozenset())
    with pytest.raises(UnsupportedError, match=r"line 4 of its loop 'own_loop' imports a part of linkproof"):
        script(adapter, given, EXPERT, "", lambda _: [])
