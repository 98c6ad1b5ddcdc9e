"""Bad linkage files: each fault is one sentence that says where it is, what was expected and what was got."""

import os
import re
import tomllib

import pytest
from hypothesis import given, settings
from pydantic import ValidationError

from analytic.description.loading import catalogue, find, literature, load, parse, read
from analytic.description.schema import Document
from analytic.dynamics import reduced
from analytic.errors import DescriptionError, LinkproofError, UnknownNameError
from analytic.kinematics.mechanism import Mechanism
from analytic.turn import unit_functions
from tests.analytic.faults import JUKI, message_of
from tests.analytic.linkages import CATALOGUE, FOLDER
from tests.analytic.mutations import mutated_files

MASS = "links.crank.mass: expected a finite mass of zero or more in the file's mass unit, got"
INERTIA = "expected a finite moment of inertia of zero or more about the mass centre in the file's inertia"
POINT = "expected a point as [x, y] or { radius, angle }, finite numbers, got"

# What is replaced in the file, by what, and what the message then says.
FAULTS = {
    "mass negative": ("mass    = 0.64", "mass = -1.5", f"{MASS} -1.5; correct it"),
    "mass nan": ("mass    = 0.64", "mass = nan", f"{MASS} nan; correct it"),
    "mass infinite": ("mass    = 0.64", "mass = inf", f"{MASS} inf; correct it"),
    "mass in quotes": ("mass    = 0.64", 'mass = "0.64"', f"{MASS} '0.64'; correct it"),
    "mass true": ("mass    = 0.64", "mass = true", f"{MASS} true; correct it"),
    "mass a list": ("mass    = 0.64", "mass = [1]", f"{MASS} [1]; correct it"),
    "mass a date": ("mass    = 0.64", "mass = 2025-01-01", f"{MASS} 2025-01-01; correct it"),
    "mass of 400 digits": ("mass    = 0.64", f"mass = 1{'0' * 400}", f"{MASS} 1{'0' * 59}...; correct it"),
    "mass huge": (
        "mass    = 0.64",
        "mass = 1e300",
        "expected a magnitude between 1e-60 and 1e+60 in SI units, got 1e+300 kg",
    ),
    "mass tiny": (
        "mass    = 0.64",
        "mass = 1e-300",
        "expected a magnitude between 1e-60 and 1e+60 in SI units, got 1e-300 kg",
    ),
    "inertia negative": ("inertia = 0.64e-4", "inertia = -1e-4", f"{INERTIA} unit, got -0.0001; correct it"),
    "inertia nan": ("inertia = 0.64e-4", "inertia = nan", f"{INERTIA} unit, got nan; correct it"),
    "inertia missing": ("inertia = 0.64e-4", "", "links.crank.inertia is missing: expected a finite moment of inertia"),
    "coinciding points": (
        "A = [15.5, 0]",
        "A = [0, 0]",
        "links.crank.points: expected a positive length between 'A' and",
    ),
    "all but coinciding points": ("A = [15.5, 0]", "A = [0, 1e-15]", "expected a positive length between 'A' and 'O1'"),
    "radius negative": (
        "A = [15.5, 0]",
        "A = { radius = -3, angle = 0 }",
        "A.radius: expected a positive finite length in",
    ),
    "radius misspelt": ("A = [15.5, 0]", "A = { radus = 3, angle = 0 }", "unknown key 'radus': did you mean 'radius'?"),
    "angle missing": (
        "A = [15.5, 0]",
        "A = { radius = 3 }",
        "A.angle is missing: expected a finite angle in the file's",
    ),
    "three coordinates": ("A = [15.5, 0]", "A = [15.5, 0, 1]", f"links.crank.points.A: {POINT} [15.5, 0, 1]"),
    "one coordinate": ("A = [15.5, 0]", "A = [15.5]", f"links.crank.points.A #2: {POINT} [15.5]"),
    "coordinate in quotes": ("A = [15.5, 0]", 'A = [15.5, "0"]', f"links.crank.points.A #2: {POINT} '0'"),
    "coordinate nan": ("A = [15.5, 0]", "A = [nan, 0]", f"links.crank.points.A #1: {POINT} nan"),
    "point a number": ("A = [15.5, 0]", "A = 15.5", f"links.crank.points.A: {POINT} 15.5"),
    "unknown key": (
        "inertia = 0.64e-4",
        "inertai = 0.64e-4",
        "unknown key 'inertai': did you mean 'inertia'? known are",
    ),
    "unknown table": ("gravity = ", "gravty = ", "unknown key 'gravty': did you mean 'gravity'?"),
    "units misspelt": ("units   =", "unts   =", "unknown key 'unts': did you mean 'units'?"),
    "unknown crank": ('crank   = "crank"', 'crank = "krank"', "crank: unknown link 'krank': did you mean 'crank'?"),
    "crank missing": ('crank   = "crank"\n', "", "crank is missing: expected the name of the link that is the crank"),
    "unknown unit": ('length = "mm"', 'length = "mmm"', "units.length: unknown length unit 'mmm': did you mean 'mm'?"),
    "unit in capitals": (
        'length = "mm"',
        'length = "MM"',
        "units.length: unknown length unit 'MM': did you mean 'mm'?",
    ),
    "unit of another kind": ('mass = "kg"', 'mass = "mm"', "units.mass: unknown mass unit 'mm': did you mean"),
    "unit missing": (
        'length = "mm", ',
        "",
        "units.length is missing: expected the name of a unit of length in quotes: m,",
    ),
    "unit a number": ('length = "mm"', "length = 3", "units.length: expected the name of a unit of length in quotes"),
    "sketch of an unknown point": (
        "points = { D = [0",
        "points = { E = [0",
        "sketch.points: unknown point 'E': known are",
    ),
    "output unknown": (
        'point = "D", along = [0, 1] }\nnotes',
        'point = "d" }\nnotes',
        "output: unknown moving point 'd'",
    ),
    "guide without direction": (
        "along = [0, 1] }\nmass",
        "along = [0, 0] }\nmass",
        "expected a direction [x, y], got [0, 0]",
    ),
    "guide without place": (
        "through = [0, 0], ",
        "",
        "links.needle_bar.slides.through is missing: expected a point of",
    ),
    "slides on nothing": (
        "through = [0, 0]",
        'on = "x", through = [0, 0]',
        "links.needle_bar.slides.on: unknown link 'x'",
    ),
    "slides on itself": (
        "through = [0, 0]",
        'on = "needle_bar", through = [0, 0]',
        "expected a host that does not itself hang on 'needle_bar', got a circle of needle_bar on needle_bar; let",
    ),
    "no links": (JUKI[JUKI.index("[links.crank]") :], "", "links is missing: expected a table [links.NAME] for every"),
    "title a number": ('title   = "', 'title = 3 # "', "title: expected a title in quotes, got 3"),
    "another format": (
        "crank   =",
        "format = 2\ncrank =",
        "format: expected the number 1, the only format so far, got 2",
    ),
    "a link named ground": (
        "[links.coupler]",
        "[links.ground]\nmass = 1\n[links.coupler]",
        "links.ground: expected only",
    ),
    "gravity huge": ("gravity = [0, -9.81]", "gravity = [0, 1e99]", "gravity: expected a magnitude between 1e-60 and"),
    "variants as a list": (
        "[variants.as-printed.links.coupler]",
        "[[variants]]",
        "variants: expected tables [variants.NAME]",
    ),
    "variant of the file's own name": (
        "variants.as-printed",
        "variants.as-built",
        "variants.as-built: expected another name than",
    ),
}


