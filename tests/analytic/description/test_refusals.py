"""Linkage files with a fault: one sentence with the file, the line, the key, what is expected, and what is there."""

import re

import pytest
from hypothesis import given, settings

from analytic.description.loading import load, parse
from analytic.dynamics import reduced
from analytic.errors import LinkproofError, UnknownNameError
from analytic.kinematics.dead_centres import stroke
from analytic.kinematics.error_bounds import relative_bounds
from analytic.kinematics.mechanism import Mechanism
from tests.analytic.linkages import JUKI, MADE_UP, file_text, message_of, text_of
from tests.analytic.mutations import mutated_files

MASS = "links.crank.mass: expected a finite mass of zero or more in the file's mass unit, got"
POINT = "expected a point as [x, y] or { radius, angle }, finite numbers, got"
SIZE = "expected a magnitude between 1e-60 and 1e+60 in SI units, got"
PRINTED = "[variants.as-printed.links.coupler]"

# A part of the file, what replaces it, and a part of the message.
REPLACED = [
    ("mass    = 0.64", "mass = -1.5", f"sample.toml:20: {MASS} -1.5; correct it"),
    ("mass    = 0.64", "mass = nan", f"{MASS} nan; correct it"),
    ("mass    = 0.64", 'mass = "0.64"', f"{MASS} '0.64'; correct it"),
    ("mass    = 0.64", "mass = true", f"{MASS} true; correct it"),
    ("mass    = 0.64", f"mass = 1{'0' * 400}", f"{MASS} 1{'0' * 59}...; correct it"),
    ("mass    = 0.64", f"mass = {'1' * 5000}", "sample.toml:20: "),
    ("mass    = 0.64", f"mass = {'1_' * 4999}1", "sample.toml:20: "),
    ("mass    = 0.64", f"mass = 0x{'f' * 5000}", "sample.toml:20: "),
    ("mass    = 0.64", "mass = 1e300", f"{SIZE} 1e+300 kg"),
    ("mass    = 0.64", "mass    = -", "sample.toml:20: not valid TOML: Invalid value in column 11; correct it"),
    ("inertia = 0.64e-4", "", "links.crank.inertia is missing: expected a finite moment of inertia"),
    ("inertia = 0.64e-4", "inertai = 0.64e-4", "unknown key 'inertai': did you mean 'inertia'? known are"),
    ("inertia = 0.64e-4", "x" * 50_000 + " = 1", "unknown key"),
    ("[sketch]", "[repeat.part]\ncount = 3\n[sketch]", "repeat: unknown key 'repeat': equal parts stand in the file"),
    (
        "[sketch]",
        "[thread]\nstops = [{ eye = 'A' }, { eye = 'D' }]\nrequired = [[0, 1, 2]]\n[sketch]",
        "thread.required #1: expected pairs of a crank angle",
    ),
    ("gravity = ", "gravty = ", "unknown key 'gravty': did you mean 'gravity'?"),
    ("gravity = [0, -9.81]", "gravity = [0, 1e99]", "gravity: expected a magnitude between 1e-60 and"),
    (
        "A = [15.5, 0]",
        "A = { radius = 1e99, angle = 3 }",
        f"sample.toml:19: links.crank.points.A.radius: {SIZE} 1e+99 mm",
    ),
    ("A = [15.5, 0]", "A = { radius = 3, angle = 1e99 }", f"links.crank.points.A.angle: {SIZE} 1e+99 deg"),
    ("A = [15.5, 0]", "A = [0, 1e-15]", "links.crank.points: expected a positive length between 'A' and 'O1'"),
    ("A = [15.5, 0]", "A = { radius = -3, angle = 0 }", "A.radius: expected a positive finite length in"),
    ("A = [15.5, 0]", "A = { radus = 3, angle = 0 }", "unknown key 'radus': did you mean 'radius'?"),
    ("A = [15.5, 0]", "A = { radius = 3 }", "A.angle is missing: expected a finite angle in the file's"),
    ("A = [15.5, 0]", "A = [15.5, 0, 1]", f"links.crank.points.A: {POINT} [15.5, 0, 1]"),
    ("A = [15.5, 0]", "A = [nan, 0]", f"links.crank.points.A #1: {POINT} nan"),
    ('crank   = "crank"', 'crank = "krank"', "crank: unknown link 'krank': did you mean 'crank'?"),
    ('crank   = "crank"\n', "", "crank is missing: expected the name of the link that is the crank"),
    ('length = "mm"', 'length = "MM"', "units.length: unknown length unit 'MM': did you mean 'mm'?"),
    ('length = "mm", ', "", "units.length is missing: expected the name of a unit of length in quotes: m,"),
    ("points = { D = [0", "points = { E = [0", "sketch.points: unknown point 'E': known are"),
    ('point = "D", along = [0, 1] }\nn', 'point = "d" }\nn', "output: unknown moving point 'd'"),
    ("along = [0, 1] }\nmass", "along = [0, 0] }\nmass", "expected a direction [x, y], got [0, 0]"),
    ("through = [0, 0], ", "", "links.needle_bar.slides.through is missing: expected a point of"),
    ("through = [0, 0]", 'on = "x", through = [0, 0]', "links.needle_bar.slides.on: unknown link 'x'"),
    ("through = [0, 0]", 'on = "needle_bar", through = [0, 0]', "got a circle of needle_bar on needle_bar; let"),
    ("[links.coupler]", "[links.ground]\nmass = 1\n[links.coupler]", "links.ground: expected only"),
    ("[links.coupler]", r'[links."a\nb"]', r"sample.toml:24: links.a\nb: expected no control characters, got 'a\nb'"),
    ('title   = "', 'title = 3 # "', "title: expected a title in quotes, got 3"),
    ('"Juki', r'"\u001b[2JJuki', r"sample.toml:3: title: expected no control characters, got '\x1b[2JJuki"),
    ('"Juki', r'"\u202eikuJ', r"expected no control characters, got '\u202eikuJ"),
    ("crank   =", "format = 2\ncrank =", "format: expected the number 1, the only format so far, got 2"),
    (PRINTED, "[[variants]]", "variants: expected tables [variants.NAME]"),
    ("variants.as-printed", "variants.as-built", "variants.as-built: expected another name than"),
    (JUKI[JUKI.index("[links.crank]") :], "", "links is missing: expected a table [links.NAME] for every"),
    (JUKI, " \n\t\n", "expected a linkage description, got an empty file"),
    (JUKI, "# a title\n", "title is missing: expected a title in quotes"),
    (JUKI, "a = " + "[" * 3000 + "]" * 3000, "expected tables and short lists, got very deep nesting"),
]

