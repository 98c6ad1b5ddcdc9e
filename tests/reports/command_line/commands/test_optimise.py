"""``linkproof optimise`` as a designer meets it: tables, files, and one sentence for every fault."""

import json

import pytest
from typer.testing import CliRunner

from analytic.description.loading import load
from analytic.errors import LinkproofError
from reports.command_line import designs_app
from reports.command_line.app import app

PEAK = ("rimoldi-164", "--minimise", "Mkr.peak")
ROD = ("--over", "rod.B.x=172:178")


def run(*words):
    assert designs_app.optimise
    return CliRunner().invoke(app, ["optimise", *words])


def test_tables_files_and_json_say_the_same(tmp_path):
    done = run(*PEAK, *ROD, "--over", "rocker.B.x=±10%", "--keep", "stroke", "--starts", "2", "--out", str(tmp_path))
    assert done.exit_code == 0, done.output
    saved = json.loads((tmp_path / "optimise.json").read_text(encoding="utf-8"))
    new = load(tmp_path / "rimoldi-164-optimised.toml")
    numbers = {one["name"]: one for one in saved["numbers"]}
    assert new.links["rod"].points["B"][0] == pytest.approx(numbers["rod.B.x"]["after"], rel=1e-15)
    assert new.links["rocker"].points["B"][0] == pytest.approx(numbers["rocker.B.x"]["after"], rel=1e-15)
    figures = {one["name"]: one for one in saved["figures"]}
    assert figures["stroke"]["after"] == pytest.approx(figures["stroke"]["before"], rel=1e-9)
    assert saved["search"]["residual"] < 1e-6
    assert len(saved["search"]["ends"]) == 2
    for words in (
        "least Mkr.peak; rimoldi-164 (as-built): constant-speed, 1000 rpm counter-clockwise",
        f"{figures['Mkr.peak']['after']:.6g}", "minimised",
        f"{100.0 * figures['Mkr.peak']['change']:+.2f} %", "kept at 30.98", "joint_force:O1.peak", "Jeq.mean",
        "transmission_angle:rocker + rod (RRR).min", "exact derivatives", "Starts: 2; 2 ended at this optimum.",
    ):  # fmt: skip
        assert words in done.output
    assert "Mkr" in (tmp_path / "before-after.svg").read_text(encoding="utf-8")
    assert f"linkproof compare {tmp_path / 'rimoldi-164-optimised.toml'}" in done.output
    again = json.loads(run(*saved["command"].replace("'", "").split()[2:], "--json", "-", "-q").stdout)
    assert again == saved


def test_the_speed_may_be_varied_and_is_said_since_no_file_holds_it(tmp_path):
    words = (
        *PEAK,
        "--no-gravity",
        "--clockwise",
        "--over",
        "speed=±20%",
        "--simulate",
        "direct",
        "--out",
        str(tmp_path),
    )
    done = run(*words)
    assert done.exit_code == 0, done.output
    figures = {one["name"]: one for one in json.loads((tmp_path / "optimise.json").read_text("utf-8"))["figures"]}
    assert figures["Mkr.peak"]["change"] == pytest.approx(0.8**2 - 1.0, rel=1e-9)  # at the lower bound
    assert "It is the best design at 800 rpm: a linkage file has no speed." in done.output
    assert "800 rpm clockwise" in done.output  # the motion of the engine
    assert load(tmp_path / "rimoldi-164-optimised.toml").links == load("rimoldi-164").links
    assert "--speed 800 --clockwise --no-gravity" in run(*words[:-4]).stderr


def test_bounds_and_values_out_of_them_are_said():
    done = run(*PEAK, "--over", "rod.B.x=176:17.8cm", "--speed", "-500")
    assert "500 rpm clockwise" in done.output
    assert "the file's value is out of the bounds" in done.output


def test_a_number_that_a_kept_figure_fixes_leaves_nothing_to_vary():
    done = run(*PEAK, *ROD, "--keep", "stroke")
    assert "Nothing is left to vary" in done.output
    assert "Optimality" not in done.output
    (row,) = (line for line in done.output.splitlines() if line.startswith("rod.B.x"))
    assert row.split()[-2:] == ["0.00", "%"]


def test_quiet_is_one_line_of_the_outcome():
    done = run(*PEAK, "--over", "rod.B.x=170:173", "-q")
    assert done.stdout.splitlines() == ["least Mkr.peak: from 0.270411 to 0.250060 N*m at rod.B.x 172.074 mm"]
    assert run("rimoldi-164", "--maximise", "stroke", "--over", "rod.B.x=174:175", "-q").stdout.startswith(
        "largest stroke: from 30.9866 to 30.9866 mm at rod.B.x 175.000 mm"
    )


def test_lengths_are_rounded_and_the_cost_is_said(tmp_path):
    words = (*PEAK, *ROD, "--over", "rocker.B.x=20:23", "--over", "rod.mass=0.1:0.2", "--keep", "stroke")
    exact = run(*words, "--out", str(tmp_path / "exact"))
    done = run(*words, "--round", "0.1mm", "--out", str(tmp_path / "round"))
    assert done.exit_code == 0, done.output
    new = load(tmp_path / "round" / "rimoldi-164-optimised.toml")
    for link in ("rod", "rocker"):
        tenths = 1e4 * new.links[link].points["B"][0]
        assert tenths == pytest.approx(round(tenths), abs=1e-9)
    before, after = (
        {one["name"]: one for one in json.loads((tmp_path / name / "optimise.json").read_text("utf-8"))["figures"]}
        for name in ("exact", "round")
    )
    cost = after["Mkr.peak"]["after"] / before["Mkr.peak"]["after"] - 1.0
    missed = 1e3 * abs(after["stroke"]["after"] - before["stroke"]["after"])
    assert "Rounded" not in exact.output
    costs = f"Rounded: lengths are multiples of 0.1mm, which costs {100.0 * cost:+.2f} % of the aim; it misses"
    assert costs in done.output
    assert f"stroke by {missed:#.4g} mm." in done.output


