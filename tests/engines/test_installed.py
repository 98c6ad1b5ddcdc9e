"""Engines that are absent, broken inside or too old, and keeping an engine quiet: nothing else is lost."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from analytic.description.crank_motion import crank_motion
from analytic.errors import LinkproofError
from engines.contract import Outcome, Setting
from engines.ondsel_adapter import OndselEngine
from engines.registry import engine
from reports.api import campaign
from tests.analytic.linkages import mechanism
from tests.engines.closed_form import driven

ROOT = Path(__file__).parents[2]
SCRIPT = """
import ctypes, os, sys
from engines.registry import silenced
sys.stdout.write("before ")
with silenced():
    sys.stdout.write("of Python ")
    sys.stderr.write("of Python ")
    os.write(1, b"of the system ")
    ctypes.CDLL(None).printf(b"of C ")
sys.stdout.write("after")
"""


def test_output_of_an_engine_is_written_nowhere():
    environment = {name: value for name, value in os.environ.items() if name != "PYTHONUNBUFFERED"}
    command = [sys.executable, "-c", SCRIPT]
    done = subprocess.run(command, capture_output=True, text=True, cwd=ROOT, env=environment, check=True)
    assert (done.stdout, done.stderr) == ("before after", "")


def test_an_absent_engine_is_unavailable_and_an_error_inside_it_is_not_hidden(monkeypatch):
    adapter, model = engine("pymunk"), driven(mechanism("juki-mf7923d"), crank_motion())
    with monkeypatch.context() as absent:
        absent.setattr(type(adapter), "distribution", "no-such-package")
        run = adapter.run(model, Setting.TUNED)
    assert (run.outcome, "pip install" in run.reason) == (Outcome.UNAVAILABLE, True)

    class Broken:
        def find_spec(self, name, path=None, target=None):
            if name == "pymunk":
                raise ModuleNotFoundError("No module named 'slip_of_the_pen'", name="slip_of_the_pen")

    monkeypatch.delitem(sys.modules, "pymunk", raising=False)
    monkeypatch.setattr(sys, "meta_path", [Broken(), *sys.meta_path])
    with pytest.raises(ModuleNotFoundError, match="slip_of_the_pen"):
        adapter.run(model, Setting.TUNED)


def test_an_engine_too_old_is_refused_by_name_and_a_row_otherwise(monkeypatch):
    monkeypatch.setattr(OndselEngine, "package", "numpy")
    monkeypatch.setattr(OndselEngine, "oldest", "9999")
    monkeypatch.setattr(campaign, "adapters", lambda names: [OndselEngine() for _ in names])
    with pytest.raises(LinkproofError, match=r"numpy .* is too old, 9999 is the first that will do: pip install"):
        campaign.requested_engines(["ondsel"])
    run = OndselEngine().run(driven(mechanism("juki-mf7923d"), crank_motion()), Setting.TUNED)
    assert (run.outcome, "is too old" in run.reason) == (Outcome.UNAVAILABLE, True)