FORCE = '[[forces]]\npoint = "D"\nlink = "coupler"\nforce = '
SPRING = '[[springs]]\nbetween = ["A", "O1"]\nlinks = ["coupler", "ground"]\nstiffness = 3\n'
SLOT = '[[slots]]\npoint = "D"\non = "crank"\nthrough = [0, 0]\nalong = [1, 0]\n'
DAMPER = "[[dampers]]\ncoefficient = 3\nbetween = "
MINE = "[regimes.mine]\n"
REST = "start_angle = 1\nduration = 1\n"
TABLE = "time = [0, 1, 2, 3, 4]\nangle = "

# What is added at the end of the file, and a part of the message.
ADDED = [
    (".".join(f"k{number}" for number in range(4_000)) + " = 1", "got very deep nesting"),
    # Loads.
    (FORCE.replace('link = "coupler"\n', "") + "[1, 2]", "forces #1: expected one link to take the load, got"),
    (FORCE.replace("coupler", "crank") + "[1, 2]", "forces #1: expected a body that carries 'D' (coupler, needle"),
    (FORCE.replace('"D"', '"E"') + "[1, 2]", "forces #1: unknown point 'E'"),
    (FORCE + "[[1, 2], [3, 4]]", "got 2 values and no angles; add angle"),
    (FORCE + '[1, 2]\n[[forces]]\npoint = "D"\nforce = [1, "2"]', "forces #2.force #2: expected [x, y], or a list"),
    (FORCE + "[[1, 2], [3, 4]]\nangle = [0, 9]", "at least 3 of each, got 2 values and 2 angles"),
    (FORCE + "[[1, 2], [3, 4], [5, 6]]\nangle = [0, 90, 80]", "forces #1.angle: expected increasing angles that span"),
    (FORCE + "[[1, 2], [3, 4], [1, 2]]\nangle = [0, 90, 360]", "and leave out a last one that repeats the first"),
    (FORCE + '[1, 2]\ninterpolation = "linear"', "forces #1.interpolation: expected a list of values over angle"),
    (FORCE + '[1, 2]\ninterpolation = "cubic"', "forces #1.interpolation: expected 'spline' or 'linear'"),
    ('[[torques]]\nlink = "cranck"\ntorque = 3', "torques #1: unknown link 'cranck': did you mean"),
    (SPRING.replace('"ground"', '"coupler"').replace("O1", "D"), "got both on 'coupler', where nothing"),
    (SPRING.replace("= 3", "= -3"), "springs #1.stiffness: expected a finite stiffness of zero or more, got -3"),
    (DAMPER + '["crank", "crank"]', "got 'crank' twice; correct one"),
    (DAMPER + '["a", "b", "c"]', "expected a pair of names [one, two]"),
    # Slots.
    (SLOT.replace('"D"', '"A"'), "slots #1: expected a pin that another body carries, got 'A' of"),
    (SLOT + SLOT, "slots #2: expected one slot for 'D in crank', got a second one; leave it out"),
    # Regimes.
    ("[regimes.cycloidal]\nfrom = 1\nto = 2\ntime = 1", "a name of its own"),
    (MINE + "from = 20", "regimes.mine.to is missing: expected the angle at which the swing ends; add it"),
    (MINE + "from = 20\nto = 20\ntime = 1", "the same twice"),
    (MINE + "from = 20\nto = 30", "either a speed or a time"),
    (MINE + "from = 20\nto = 30\ntime = 1\ntorque = 2", "regimes.mine.torque: expected the keys of a swing, "),
    (MINE + 'from = 20\nto = 30\ntime = 1\nlaw = "sine"', "unknown law 'sine'"),
    (MINE + "from = 20\nto = 30\ntime = 1\nback = true", "regimes.mine: expected a speed without a jump"),
    (MINE + "from = 20\nto = 30\ntime = 1\nbacck = true", "did you mean 'back'"),
    (MINE + "from = 1e99\nto = 30\ntime = 1", "regimes.mine.from: expected a magnitude between"),
    (MINE + "from = 20\nto = 30\nspeed = -5", "expected a positive finite speed in rpm, got -5"),
    (MINE + "segments = [{ to = 20, time = 1 }, { dwell = 1 }]", " rpm before and 0 rpm after 1 s"),
    (MINE + "segments = [{ to = 20 }]", "segments #1: expected either a speed or a time"),
    (MINE + "segments = [{ dwell = 1, to = 3 }]", "either an angle to go to or a dwell"),
    (MINE + "segments = [{ dwell = 1, time = 3 }]", "expected a dwell alone, got time"),
    (MINE + "segments = []", "one segment or more"),
    (MINE + "time = [0, 1, 2]\nangle = [0, 1, 2]", "4 or more of each, got 3 angles and 3"),
    (MINE + "time = [0, 1, 1, 3]\nangle = [0, 1, 2, 3]", "increase, got 1 s after 1 s (point 3)"),
    (MINE + "time = [1, 2, 3, 4]\nangle = [0, 1, 2, 3]", "times from 0 on, got 1 s first"),
    (MINE + TABLE + "[0, 1, 2, 90, 91]", "got 2° to 90° between 2 s and 3 s"),
    (MINE + "angle = [0, 1, 2, 3]", "add time = "),
    (MINE + "torque = 1\nduration = 1", "regimes.mine.start_angle is missing"),
    (MINE + "torque = [1, 2]\n" + REST, "or over time"),
    (MINE + "torque = 1\ntime = [1, 2]\n" + REST, "expected a list of torques beside it"),
    (MINE + "torque = [1, 2]\ntime = [1, 1]\n" + REST, "times that increase, got 1 s after 1 s"),
    (MINE + "torque = [1, 2]\ntime = [1]\n" + REST, "got 1 times and 2 torques"),
]
EVERY = [*REPLACED, *(("", added, words) for added, words in ADDED)]


