"""``linkproof optimise`` as a designer meets it: tables, files, and one sentence for every fault."""

import json

import pytest

from analytic.description.loading import load
from tests.commands import linkproof, refused

PEAK = ("rimoldi-164", "--minimise", "Mkr.peak")
ROD = ("--over", "rod.B.x=172:178")


def run(*words):
    done = linkproof("optimise", *words)
    assert done.returncode == 0, done.stderr
    return done


def saved(file):
    """The JSON in a file, with its numbers and figures by name."""
    document = json.loads(file.read_text(encoding="utf-8"))
    numbers, figures = ({row["name"]: row for row in document[part]} for part in ("numbers", "figures"))
    return document, numbers, figures


def test_tables_files_and_json_have_the_same_figures(tmp_path):
    best, results, curves = (tmp_path / f"best.{kind}" for kind in ("toml", "json", "svg"))
    words = (*PEAK, *ROD, "--over", "rocker.B.x=±10%", "--keep", "stroke", "--global")
    done = run(*words, *(word for file in (best, results, curves) for word in ("--save", file)))
    document, numbers, figures = saved(results)
    new = load(best)
    for link in ("rod", "rocker"):
        assert new.links[link].points["B"][0] == pytest.approx(numbers[f"{link}.B.x"]["after"], rel=1e-15)
    assert figures["stroke"]["after"] == pytest.approx(figures["stroke"]["before"], rel=1e-9)
    assert document["search"]["residual"] < 1e-6
    for text in (
        "least Mkr.peak; rimoldi-164 (as-built): constant-speed, 1000 rpm counter-clockwise",
        f"{figures['Mkr.peak']['after']:.6g}", "minimised",
        f"{100.0 * figures['Mkr.peak']['change']:+.2f} %", "kept at 30.98", "joint_force:O1.peak", "Jeq.mean",
        "transmission_angle:rocker + rod (RRR).min", "exact derivatives",
        f"Starts: {len(document['search']['ends'])}; ",
    ):  # fmt: skip
        assert text in done.stdout
    assert "Mkr" in curves.read_text(encoding="utf-8")
    assert f"linkproof compare {best}" in done.stderr
    repeated = json.loads(run(*document["command"].replace("'", "").split()[2:], "--json", "-q").stdout)
    assert repeated == document


def test_the_speed_may_be_varied_and_is_printed_since_no_file_has_it(tmp_path):
    best, results = tmp_path / "best.toml", tmp_path / "best.json"
    words = (*PEAK, "--no-gravity", "--clockwise", "--over", "speed=±20%")
    done = run(*words, "--save", best, "--save", results)
    assert saved(results)[2]["Mkr.peak"]["change"] == pytest.approx(0.8**2 - 1.0, rel=1e-9)  # at the lower bound
    assert "It is the best design at 800 rpm: a linkage file has no speed." in done.stdout
    assert f"linkproof compare {best} --speed 800 --clockwise --no-gravity" in done.stderr
    assert load(best).links == load("rimoldi-164").links


def test_a_number_that_a_kept_figure_determines_leaves_nothing_to_vary():
    done = run(*PEAK, *ROD, "--keep", "stroke")
    assert "Nothing is left to vary: stroke alone determines rod.B.x." in done.stdout
    assert "Optimality" not in done.stdout
    assert "improvement" not in done.stdout
    (row,) = (line for line in done.stdout.splitlines() if line.startswith("rod.B.x"))
    assert row.split()[-2:] == ["0.00", "%"]


def test_quiet_is_one_line_of_the_outcome():
    done = run(*PEAK, "--over", "rod.B.x=170:173", "-q")
    assert done.stdout.splitlines() == ["least Mkr.peak: from 0.270411 to 0.250060 N*m at rod.B.x 172.074 mm"]
    done = run("rimoldi-164", "--maximise", "stroke", "--over", "rod.B.x=174:175", "-q")
    assert done.stdout.startswith("largest stroke: from 30.9866 to 30.9866 mm at rod.B.x 175.000 mm")


def test_lengths_are_rounded_and_the_cost_is_printed(tmp_path):
    words = (*PEAK, *ROD, "--over", "rocker.B.x=20:23", "--over", "rod.mass=0.1:0.2", "--keep", "stroke")
    files = [tmp_path / name for name in ("exact.json", "round.json", "round.toml")]
    assert "Rounded" not in run(*words, "--save", files[0]).stdout
    done = run(*words, "--round", "0.1mm", "--save", files[1], "--save", files[2])
    new = load(files[2])
    for link in ("rod", "rocker"):
        tenths = 1e4 * new.links[link].points["B"][0]
        assert tenths == pytest.approx(round(tenths), abs=1e-9)
    exact, rounded = (saved(file)[2] for file in files[:2])
    cost = rounded["Mkr.peak"]["after"] / exact["Mkr.peak"]["after"] - 1.0
    missed = 1e3 * abs(rounded["stroke"]["after"] - exact["stroke"]["after"])
    costs = f"Rounded: lengths are multiples of 0.1mm, which costs {100.0 * cost:+.2f} % of the aim; it misses"
    assert costs in done.stdout
    assert f"stroke by {missed:#.4g} mm." in done.stdout


def test_a_mean_is_kept_by_a_mass_where_a_length_is_rounded():
    words = ("--over", "rod.mass=0.1:0.2", "--keep", "joint_force:A.mean", "--round", "1")
    assert "and the held figures stay within their ranges." in run(*PEAK, *ROD, *words).stdout


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        (PEAK, "expected numbers to vary, got none"),
        ((*PEAK, "--over", "speed=0:2"), "--over speed: expected bounds above 0, got '0:2'"),
        ((*PEAK, *ROD, *ROD), "got rod.B.x twice"),
        ((*PEAK, *ROD, "--maximise", "stroke"), "got both"),
        (("rimoldi-164", *ROD), "got neither"),
        ((*PEAK, *ROD, "--keep", "stroke=50:51"), "expected a design with stroke from 50 to 51 mm, got none within"),
        ((*PEAK, *ROD, "--keep", "Mkr.peak=0.1:0.2"), "; the nearest found has 0.25"),
        ((*PEAK, "--over", "rod.B.x=10:18"), "expected designs that can be assembled at every angle, got none"),
        (("rimoldi-164", "--minimise", "stroke", "--over", "rod.mass=0.1:0.2"), "which does not; choose others"),
        ((*PEAK, *ROD, "--round", "0"), "--round: expected a positive length, got '0'"),
        ((*PEAK, "--over", "rod.mass=0.1:0.2", "--round", "1"), "--round: expected a length among the numbers"),
    ],
)
def test_bad_input_is_one_sentence_before_anything_is_written(words, sentence, tmp_path):
    assert sentence in refused("optimise", *words, "--save", tmp_path / "best.toml")
    assert not (tmp_path / "best.toml").exists()
