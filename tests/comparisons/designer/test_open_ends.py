"""Extremes at an end of a motion beside a dead position are marked, and a sentence says how to keep away from it."""

import json
import re
from itertools import chain
from pathlib import Path

import numpy as np
import pytest

from analytic.description.loading import catalogue, load, parse
from analytic.errors import DescriptionError
from analytic.kinematics.mechanism import Mechanism
from comparisons.designer.building import range_motion, sheet
from comparisons.motion.case import Case
from tests.commands import linkproof

DESIGNER = Path(__file__).parents[2] / "linkages" / "designer"
FILES = [*catalogue(), *map(str, sorted(DESIGNER.glob("*.toml")))]
OPEN = [(name, variant) for name in FILES for variant in load(name).variants
        if not Mechanism(load(name, variant)).crank_range().is_full_turn]  # fmt: skip
MARK = re.compile(r"\d\*\s")
SUGGESTED = re.compile(r"--from (\S+) --to (\S+) keeps")


def of_command(*words):
    done = linkproof(*words, "--json")
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)


@pytest.mark.parametrize(
    ("name", "variant", "backwards"), [*((*one, False) for one in OPEN), (str(DESIGNER / "e11.toml"), "base", True)]
)
def test_no_extreme_at_an_open_end_is_unmarked(name, variant, backwards):
    """Of the motion over a range less 2 %: where the greatest value of a signal is its first or its last."""
    mechanism = Mechanism(load(name, variant))
    found = sheet(Case(mechanism, range_motion(mechanism.crank_range(), backwards=backwards)))
    assert found.open_end_warning
    for signal, peak in found.peaks.items():
        if signal in ("phi", "omega", "epsilon"):
            continue
        values = np.abs(found.values[signal])
        sign = -1.0 if signal.startswith("transmission_angle") else 1.0
        assert peak.at_open_end == bool(np.max(sign * values) in sign * values[[0, -1]] and np.ptp(values)), signal
    peaks = [row for table in ("forces", "moment", "transmission") for row in found.figures[table] if row.unit != "rad"]
    assert all(row.at_open_end == found.peaks[row.signal].at_open_end for row in peaks)


@pytest.mark.parametrize(
    ("name", "limits", "peak", "inside"),
    [
        ("e11", ["11.7159°", "145.168°"], 1364.0, 60.0),
        pytest.param("bucket", ["508.6 mm", "1409 mm"], 2.556e6, 61e3, marks=pytest.mark.nightly),
    ],
)
def test_the_sentence_names_the_limits_and_a_part_whose_extremes_count(name, limits, peak, inside):
    file = DESIGNER / f"{name}.toml"
    whole = of_command("results", file)
    assert abs(whole["peaks"]["Mkr"]["value"]) == pytest.approx(peak, rel=1e-3)
    assert whole["peaks"]["Mkr"]["at_open_end"] is True
    [text] = [text for text in whole["warnings"] if "without bound" in text]
    assert all(limit in text for limit in limits)
    first, last = SUGGESTED.search(text).groups()
    part = of_command("results", file, "--from", first, "--to", last)
    assert not any("without bound" in text for text in part["warnings"])
    assert not any(one["at_open_end"] for one in [*part["peaks"].values(), *chain(*part["figures"].values())])
    assert all(
        np.degrees(one["value"]) >= 40.0
        for signal, one in part["peaks"].items()
        if signal.startswith("transmission_angle")
    )
    assert abs(part["peaks"]["Mkr"]["value"]) < 2.0 * inside


def test_tables_mark_extremes_at_open_ends_alone():
    file = DESIGNER / "e11.toml"
    assert MARK.search(linkproof("results", file).stdout)
    assert not MARK.search(linkproof("results", file, "--from", "40", "--to", "127").stdout)


def test_a_crank_that_turns_fully_and_a_motion_clear_of_the_limits_have_no_open_ends():
    mechanism = Mechanism(load("juki-mf7923d"))
    assert not sheet(Case(mechanism, range_motion(mechanism.crank_range()))).open_end_warning


def test_sweep_optimise_and_tolerance_say_it(tmp_path):
    file, range_ = DESIGNER / "e11.toml", "coupler.mass=0.1:0.2"
    tolerances = tmp_path / "tolerances.toml"
    tolerances.write_text('results = ["Mkr.peak"]\n[tolerances]\n"coupler.mass" = 0.001\n', encoding="utf-8")
    for words in (
        ("sweep", file, "--vary", f"{range_}:3", "--quantity", "Mkr.peak"),
        ("optimise", file, "--over", range_, "--minimise", "Mkr.peak"),
        ("tolerance", file, tolerances, "--samples", "10"),
    ):
        [text] = of_command(*words)["warnings"]
        assert re.match(r"Mkr\.peak.* at an open end of the motion: .*--from 40 --to 127", text)
        assert text in linkproof(*words).stderr
        inside = of_command(*words, "--from", "40", "--to", "120")
        assert inside["warnings"] == []


BOUNDED = (
    DESIGNER.joinpath("bucket.toml")
    .read_text(encoding="utf-8")
    .replace('"idler"] }', '"idler"], min = 600, max = 1100 }')
)


def test_a_cylinder_moves_to_its_very_ends_and_no_farther(tmp_path):
    file = tmp_path / "bucket.toml"
    file.write_text(BOUNDED, encoding="utf-8")
    mechanism = Mechanism(load(file))
    reach = mechanism.crank_range()
    motion = range_motion(reach)
    assert (motion.angle(0.0), motion.angle(motion.duration)) == pytest.approx((0.6, 1.1), rel=1e-15)
    assert not sheet(Case(mechanism, motion)).open_end_warning
    assert (reach.low.sentence, reach.high.sentence) == ("the cylinder is retracted", "the cylinder is extended")
    done = linkproof("results", file, "--from", "550", "--to", "1000")
    assert done.returncode == 2
    assert "its drive reaches 600 mm to 1100 mm (at 600 mm the cylinder is retracted)" in done.stderr


@pytest.mark.parametrize(
    ("old", "new"), [("max = 1100", "max = 500"), ("max = 1100", "max = 940"), ("min = 600", "min = 960")]
)
def test_a_cylinder_drawn_beyond_its_ends_is_refused(old, new):
    with pytest.raises(
        DescriptionError, match=r"expected a length between min and max in the sketch, got min \d+, max"
    ):
        parse(BOUNDED.replace(old, new), "bucket", "bucket.toml")