@pytest.mark.parametrize(("old", "new", "words"), EVERY, ids=range(len(EVERY)))
def test_a_fault_has_its_place_and_one_short_sentence(old, new, words):
    assert old in JUKI
    message = message_of(JUKI.replace(old, new, 1) if old else f"{JUKI}\n{new}\n")
    assert re.match(r"sample.toml:\d+: ", message) or new.isspace()
    assert words in message
    assert len(message) < 1000
    assert message.isprintable()


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("centre = [-12.9, 0]", "center = [-12.9, 0]", "links.coupler.center: unknown key 'center': did you mean"),
        ("centre = [-12.9, 0]", "centre = [nan, 0]", "links.coupler.centre #1: expected the mass centre as [x, y]"),
        ("as-printed.links.coupler]", "as-printed.links.couplr]", "unknown link 'couplr': did you mean"),
    ],
)
def test_a_fault_in_a_variant_is_a_fault_of_the_variant_alone(old, new, words):
    text = JUKI.replace(old, new)
    parse(text, "sample", "sample.toml")
    message = message_of(text, "as-printed")
    assert words in message
    assert "couplr" in new or f":{JUKI.splitlines().index('centre = [-12.9, 0]') + 1}: " in message


# A linkage of the tests, a part of its file, what replaces it, and a part of the message.
OTHERS = [
    ("carried-slider", "inertia = 0.2e-4", "", "links.slider.inertia is missing"),
    (
        "near-toggle",
        ", along = [1, 0] }",
        " }",
        "output.along is missing: expected a direction [x, y], since 'B' is on",
    ),
    (
        "carried-slider",
        "[links.rocker]",
        '[links.rocker]\nslides = { point = "O2", on = "slider", through = [0, 0], along = [1, 0] }',
        "got a circle of rocker on slider on rocker; let one of them slide on another link",
    ),
]
LOADS = [
    ('over = "S"\n', "", "forces #1.travel: expected travel = [...] with over = 'S', angle = [...] without"),
    ("travel = [0, 30, 80, 95]", "angle = [0, 30, 80, 95]", "forces #1.angle: expected travel = [...]; correct it"),
    ("travel = [0, 30, 80, 95]", "travel = [0, 80, 30, 95]", "expected increasing travels, got steps of -50 mm"),
    ('when = "advance"', 'when = "forth"', "forces #1.when: expected 'advance' or 'return': the load acts only"),
    ('when = "advance"', "period = 720", "period: expected no period of a load over a travel; leave it out"),
    ("period = 720", "period = 500", "torques #1.period: expected one turn or two, got 1.389 turns"),
    ("period = 720", "period = 360", "expected increasing angles that span less than one turn"),
    ('frame = "rod"', 'frame = "rot"', "forces #2.frame: unknown link 'rot': did you mean 'rod'?"),
    ('["rod", "crank"]', '["rod", "rod"]', "expected the loaded link and another body that takes"),
    ('["rod", "ground"]', '["ground", "rod"]', "expected a link first, on which the load acts, got 'ground'"),
    ('between = ["rod", "ground"]\n', "", "torques #1.link is missing: expected the name of a link; add it, or"),
]
FRICTION = [
    ("ram = {", "rum = {", "friction.rum: unknown pin, slider or slot 'rum': did you mean 'ram'"),
    ("= 1.0", "= -1.0", "friction.ram.coefficient: expected a finite coefficient of"),
    ("ram = {", "A = {", "friction.A: expected radius and coefficient, of a pin, got other keys"),
    ("= 1.0", "= 1.0, radius = 2", "friction.ram: expected coefficient alone, of a guide, got"),
]
OTHERS += [("laden-press", *row) for row in LOADS] + [("locking-slider-crank", *row) for row in FRICTION]