@pytest.mark.parametrize("fault", FAULTS)
def test_a_fault_in_the_file(fault):
    old, new, expected = FAULTS[fault]
    assert old in JUKI
    message = message_of(JUKI.replace(old, new, 1))
    assert re.match(r"sample.toml:\d+: ", message)
    assert expected in message


def test_a_fault_of_syntax_that_is_no_usual_slip_has_its_line_and_column():
    message = message_of(JUKI.replace("mass    = 0.64", "mass    = -", 1))
    assert message == "sample.toml:20: not valid TOML: Invalid value in column 11; correct it"


def test_a_fault_has_its_line():
    line = JUKI.splitlines().index("mass    = 0.64") + 1
    assert message_of(JUKI.replace("mass    = 0.64", "mass = -1")).startswith(f"sample.toml:{line}: links.crank.mass")


@pytest.mark.parametrize(
    ("old", "new", "expected"),
    [
        (
            "centre = [-12.9, 0]",
            "center = [-12.9, 0]",
            "links.coupler.center: unknown key 'center': did you mean 'centre'?",
        ),
        ("centre = [-12.9, 0]", "centre = [nan, 0]", "links.coupler.centre #1: expected the mass centre as [x, y]"),
        (
            "as-printed.links.coupler]",
            "as-printed.links.couplr]",
            "unknown link 'couplr': did you mean",
        ),
    ],
)
def test_a_fault_in_a_variant(old, new, expected):
    text = JUKI.replace(old, new)
    parse(text, "sample", "sample.toml")  # the file itself is right
    message = message_of(text, "as-printed")
    assert expected in message
    if "couplr" not in new:
        assert f":{JUKI.splitlines().index('centre = [-12.9, 0]') + 1}: " in message


