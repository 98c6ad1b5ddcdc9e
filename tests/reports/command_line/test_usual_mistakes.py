"""A designer's usual mistakes in a file: each is refused or warned of in a sentence with its place and its cure."""

import pytest

from tests.analytic.linkages import file_text
from tests.commands import linkproof

SOUND = file_text("crank-rocker-without-mistakes")
POINTS, ANGLES, UNITS = "points = { O2 = [0, 0], B = [45, 0] }", "angle = [0, 90, 180, 270]", 'angle = "deg" }'
SLIDER = 'points = { B = [0, 0] }\nslides = { point = "B", through = [0, 0] }'
TORQUE = '\n[[torques]]\nlink = "rocker"\ntorque = 500\n[[springs]]'

# The replaced text, its replacement, the place in the message (a line, or a name), and the cure.
REFUSED = {
    "comma in a point": ("O2 = [60, 0]", "O2 = [60,5, 0]", ":6: ground.O2", "write decimals with a dot"),
    "no comma in a point": ("O2 = [60, 0]", "O2 = [60 0]", ":6: ", "without a comma between them; write [x, y]"),
    "no comma in a table": ("A = [0, 0], B", "A = [0, 0] B", ":15: ", "entries without a comma between them"),
    "gear": ("[links.rocker]", "[gears.one]\nratio = 2\n[links.rocker]", ":20: gears", "'What linkproof cannot do'"),
    "comma in a number": ("mass = 0.15", "mass = 0,15", ":16: ", "write a dot, such as 0.3"),
    "point twice": ("B = [60, 0], P", "B = [60, 0], B = [6, 0], P", ":15: ", "'B' is written twice; leave one out"),
    "link twice": ("[links.rocker]", "[links.coupler]", ":20: ", "written twice; leave one out or rename it"),
    "key twice": ("mass = 0.15", "mass = 0.15\nmass = 3", ":17: ", "written twice; leave one out"),
    "key misspelt": ("centre = [30", "center = [30", ":17: links.coupler.center", "did you mean 'centre'?"),
    "link misspelt": ('crank = "crank"', 'crank = "krank"', ":3: crank", "did you mean 'crank'?"),
    "umlaut": ("[links.coupler]", "[links.Koppelstück]", ":14: ", 'put it in quotes: "Koppelstück"'),
    "no quotes": ('crank = "crank"', "crank = crank", ":3: ", 'write it as "word"'),
    "curved quotes": ('crank = "crank"', "crank = “crank”", ":3: ", 'not straight; write "'),
    "quote missing": ('"Crank-rocker"', '"Crank-rocker', ":1: ", 'close it with "'),
    "bracket of a table": ("[links.rocker]", "[links.rocker", ":20: ", "close it"),
    "bracket of a point": ("B = [45, 0]", "B = [45, 0", ":21: ", "close it"),
    "table in several lines": ("A = [0, 0], B", "A = [0, 0],\nB", ":15: ", "write it in one line"),
    "no =": ("mass = 0.15", "mass 0.15", ":16: ", "write key = value"),
    "colon": ("mass = 0.15", "mass: 0.15", ":16: ", "write key = value"),
    "unit behind a number": ("mass = 0.15", "mass = 0.15 kg", ":16: ", "units stand in [units]"),
    "comment of C": ("mass = 0.15", "mass = 0.15 // t", ":16: ", "a comment begins with #"),
    "capital": ("duration = 0.2", "back = True", ":40: ", "small letters"),
    "value missing": ("mass = 0.15", "mass =", ":16: ", "add the value or leave the key out"),
    "list for a number": ("mass = 0.15", "mass = [0.15]", ":16: links.coupler.mass", "got [0.15]; correct it"),
    "text for a number": ("mass = 0.15", 'mass = "0.15"', ":16: links.coupler.mass", "got '0.15'; correct it"),
    "number for a vector": ("[0, -9.81]", "-9.81", ":4: gravity", "expected the gravity vector [x, y]"),
    "mass negative": ("mass = 0.15", "mass = -0.15", ":16: links.coupler.mass", "of zero or more"),
    "inertia missing": ("inertia = 6e-5\n", "", ":14: links.coupler.inertia is missing", "add it"),
    "unit unknown": ('mass = "kg"', 'mass = "gram"', ":2: units.mass", "known are g, kg, lb, mg, slug, t"),
    "unit missing": (', angle = "deg"', "", ":2: units.angle is missing", "add it"),
    "two cranks": ('crank = "crank"', 'crank = ["crank", "rocker"]', ":3: crank", "the name of the link"),
    "ground missing": ("ground = {", "# ground = {", ":1: ground is missing", "add it"),
    "a table of pins": ("[sketch]", '[[pins]]\npoint = "B"\n[sketch]', "pins", "where points have one name"),
    "point missing": (", B = [45, 0] }", " }", "'B', 'P'", "add a joint to 'coupler', 'rocker'"),
    "pinned twice": (POINTS, POINTS.replace(" }", ", O1 = [60, 0] }"), "'rocker' of 'mine' is held", "leave one out"),
    "slider without direction": (POINTS, SLIDER, ":22: links.rocker.slides.along", "add it"),
    "output unknown": ('point = "P", along', 'point = "Q", along', ":5: output", "known are A, B, O1"),
    "turn closed": (ANGLES, "angle = [0, 90, 180, 360]", ":29: forces #1.angle", "leave out a last one that repeats"),
    "angles too few": (ANGLES, "angle = [0, 90, 180]", ":26: forces #1", "complete the shorter list"),
    "key of another regime": ("start_speed = 500", "speed = 500", ":39: regimes.start.speed", "leave it out"),
    "sketch without points": ("points = { B = [60, 45] }\n", "", "'B' or 'P'", "add it under [sketch.points]"),
    "rocker too short": ("B = [45, 0]", "B = [4.5, 0]", "'rocker' (4.5 mm)", "lengthen 'rocker'"),
}
WARNED = {
    "mass in g": ("mass = 0.15", "mass = 150", "'coupler' weighs 150 kg", "check the unit of mass"),
    "inertia in kg*mm^2": ("inertia = 6e-5", "inertia = 60", "inertia of 'coupler'", "(kg*mm^2 read as kg*m^2?)"),
    "mass missing": ("mass = 0.15\n", "", "'coupler' has a mass centre and no mass", "add links.coupler.mass"),
    "centre in µm": ("centre = [20, 0]", "centre = [20000, 0]", "mass centre of 'rocker'", "links.rocker.centre"),
    "ground in m": ("O2 = [60, 0]", "O2 = [0.06, 0]", "sketch.points.B", "correct it, or sketch.angle"),
    "gravity in mm/s^2": ("-9.81]", "-9810]", "gravity is 9810 m/s^2", "check its size"),
    "gravity upwards": ("-9.81]", "9.81]", "gravity points along +y", "write [0, -9.81]"),
    "spelling": ("A = [20, 0]", "A = [20, 0], p = [1, 1]", "points 'P' and 'p' are two", "a pin needs one spelling"),
    "free length missing": ("length = 50\n", "", "spring between P and O2", "add length if it has one"),
    "free length in m": ("length = 50\n", "length = 0.05\n", "spring between P and O2 is 0.05 mm", "check the unit"),
    "stiffness in N/m": (UNITS, 'angle = "deg", stiffness = "N/mm" }', "the spring between", "(N/m read as N/mm?)"),
    "force in N": (UNITS, 'angle = "deg", force = "kN" }', "the force at 'P' moves", "(N read as kN?)"),
    "torque in N*mm": ("\n[[springs]]", TORQUE, "the torque on 'rocker'", "(N*mm read as N*m?)"),
    "angles in rad": (ANGLES, "angle = [0, 1.57, 3.14, 4.71]", "no values between 4.71° and 360°", "check the unit"),
    "overshoot": (ANGLES, "angle = [0, 1, 180, 270]", "the force at 'P' goes beyond its values", "add values there"),
}


