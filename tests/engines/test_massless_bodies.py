"""Bodies without mass or inertia: every engine is right with them or says in one sentence which it cannot hold."""

import re

import pytest

from analytic.description.crank_motion import crank_motion
from comparisons.reference.case import Truth
from comparisons.reference.start_state import scene
from engines.contract import Outcome, Setting
from engines.registry import engine as engine_of
from engines.scene import Channel, Prescribed
from tests.analytic.linkages import from_text, text_of
from tests.engines.closed_form import error_of, run_of

# What is taken of the double crank's links, and what of them each engine holds.
TAKEN = {
    "coupler": ("mass", "inertia"),
    "crank": ("mass", "inertia"),
    "follower's inertia": ("inertia",),
}
HELD = {
    "direct": {*TAKEN},
    "exudyn": {*TAKEN},
    "ondsel": {*TAKEN},
    "simbody": {"crank", "follower's inertia"},  # a mass off its pin has a moment about it
    "mujoco": set(),
    "pymunk": set(),
}
LIMIT = 3e-5  # of the peak: the coarsest engine's own error with all masses


def lightened(case):
    """The four-bar without the masses or inertias of one link."""
    link, keys = case.partition("'")[0], "|".join(TAKEN[case])
    head, mark, tail = text_of("double-crank").partition(f"[links.{link}]")
    own, bracket, rest = tail.partition("\n[")
    to = "inertia = 0" if TAKEN[case] == ("inertia",) else ""
    return from_text(head + mark + re.sub(rf"(?m)^({keys}) .*$", to, own) + bracket + rest)


@pytest.mark.parametrize("case", TAKEN)
@pytest.mark.parametrize("name", HELD)
def test_every_engine_holds_it_or_says_which_it_cannot(name, case):
    engine, linkage = engine_of(name), lightened(case)
    if engine.version() is None:
        pytest.skip(f"{name} is not installed")
    motion = crank_motion("run-up-quintic", ramp_time=0.12, hold_time=0.03)
    if case in HELD[name]:
        history = run_of(engine, linkage, motion, Setting.TUNED)
        torque = Truth(linkage, motion, history.torque.time).torque
        assert error_of(history.torque.values, torque) < LIMIT
        for joint, force in history.joint_force.items():
            assert error_of(force.values, Truth(linkage, motion, force.time).joint_forces[joint].T) < LIMIT
    else:
        run = engine.run(scene(linkage, Prescribed(motion), frozenset(Channel)), Setting.TUNED)
        assert run.outcome is Outcome.UNSUPPORTED
        assert f"'{case.partition(chr(39))[0]}'" in run.reason
