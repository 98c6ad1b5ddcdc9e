"""``new``, ``check`` and ``list``: a file that works at once, a review up to its first fault, names and values."""

import json
import math
import re
import tomllib
from pathlib import Path

import pytest
from jsonschema import Draft4Validator

from analytic.description.json_schema import json_schema
from analytic.description.loading import load, read
from analytic.errors import DescriptionError, LinkproofError, StructureError
from analytic.kinematics.mechanism import Mechanism
from reports.command_line.destination import Destination
from reports.designs import linkages as mechanisms
from tests.analytic.linkages import DOUBLE_ROCKER
from tests.commands import linkproof, refused

SLIP = DOUBLE_ROCKER.replace("C = [60, 0]", "c = [60, 0]")


@pytest.fixture(autouse=True)
def _folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)


def checked(capsys, text, **options):
    """The output of ``check`` for a file, and the fault that it ends with."""
    Path("mine.toml").write_text(text, encoding="utf-8")
    fault = None
    try:
        Destination(**options).emit(mechanisms.review(load("mine.toml"), "mine.toml", strict=False))
    except LinkproofError as error:
        fault = error
    return capsys.readouterr().out, fault


def test_a_new_file_works_and_fits_its_schema(capsys):
    assert "next: linkproof check" in str(mechanisms.new('needle "drive"'))
    text = Path('needle "drive".toml').read_text(encoding="utf-8")
    assert text.startswith("#:schema ./linkproof.schema.json\n")
    schema = json.loads(Path("linkproof.schema.json").read_text(encoding="utf-8"))
    Draft4Validator(schema).validate(tomllib.loads(text))
    linkage = load('needle "drive".toml')
    assert linkage.title == 'needle "drive"'
    Mechanism(linkage).check_full_turn()
    output, fault = checked(capsys, text)
    assert fault is None
    assert "crank-rocker" in output
    assert "warning" not in output


def test_every_part_that_is_commented_out_works():
    """Each is taken in by itself; the piston needs a rod as well, and the slot is one joint too many beside pin B."""
    head, _, parts = mechanisms.TEMPLATE.read_text(encoding="utf-8").partition("# What follows")
    for part in parts.split("\n\n")[1:]:
        lines = [line.removeprefix("# ") for line in part.strip().splitlines()]
        body = head
        if lines[0].startswith("[[slots]]"):
            tomllib.loads("\n".join(lines))
            continue
        if lines[0].startswith("[links.piston]"):
            lines += ["[links.rod]", "points = { P = [0, 0], D = [120, 0] }", "[sketch.points]", "D = [120, 20]"]
            body = head.replace("[sketch]", "[sketch]\n").replace("points = { B = [60, 45] }", "")
        Path("part.toml").write_text("\n".join([body, *lines]), encoding="utf-8")
        assert load("part.toml").links


def test_nothing_is_overwritten_but_an_old_schema_of_ours():
    Path("mine.toml").write_text("mine", encoding="utf-8")
    Path("linkproof.schema.json").write_text("{}", encoding="utf-8")
    with pytest.raises(LinkproofError, match=r"'mine\.toml' exists already: give another name"):
        mechanisms.new("mine")
    mechanisms.new("other.toml")
    assert Path("mine.toml").read_text(encoding="utf-8") == "mine"
    assert Path("linkproof.schema.json").read_text(encoding="utf-8") == "{}"
    Path("linkproof.schema.json").write_text(json.dumps({"title": mechanisms.TITLE}), encoding="utf-8")
    assert str(mechanisms.new("third")).startswith("wrote third.toml and renewed linkproof.schema.json, ")
    assert json.loads(Path("linkproof.schema.json").read_text(encoding="utf-8")) == json_schema()


def test_a_copy_of_a_linkage_has_its_comments_under_the_new_name():
    assert linkproof("new", "mine", "--like", "toggle-press").returncode == 0
    text, given = Path("mine.toml").read_text(encoding="utf-8"), read("toggle-press").text
    assert text == f"#:schema ./linkproof.schema.json\n{given}".replace('"Toggle press"', '"mine"')
    assert linkproof("new", "second", "--like", "mine.toml").returncode == 0
    assert Path("second.toml").read_text(encoding="utf-8") == text.replace('"mine"', '"second"')
    Path("wrong.toml").write_text(SLIP.replace('"deg"', '"dag"'), encoding="utf-8")
    assert "dag" in refused("new", "third", "--like", "wrong.toml")
    assert not Path("third.toml").exists()


