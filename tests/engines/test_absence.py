"""What every adapter of a third-party engine does where its engine is absent, or broken inside."""

import sys

import pytest

from analytic.description.crank_motion import crank_motion
from analytic.description.loading import load
from analytic.kinematics.mechanism import Mechanism
from comparisons.reference.start_state import scene
from engines.contract import Outcome, Setting
from engines.registry import engine
from engines.scene import Channel, Prescribed


@pytest.mark.parametrize("name", ["exudyn", "pymunk"])
def test_an_absent_engine_is_unavailable_and_an_error_inside_it_is_not_hidden(monkeypatch, name):
    adapter = engine(name)
    model = scene(Mechanism(load("juki-mf7923d")), Prescribed(crank_motion()), set(Channel) - {Channel.JOINT_FORCE})
    monkeypatch.setitem(sys.modules, name, None)
    run = adapter.run(model, Setting.TUNED)
    assert run.outcome is Outcome.UNAVAILABLE
    assert "pip install" in run.reason

    class Broken:
        def find_spec(self, wanted, path=None, target=None):
            if wanted == name:
                raise ModuleNotFoundError("No module named 'slip_of_the_pen'", name="slip_of_the_pen")

    monkeypatch.delitem(sys.modules, name)
    monkeypatch.setattr(sys, "meta_path", [Broken(), *sys.meta_path])
    with pytest.raises(ModuleNotFoundError, match="slip_of_the_pen"):
        adapter.run(model, Setting.TUNED)
