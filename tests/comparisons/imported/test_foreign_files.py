"""Exports of an independent program, each with one ordinary fault: the fault is the headline, and its cure is offered.

The curves in ``foreign`` come from a solution in absolute coordinates that shares nothing with the closed form.
"""

from functools import cache
from pathlib import Path

import pytest

from analytic.description.loading import load
from comparisons.faults.fault import Correction
from comparisons.imported.judge import judge
from comparisons.imported.reading import read_results

FOLDER = Path(__file__).with_name("foreign")
RADIAN = 57.29577951308232
DEGREES_PER_SECOND = {"omega": Correction(factor=1 / RADIAN)}
# File: words of the likeliest cause, how many others fit as well, and what the mapping may agree to; a second file of
# the same kind is judged by night.
NAMED = {
    "w_degs_only": ("'Angular Velocity crank (rad/s)' is in deg/s, not in rad/s", 0, DEGREES_PER_SECOND),
    "w_rpm_only": ("'crank.w' is in rpm, not in rad/s", 0, {"omega": Correction(factor=6 / RADIAN)}),
    "mo_degs": ("'crank.w' is in deg/s, not in rad/s", 0, DEGREES_PER_SECOND),
    "phi_deg_as_rad": ("'Crank angle (rad)' is in deg, not in rad", 0, {"phi": Correction(factor=1 / RADIAN)}),
    "phi_rad_as_deg": ("'Crank angle (deg)' is in rad, not in deg", 0, {"phi": Correction(factor=RADIAN)}),
    "l4_49": ("x of 'B' on 'rocker' is 49 mm in place of 50 mm", 0, {}),
    "g8": ("x of 'A' on 'crank' is -25.78 mm in place of -25.28 mm", 0, {}),
    "r_26": ("x of 'A' on 'crank' is 26 mm in place of 25 mm", 0, {}),
    "de_piston066": ("the mass of 'piston' is 0.66 kg in place of 0.6 kg", 0, {}),
    "sw_unitlie": ("Mkr is 1000 times the closed form's: a unit taken", 1, {"Mkr": Correction(factor=1e-3)}),
    "de_nm_lie": ("Mkr is 0.001 times the closed form's: a unit taken", 1, {"Mkr": Correction(factor=1e3)}),
    "cw_bothflip": (
        "the motor's axis points the other way", 0, {"phi": Correction(sign=-1), "Mkr": Correction(sign=-1)}
    ),
    "sw_first0": ("Mkr is off in a single sample, at 0 s", 0, {}),
    "de_many": ("S counts the other way, from +64.35 mm", 0, {"S": Correction(sign=-1, offset=0.064347)}),
    "s_bdc": ("S counts the other way, from +64.35 mm", 0, {"S": Correction(sign=-1, offset=0.064347)}),
    "sw_forces": ("joint_force:B:x has the other sign", 0, {"joint_force:B:x": Correction(sign=-1)})
}  # fmt: skip


NIGHTLY = ("w_rpm_only", "mo_degs", "de_piston066", "phi_deg_as_rad", "g8", "r_26", "de_nm_lie", "de_many")


@cache
def judged(name):
    own = FOLDER / f"{name}.toml"
    usual = FOLDER / f"{'slider-crank' if name.startswith(('de_', 's_b')) else 'four-bar'}.toml"
    model = load(str(own if own.exists() else usual))
    return judge(model, read_results([FOLDER / f"{name}.csv"], model))


@pytest.mark.parametrize(
    "name", [pytest.param(name, marks=pytest.mark.nightly if name in NIGHTLY else ()) for name in NAMED]
)
def test_an_ordinary_fault_is_named_with_its_cure(name):
    words, others, cure = NAMED[name]
    judgement = judged(name)
    (finding,) = judgement.explanation.findings
    assert words in finding.likeliest.words
    assert (len(finding.others), judgement.explanation.unexplained) == (others, ())
    assert judgement.proposals.keys() == cure.keys()
    for signal, correction in judgement.proposals.items():
        assert vars(correction) == pytest.approx(vars(cure[signal]), rel=1e-4, abs=1e-6)


def test_at_a_jump_the_side_that_was_judged_is_shown():
    verdict = next(v for v in judged("sw_forces").verdicts if v.name == "joint_force:O1:y")
    assert verdict.truth_there == pytest.approx(verdict.value_there, rel=1e-5)
    assert judged("s_bdc").verdicts[-1].shown == ("mm", 1e-3)


def test_what_a_cause_leaves_is_a_share_of_the_peak_that_it_makes():
    """The file has five digits, whatever its unit."""
    (finding,) = judged("sw_unitlie").explanation.findings
    assert 1e-6 < finding.left < 1e-5
