"""What Ondsel alone has: a folder for the files of each solution, and slots that it gets wrong by itself."""

import os
from pathlib import Path

import numpy as np
import pytest

from analytic.description.crank_motion import crank_motion
from engines.contract import Setting
from engines.ondsel_adapter import OndselEngine
from tests.analytic.linkages import file_text, from_text, mechanism
from tests.engines.closed_form import error_of, run_of

pytest.importorskip("pyondsel")

ENGINE = OndselEngine()
# The crank is a bar with a slot through its pivot; the slot pushes a block along y = 0.1 m.
PUSHED_BLOCK = file_text("block-pushed-by-a-slot")


def test_every_solution_has_a_folder_of_its_own_for_files_of_fixed_names(monkeypatch):
    from engines import ondsel_loop  # noqa: PLC0415 - it imports pyondsel

    before, seen = os.environ.get("TMPDIR"), []
    solve = ondsel_loop.solve_asmt

    def solved(*args, **options):
        seen.append(os.environ["TMPDIR"])
        assert Path(seen[-1]).is_dir()
        return solve(*args, **options)

    monkeypatch.setattr(ondsel_loop, "solve_asmt", solved)
    run_of(ENGINE, mechanism("juki-mf7923d"), crank_motion("run-up", ramp_time=0.02, hold_time=0.01), Setting.TUNED)
    assert len(set(seen)) == len(seen) > 1
    assert os.environ.get("TMPDIR") == before
    assert not any(map(os.path.exists, seen))


def test_the_accelerations_of_a_slot_that_turns_are_wrong_by_a_known_formula_and_right_in_tuned():
    height, speed = 0.1, 5.0
    linkage = from_text(PUSHED_BLOCK)
    motion = crank_motion("constant-speed", speed=speed, ramp_time=0.3, hold_time=0.0, start_angle=0.6)
    shown = {
        setting: run_of(ENGINE, linkage, motion, setting).acceleration for setting in (Setting.NAIVE, Setting.TUNED)
    }
    angle = motion.angle(shown[Setting.NAIVE].time)
    sine, cosine = np.sin(angle), np.cos(angle)
    true = 2.0 * height * speed**2 * cosine / sine**3  # of x = height / tan(angle)
    # The pin is height / sine along the slot; an error across the slot moves the block 1 / sine times as far.
    slip = 0.5 * sine * (sine - cosine) * speed**2 * (height / sine) / sine
    block = list(linkage.linkage.links).index("block")
    assert error_of(shown[Setting.TUNED].values[:, block, 0], true) < 1e-11
    assert error_of(shown[Setting.NAIVE].values[:, block, 0] - true, slip) < 1e-9
    assert np.abs(slip).max() > 0.05 * np.abs(true).max()