def test_an_unknown_variant():
    with pytest.raises(
        UnknownNameError, match=r"unknown variant of 'juki-mf7923d' 'as-buit': did you mean 'as-built'\?"
    ):
        load("juki-mf7923d", "as-buit")


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("", "expected a linkage description, got an empty file"),
        (" \n\t\n", "expected a linkage description, got an empty file"),
        ("# a title\n", "title is missing: expected a title in quotes"),
        ("a = " + "[" * 3000 + "]" * 3000, "expected tables and short lists, got very deep nesting"),
    ],
)
def test_a_file_with_nothing_in_it(text, expected):
    assert expected in message_of(text)


@pytest.mark.parametrize(
    ("name", "expected"),
    [
        ("juki", "unknown mechanism 'juki': did you mean 'juki-mf7923d'? known are"),
        ("", "unknown mechanism '': known are"),
        (
            "mine.toml",
            "got 'mine.toml', which does not exist; check the path",
        ),
        (
            "no/such/folder/mine",
            "expected the path of a linkage file, whose name ends in .toml, or one of the mechanisms fork-takeup,",
        ),
        ("x" * 5000 + ".toml", "which does not exist"),
        ("a\0b.toml", r"got 'a\x00b.toml', which does not exist"),
        ("j.json", "whose name ends in .toml, or one of the mechanisms"),
    ],
)
def test_a_file_that_is_not_there(name, expected):
    with pytest.raises(LinkproofError, match=re.escape(expected)):
        load(name)


def test_a_folder_for_a_file(tmp_path):
    (tmp_path / "mine.toml").mkdir()
    with pytest.raises(DescriptionError, match="which is a folder; check the path"):
        load(str(tmp_path / "mine.toml"))


def test_bytes_for_text(tmp_path):
    path = tmp_path / "mine.toml"
    path.write_bytes(bytes(range(256)))
    with pytest.raises(DescriptionError, match="expected a text file in UTF-8, got other bytes; save it as UTF-8"):
        load(str(path))


def test_a_file_of_ones_own_may_begin_with_a_byte_order_mark(tmp_path):
    path = tmp_path / "mine.toml"
    path.write_text("\ufeff" + JUKI, encoding="utf-8")
    assert load(str(path)).name == "mine"
    assert read(str(path)).text == JUKI
    assert parse("\ufeff" + JUKI, "mine", "mine.toml") == load(str(path))


def test_a_file_is_read_once(tmp_path, monkeypatch):
    path = tmp_path / "mine.toml"
    path.write_text(JUKI, encoding="utf-8")
    file = read(str(path))
    path.unlink()
    assert [file.linkage(variant).variant for variant in (None, "as-printed")] == ["as-built", "as-printed"]


@pytest.mark.parametrize(
    ("old", "new", "line", "shown"),
    [
        ('"Juki', r'"\u001b[2JJuki', 3, r"'\x1b[2JJuki"),
        ('"D"', r'"\u0008"', 9, r"'\x08'"),
        ("[links.coupler]", r'[links."a\u0007"]', 24, r"'a\x07'"),
        ("[links.coupler]", r'[links."a\nb"]', 24, r"'a\nb'"),
        ('"Juki', r'"\u202eikuJ', 3, r"'\u202eikuJ"),
    ],
)
def test_control_characters_are_refused(old, new, line, shown):
    message = message_of(JUKI.replace(old, new, 1))
    assert message.startswith(f"sample.toml:{line}: ")
    assert f"expected no control characters, got {shown}" in message
    assert message.isprintable()


def test_texts_may_have_lines():
    assert "\n" in parse(JUKI.replace('title   = "', 'title   = "a\\nb\\t', 1), "sample", "sample.toml").title