def test_a_kept_mean_is_kept_by_a_mass_where_a_length_is_rounded():
    words = ("--over", "rod.B.x=172:178", "--over", "rod.mass=0.1:0.2", "--keep", "joint_force:A.mean", "--round", "1")
    done = run(*PEAK, *words)
    assert "and the held figures stay within their ranges." in done.output


def test_nothing_left_to_vary_is_said():
    done = run(*PEAK, *ROD, "--keep", "stroke")
    assert "Nothing is left to vary: stroke alone determines rod.B.x." in done.output
    assert "Optimality" not in done.output
    assert "improvement" not in done.output


def test_an_engine_says_what_it_thinks_of_the_new_design():
    done = run(*PEAK, *ROD, "--simulate", "direct", "--json", "-")
    assert done.exit_code == 0, done.output
    assert "rimoldi-164-optimised" in done.stderr
    assert "passed" in done.stderr
    assert json.loads(done.stdout)["command"].endswith("--simulate direct")


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        (PEAK, "expected numbers to vary, got none"),
        ((*PEAK, "--over", "rod.B.z=1:2"), "did you mean 'rod.B.y'"),
        ((*PEAK, "--over", "speed=0:2"), "--over speed: expected bounds above 0, got '0:2'"),
        ((*PEAK, "--over", "rod.B.x"), "expected NAME=LOW:HIGH or NAME=±10%, got 'rod.B.x'"),
        ((*PEAK, "--over", "rod.B.x=170"), "expected LOW:HIGH or ±10%, got '170'"),
        ((*PEAK, "--over", "rod.B.x=180:170"), "expected LOW below HIGH, got '180:170'"),
        ((*PEAK, "--over", "rod.B.y=±10%"), "rod.B.y is 0"),
        ((*PEAK, "--over", "rod.B.x=nan:180"), "expected a finite number of mm, got 'nan'"),
        ((*PEAK, "--over", "rod.B.x=170:180kg"), "unknown length unit 'kg'"),
        ((*PEAK, "--over", "rod.mass=-1:1"), "expected bounds that are not negative"),
        ((*PEAK, *ROD, *ROD), "got rod.B.x twice"),
        ((*PEAK, *ROD, "--maximise", "stroke"), "got both"),
        (("rimoldi-164", *ROD), "got neither"),
        ((*PEAK, *ROD, "--keep", "strok"), "did you mean 'stroke'"),
        ((*PEAK, *ROD, "--keep", "stroke=31:30"), "expected LOW:HIGH, LOW:, :HIGH or a value, got '31:30'"),
        ((*PEAK, *ROD, "--keep", "stroke="), "expected LOW:HIGH, LOW:, :HIGH or a value, got ''"),
        ((*PEAK, *ROD, "--keep", "stroke=wide"), "expected finite numbers of mm, got 'wide'"),
        ((*PEAK, *ROD, "--keep", "transmission_angle.max"), "expected .min, the least transmission angle"),
        ((*PEAK, *ROD, "--keep", "stroke=50:51"), "expected a design with stroke from 50 to 51 mm, got none within"),
        ((*PEAK, *ROD, "--keep", "stroke=50"), "expected a design with stroke of 50 mm, got none within"),
        ((*PEAK, *ROD, "--keep", "Mkr.peak=0.1:0.2"), "; the nearest found has 0.25"),
        ((*PEAK, *ROD, "--angles", "99999999999"), "--angles: expected 1000000 crank angles or fewer"),
        ((*PEAK, "--over", "rod.B.x=10:18"), "expected designs that can be assembled at every angle, got none"),
        ((*PEAK, *ROD, "--starts", "0"), "--starts: expected 1 or more designs, got 0"),
        ((*PEAK, *ROD, "--seed", "-1"), "--seed: expected a number that is not negative"),
        ((*PEAK, *ROD, "--starts", "3", "--global"), "leave one out"),
        ((*PEAK, *ROD, "--speed", "0"), "expected a finite number of rpm other than 0"),
        ((*PEAK, *ROD, "--speed", "-5", "--clockwise"), "turns clockwise already"),
        ((*PEAK, *ROD, "--simulate", "exudym"), "did you mean 'exudyn'"),
        (("rimoldi-164", "--minimise", "stroke", "--over", "rod.mass=0.1:0.2"), "which does not; choose others"),
        (("rimoldi-164", "--minimise", "joint_force.mean", *ROD), "expected one figure, got joint_force.mean"),
        (("rimoldi-164", "--minimise", "Mkr.pek", *ROD), "did you mean 'Mkr.peak'"),
        (("rimoldi-164", "--minimise", "torque", *ROD), "unknown figure 'torque': did you mean 'Mkr.peak'? a figure"),
        ((*PEAK, *ROD, "--round", "0"), "--round: expected a positive length, got '0'"),
        ((*PEAK, *ROD, "--round", "wide"), "--round: expected a finite number of mm, got 'wide'"),
        ((*PEAK, *ROD, "--round", "10"), "--round: expected designs at multiples of 10 mm beside rod.B.x"),
        ((*PEAK, "--over", "rod.mass=0.1:0.2", "--round", "1"), "--round: expected a length among the numbers"),
    ],
)
def test_bad_input_is_one_sentence_before_anything_is_written(words, sentence, tmp_path):
    done = run(*words, "--out", str(tmp_path / "out"))
    assert isinstance(done.exception, LinkproofError)
    assert sentence in str(done.exception)
    assert "\n" not in str(done.exception)
    assert not (tmp_path / "out").exists()