def reviewed(folder, old, new):
    """The review by ``check`` of the sound file with one part replaced."""
    assert SOUND.count(old) >= 1
    (folder / "mine.toml").write_text(SOUND.replace(old, new, 1), encoding="utf-8")
    return linkproof("check", "mine.toml", cwd=folder)


def test_the_sound_file_is_without_warnings(tmp_path):
    done = reviewed(tmp_path, "length = 50", "length = 0  # as written")
    assert (done.returncode, done.stderr) == (0, "")
    assert "warning" not in done.stdout


@pytest.mark.parametrize("mistake", REFUSED)
def test_it_is_refused(tmp_path, mistake):
    *change, place, cure = REFUSED[mistake]
    done = reviewed(tmp_path, *change)
    assert (done.returncode, done.stderr.count("\n")) == (2, 1), done.stdout
    assert place in done.stderr
    assert cure in done.stderr


@pytest.mark.parametrize("mistake", WARNED)
def test_it_is_warned_of(tmp_path, mistake):
    *change, place, cure = WARNED[mistake]
    done = reviewed(tmp_path, *change)
    warnings = " ".join(done.stdout.split()).split("warning: ")[1:]
    assert any(place in warning and cure in warning for warning in warnings), done.stdout + done.stderr


@pytest.mark.parametrize(
    "words",
    [
        "results",
        "sweep --vary rocker.mass=1:2:3 --quantity Mkr.peak",
        "optimise --minimise Mkr.peak --over rocker.mass=1:2",
        "tolerance tolerances.toml",
        "compare --engine direct --jobs 0 --regime constant-speed",
        pytest.param("bench --engine direct --quick --regime constant-speed", marks=pytest.mark.nightly),
    ],
)
def test_no_option_hides_its_warnings(tmp_path, words):
    (tmp_path / "mine.toml").write_text(SOUND.replace("mass = 0.15", "mass = 150"), encoding="utf-8")
    (tmp_path / "tolerances.toml").write_text('results = ["Mkr.peak"]\nspeed = 9\n[tolerances]\n"rocker.mass" = 0.1\n')
    command, *options = words.split()
    done = linkproof(command, "mine.toml", *options, "-q", cwd=tmp_path)
    assert done.stderr.count("warning: 'coupler' weighs 150 kg") == 1, done.stdout + done.stderr