def test_long_names_make_no_long_message():
    assert len(message_of(JUKI.replace("inertia = 0.64e-4", "x" * 1_000_000 + " = 1"))) < 1000
    assert len(message_of(JUKI.replace("[links.coupler]", f"[links.{'x' * 1_000_000}]\nmass = 0"))) < 1000


@pytest.mark.parametrize("number", ["1" * 5000, "0x" + "f" * 5000, "1_" * 4999 + "1"])
def test_a_number_of_thousands_of_digits(number):
    message = message_of(JUKI.replace("mass    = 0.64", f"mass    = {number}"))
    assert message.startswith("sample.toml:20: ")
    assert len(message) < 300


def test_a_key_of_thousands_of_parts():
    message = message_of(JUKI + "\n" + ".".join(f"k{number}" for number in range(20_000)) + " = 1")
    assert re.match(r"sample.toml:\d+: expected tables and short lists, got very deep nesting", message)


def test_a_file_name_that_is_not_utf_8(tmp_path):
    path = tmp_path / os.fsdecode(b"caf\xe9.toml")
    path.write_text(JUKI.replace("mass    = 0.64", "mass    = -1"), encoding="utf-8")
    with pytest.raises(DescriptionError, match=r"caf\\udce9.toml:20: links.crank.mass") as error:
        load(str(path))
    str(error.value).encode()
    path.write_text(JUKI, encoding="utf-8")
    assert load(str(path)).name == r"caf\udce9"


def test_of_many_faults_the_first_is_told_without_looking_for_the_others():
    faults = '[[forces]]\npoint = "D"\nforce = [0, "x"]\n' * 3
    message = message_of(JUKI + faults)
    assert message.startswith(f"sample.toml:{JUKI.count(chr(10)) + 3}: forces #1.force #2: expected [x, y]")
    with pytest.raises(ValidationError) as error:
        Document.model_validate(tomllib.loads(JUKI + faults))
    assert {fault["loc"][1] for fault in error.value.errors() if fault["loc"][0] == "forces"} == {0}


@pytest.mark.parametrize(("name", "variant"), CATALOGUE)
def test_the_catalogue_loads(name, variant):
    linkage = load(name, variant)
    assert (linkage.name, linkage.variant) == (name, variant)
    assert linkage.source
    assert find(name).is_file()


def test_the_first_variant_is_the_file_itself():
    assert load("juki-mf7923d").variant == load("juki-mf7923d").variants[0] == "as-built"


def test_a_variant_lays_its_keys_over_the_file():
    built, printed = (load("juki-mf7923d", variant) for variant in ("as-built", "as-printed"))
    assert built.links["coupler"].centre == (0.0129, 0.0)
    assert printed.links["coupler"].centre == (-0.0129, 0.0)
    assert printed.links["coupler"].mass == built.links["coupler"].mass


def test_files_are_found_by_path_and_by_name():
    assert load(str(FOLDER / "scotch-yoke.toml")).name == "scotch-yoke"
    assert "juki-mf7923d" in catalogue()


def test_the_literature_is_found_by_name_and_kept_apart_from_the_catalogue():
    assert "andrews-squeezer" in literature()
    assert not set(literature()) & set(catalogue())
    assert read("andrews-squeezer").origin == "andrews-squeezer.toml"
    with pytest.raises(UnknownNameError, match="did you mean 'andrews-squeezer'"):
        find("andrew-squeezer")


@settings(max_examples=250)
@given(mutated_files())
def test_whatever_is_wrong_with_a_file_is_told_in_one_sentence(text):
    told = _everything_of(text)
    assert told is None or (told and "\n" not in told)


def _everything_of(text):
    """Ask for all there is; what the error says if there is one."""
    try:
        sample = Mechanism(parse(text, "sample", "sample.toml"))
        sample.check_full_turn()
        reduced.drive_torque(sample.turn, 30.0, 100.0)
        sample.error_bound()
        if sample.linkage.output:
            unit_functions.unit_functions(sample, 720)
    except LinkproofError as error:
        return str(error)
    return None


def test_a_folder_is_no_linkage(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "linkages").mkdir()
    with pytest.raises(
        LinkproofError, match=r"^expected the path of a linkage file, got the folder 'linkages'; name its"
    ):
        read("linkages")