@pytest.mark.parametrize(("name", "old", "new", "words"), OTHERS)
def test_a_fault_that_the_meaning_of_a_file_shows(name, old, new, words):
    text = (text_of if name in MADE_UP else file_text)(name)
    assert old in text
    assert words in message_of(text.replace(old, new, 1))


def test_an_unknown_variant():
    words = r"unknown variant of 'juki-mf7923d' 'as-buit': did you mean 'as-built'\?"
    with pytest.raises(UnknownNameError, match=words):
        load("juki-mf7923d", "as-buit")


def test_of_many_faults_only_the_first_is_reported():
    message = message_of(JUKI + '[[forces]]\npoint = "D"\nforce = [0, "x"]\n' * 3)
    assert message.startswith(f"sample.toml:{JUKI.count(chr(10)) + 3}: forces #1.force #2: expected [x, y]")


def test_a_title_may_have_lines():
    assert "\n" in parse(JUKI.replace('title   = "', 'title   = "a\\nb\\t', 1), "sample", "sample.toml").title


def _fault_of(text):
    """What is wrong with a file in all that can be computed of it; None for nothing."""
    try:
        sample = Mechanism(parse(text, "sample", "sample.toml"))
        sample.check_full_turn()
        reduced.drive_torque(sample.turn, 30.0, 100.0)
        relative_bounds(sample.turn)
        if sample.linkage.output:
            stroke(sample)
    except LinkproofError as error:
        return str(error)
    return None


@settings(max_examples=30)
@given(mutated_files())
def test_any_fault_of_a_file_is_one_sentence(text):
    fault = _fault_of(text)
    assert fault is None or (fault and "\n" not in fault)