@pytest.mark.parametrize("name", ["a\x1bb", "none/there/x", ".toml"])
def test_a_name_that_cannot_be_a_file_is_refused(name):
    Path("none").write_text("", encoding="utf-8")
    with pytest.raises(LinkproofError, match=r"expected a"):
        mechanisms.new(name)
    assert [path.name for path in Path().iterdir()] == ["none"]


def test_a_swing_is_reported_with_its_limits_and_drawn(capsys):
    output, fault = checked(capsys, DOUBLE_ROCKER, save=(Path("scheme.svg"), Path("facts.json")))
    assert fault is None
    assert "from 14.3615° to 112.411°; at 14.3615° coupler + rocker (RRR): folded in one line; at 112.411°" in output
    assert "40° or more from 35.82" in output
    assert "\nlink     mass kg" in output
    drawn = Path("scheme.svg").read_text(encoding="utf-8")
    assert drawn.lstrip().startswith("<?xml")
    assert drawn.rstrip().endswith("</svg>")


def test_everything_up_to_the_first_fault_is_reported(capsys):
    output, fault = checked(capsys, SLIP, save=(Path("scheme.svg"), Path("facts.json")))
    assert isinstance(fault, StructureError)
    assert "mobility     3 = 3·3 links - 2·3 pins and slides" in output
    assert "warning: points 'C' and 'c' are two" in output
    assert not Path("scheme.svg").exists()
    output, fault = checked(capsys, DOUBLE_ROCKER.replace('angle = "deg"', 'angle = "dag"'))
    assert (output, type(fault)) == ("", DescriptionError)
    output, fault = checked(capsys, SLIP, json=True)
    assert json.loads(output)["fault"] == str(fault)


def test_the_next_command_can_be_pasted_into_a_shell():
    assert str(mechanisms.new("a b")).endswith("next: linkproof check 'a b.toml'")
    assert str(mechanisms.new("-x")).endswith("next: linkproof check ./-x.toml")
    with pytest.raises(DescriptionError, match=r"unknown mechanism 'a b': did you mean the file 'a b\.toml'\?"):
        load("a b")


def _listed(kind):
    document = json.loads(linkproof("list", "juki-mf7923d", "--json").stdout)
    return document["conditions"], {row["name"]: (row["value"], row["units"]) for row in document[kind]}


def test_every_listed_figure_is_reproduced_where_a_file_prints_it(tmp_path):
    """As it stands in the table, with its unit and half a unit of its last digit."""
    text, table = load("juki-mf7923d").text, linkproof("list", "juki-mf7923d").stdout.split("\n\n")[1]
    rows = [re.split(r"\s{2,}", line.strip()) for line in table.splitlines()[1:]]
    printed = [row for row in rows if float(row[-1])]
    assert min(abs(float(row[-1])) for row in printed) > 1e-9  # no rounding of zero
    entries = [
        f'[[published]]\nquantity = "{name}"\nunit = "{"".join(unit)}"\nvalue = {value}\nspeed = 1000\n'
        f'half_digit = {0.5 * 10.0 ** (math.floor(math.log10(abs(float(value)))) - 5)}\nplace = "list"\n'
        for name, *unit, value in printed
    ]
    file = tmp_path / "pasted.toml"
    file.write_text("\n".join([re.sub(r"\[\[published\]\]\n(.+\n)+", "", text), *entries]), encoding="utf-8")
    assert len(entries) > 100
    assert f"{len(entries)} of {len(entries)} figures of the sources are reproduced" in linkproof("check", file).stdout


def test_every_figure_has_the_value_of_results_and_of_a_refined_sweep():
    conditions, figures = _listed("figures")
    assert "constant-speed, 1000 rpm counter-clockwise" in conditions
    drive, *_ = json.loads(linkproof("results", "juki-mf7923d", "--json").stdout)["figures"]["drive"]
    assert figures["Mkr.peak"] == (pytest.approx(abs(drive["value"]), rel=1e-9), "N*m")
    names = ("stroke", "joint_force:A.rms", "link:coupler:omega.range", "Jeq.mean")
    words = [word for name in names for word in ("--quantity", name)]
    vary = ("--vary", "crank.A.x=15.5:15.5:1", "--refine", "--json")
    swept = json.loads(linkproof("sweep", "juki-mf7923d", *vary, *words).stdout)["figures"]
    for name in names:
        assert figures[name] == (pytest.approx(swept[name]["least"]["value"], rel=1e-12), swept[name]["units"])


def test_every_number_has_the_value_and_the_unit_of_the_file():
    numbers = _listed("numbers")[1]
    expected = {"crank.A.x": (15.5, "mm"), "coupler.mass": (0.03, "kg"), "gravity.y": (-9.81, "m/s^2")}
    assert {**expected, "output.along.y": (1.0, "")}.items() <= numbers.items()
