"""Bodies without mass or inertia: every engine is right with them or says in one sentence which it cannot hold."""

import re

import pytest

from analytic.description.crank_motion import crank_motion
from engines.contract import Outcome, Setting
from tests.analytic.linkages import from_text, text_of
from tests.engines.closed_form import driven, errors_of, installed, run_of

# Numbers that are removed from the double crank's links, and the cases that each engine supports.
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
    "dart": set(),
    "mujoco": set(),
    "pinocchio": set(),
    "pybullet": set(),
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
    engine, linkage = installed(name), lightened(case)
    motion = crank_motion("run-up-quintic", ramp_time=0.06, hold_time=0.02)
    if case in HELD[name]:
        history = run_of(engine, linkage, motion, Setting.TUNED)
        assert max(errors_of(history, linkage, motion).values()) < LIMIT
    else:
        run = engine.run(driven(linkage, motion), Setting.TUNED)
        assert run.outcome is Outcome.UNSUPPORTED
        assert f"'{case.partition(chr(39))[0]}'" in run.reason
