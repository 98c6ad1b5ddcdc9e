"""Linkage files: found, read and written anew; their numbers by name, which can be set and left out alone."""

import math
import os
import re
import tomllib

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from analytic.description import changes
from analytic.description.loading import (
    CATALOGUE,
    LITERATURE,
    MARK,
    catalogue,
    find,
    gallery,
    known_names,
    literature,
    load,
    parse,
    read,
    rewritten,
)
from analytic.errors import DescriptionError, LinkproofError, UnknownNameError
from tests.analytic.linkages import FOLDER, JUKI, MADE_UP, mechanism
from tests.analytic.mutations import mutated_files


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("juki", "unknown mechanism 'juki': did you mean 'juki-mf7923d'? known are"),
        ("andrew-squeezer", "did you mean 'andrews-squeezer'"),
        ("", "unknown mechanism '': known are"),
        ("mine.toml", "got 'mine.toml', which does not exist; check the path"),
        ("no/such/folder/mine", "expected the path of a linkage file, whose name ends in .toml, or one of the mech"),
        ("x" * 5000 + ".toml", "which has a longer name than a file can have"),
        ("a\0b.toml", r"got 'a\x00b.toml', which does not exist"),
        ("a-folder.toml", "which is a folder; name a file"),
        ("linkages", "expected the path of a linkage file, got the folder 'linkages'; name its"),
        ("bytes.toml", "expected a text file in UTF-8, got other bytes; save it as UTF-8"),
    ],
)
def test_a_file_that_cannot_be_read(tmp_path, monkeypatch, name, words):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "linkages").mkdir()
    (tmp_path / "a-folder.toml").mkdir()
    (tmp_path / "bytes.toml").write_bytes(bytes(range(256)))
    with pytest.raises(LinkproofError, match=re.escape(words)):
        load(name)


def test_a_file_may_begin_with_a_byte_order_mark_and_is_read_once(tmp_path):
    path = tmp_path / "mine.toml"
    path.write_text("\ufeff" + JUKI, encoding="utf-8")
    file = read(str(path))
    assert (file.text, load(str(path)).name) == (JUKI, "mine")
    assert parse("\ufeff" + JUKI, "mine", "mine.toml") == load(str(path))
    path.unlink()
    assert [file.linkage(variant).variant for variant in (None, "as-printed")] == ["as-built", "as-printed"]


def test_a_file_name_that_is_not_utf_8(tmp_path):
    path = tmp_path / os.fsdecode(b"caf\xe9.toml")
    path.write_text(JUKI.replace("mass    = 0.64", "mass    = -1"), encoding="utf-8")
    with pytest.raises(DescriptionError, match=r"caf\\udce9.toml:20: links.crank.mass") as error:
        load(str(path))
    str(error.value).encode()
    path.write_text(JUKI, encoding="utf-8")
    assert load(str(path)).name == r"caf\udce9"


def test_a_variant_overrides_some_keys_and_the_first_one_is_the_file_itself():
    built, printed = (load("juki-mf7923d", variant) for variant in (None, "as-printed"))
    assert built.variant == built.variants[0] == "as-built"
    assert built.links["coupler"].centre == (0.0129, 0.0)
    assert printed.links["coupler"].centre == (-0.0129, 0.0)
    assert printed.links["coupler"].mass == built.links["coupler"].mass


def test_catalogue_literature_and_paths():
    assert load(str(FOLDER / "scotch-yoke.toml")).name == "scotch-yoke"
    assert len({*catalogue(), *gallery(), *literature()}) == len(known_names())
    assert read("andrews-squeezer").origin == "andrews-squeezer.toml"
    with pytest.raises(UnknownNameError):
        find("andrews")


FILES = {
    path.stem: path.read_text(encoding="utf-8")
    for path in (*CATALOGUE.glob("*.toml"), *FOLDER.rglob("*.toml"), LITERATURE / "stephenson-six-bar.toml")
}
DESIGNS = [(name, variant) for name, text in FILES.items() for variant in parse(text, name, name).variants]
RIMOLDI = FILES["rimoldi-164"]
COMMENTS = re.compile(r"#.*$", re.MULTILINE)


def numbers_of(text, variant=None):
    return changes.numbers(parse(text, "sample", "sample.toml", variant))


def expected(text, variant, numbers):
    """The numbers of the linkage as ``changed`` makes it."""
    linkage = parse(text, "sample", "sample.toml", variant)
    return changes.numbers(changes.changed(linkage, lambda name, _, old: numbers.get(name, old)))


def assert_written(text, variant, numbers, ulps=1):
    new = numbers_of(rewritten(text, "sample", variant, numbers))
    meant = expected(text, variant, numbers)
    assert new.keys() == meant.keys()
    for name, value in new.items():
        size = 4 * math.ulp(1.0) if ".along." in name else ulps * math.ulp(meant[name])
        assert abs(value - meant[name]) <= size, name


@settings(max_examples=15)
@given(st.sampled_from(DESIGNS), st.data())
def test_any_numbers_are_written_to_the_last_digit(design, data):
    name, variant = design
    old = numbers_of(FILES[name], variant)
    names = [one for one in sorted(old) if old[one] or not one.endswith(".mass")]  # a mass would need an inertia
    chosen = data.draw(st.lists(st.sampled_from(names), unique=True, max_size=6))
    factor = st.floats(0.6, 1.6)  # what is zero gets numbers far from each other: points of a link stay apart
    numbers = {one: (old[one] or 1e-3 * 3.0**place) * data.draw(factor) for place, one in enumerate(chosen)}
    assert_written(FILES[name], variant, numbers)


@pytest.mark.parametrize("name", FILES)
def test_all_numbers_at_once_and_writing_twice(name):
    numbers = {one: value * 1.1 + 1e-3 for one, value in numbers_of(FILES[name]).items()}
    once = rewritten(FILES[name], name, None, numbers)
    assert_written(FILES[name], None, numbers)
    again = rewritten(once, name, None, {})
    assert again.partition("\n")[2] == once.partition("\n")[2]
    assert again.count(MARK) == 1


@pytest.mark.parametrize("name", FILES)
def test_without_a_change_the_variant_is_the_file_with_its_comments(name):
    text = FILES[name]
    new = rewritten(text, name, None, {}, new_variant="as it was")
    linkage = parse(new, name, name)
    assert changes.numbers(linkage) == numbers_of(text)
    assert (linkage.variant, linkage.variants) == ("as it was", ("as it was",))
    assert not linkage.published
    for part in re.split(r"\n(?=\[)", text):
        if not part.startswith(("[variants", "[[published]]")):
            assert set(COMMENTS.findall(part)) <= set(COMMENTS.findall(new))


def test_only_what_changes_is_touched():
    new = rewritten(RIMOLDI, "rimoldi-164", "as-printed", {"rod.B.x": 0.176, "crank.mass": 0.51}, new_variant="longer")
    first, _, body = new.partition("\n")
    assert first == f"{MARK}rimoldi-164, variant as-printed: rod.B.x = 176.0 mm"
    own = RIMOLDI.partition("\n[variants")[0].replace('"as-built"', '"longer"', 1).replace("[175, 0]", "[176.0, 0]")
    own = own.replace("[69, 0]", "[0.069, 0]").replace("[9.5, 0]", "[-9.5, 0]")
    assert body == own


def test_points_by_radius_and_angle_become_coordinates():
    text = FILES["slotted-takeup"]
    new = rewritten(text, "slotted-takeup", None, {"coupler.P4.x": 1e-3})
    assert tomllib.loads(new)["links"]["coupler"]["points"]["P4"] == pytest.approx([1.0, -10.0])
    assert_written(text, None, {"coupler.P4.x": 1e-3}, ulps=2)


def test_a_point_a_quarter_of_a_turn_round_is_on_the_axis():
    text = RIMOLDI.replace("[175, 0]", "{ radius = 175, angle = 90 }")
    assert parse(text, "sample", "sample.toml").links["rod"].points["B"] == (0.0, pytest.approx(0.175))


def test_the_stroke_stays_along_its_direction_where_a_guide_turns():
    text = FILES["force-over-angle"]  # its output has no direction of its own
    new = parse(rewritten(text, "sample", None, {"piston.along.x": 0.0}), "sample", "sample.toml")
    assert new.sliders[0].guide.along == (0.0, 1.0)
    assert new.output.along == pytest.approx((12 / 13, 5 / 13), abs=1e-15)


LOADED = """
forces = [{ point = "D", force = [[1, 0]], link = "rod" }, { point = "D", force = [3, 0], link = "rod" }]
torques = [{ link = "rod", torque = [5] }]
"""


def test_of_two_loads_of_one_name_each_is_written_where_it_stands():
    text = FILES["juki-mf7923d"].replace("title ", f"{LOADED}title ", 1)
    rod = next(name for name, link in parse(FILES["juki-mf7923d"], "j", "j").links.items() if "D" in link.points)
    text = text.replace('"rod"', f'"{rod}"')
    new = tomllib.loads(rewritten(text, "sample", None, {"forces.D.x #2": 2.0, f"torques.{rod}": 6.0}))
    assert [table["force"] for table in new["forces"]] == [[[1, 0]], [2.0, 0]]
    assert new["torques"][0]["torque"] == [6.0]
    assert_written(text, None, {"forces.D.x": 7.0})


@settings(max_examples=20)
@given(mutated_files())
def test_what_can_be_read_can_be_written(text):
    try:
        old = numbers_of(text)
    except LinkproofError:
        return
    assert numbers_of(rewritten(text, "sample", None, {})) == old


@pytest.mark.parametrize(
    ("numbers", "words"),
    [
        ({"rod.B.z": 1.0}, "unknown parameter of 'rimoldi-164' 'rod.B.z': did you mean 'rod.B.y'"),
        ({"rod.B.x": math.nan}, "rod.B.x: expected a finite number, got nan"),
        ({"needle_bar.along.y": 0.0}, "needle_bar.along.y: expected a direction, got [0, 0]"),
        ({"rod.mass": -1.0}, "links.rod.mass: expected"),
        ({"rod.B.x": 0.0}, "links.rod.points: expected a positive length"),
        ({"rod.mass": 1e80}, "links.rod.mass: expected a magnitude"),
    ],
)
def test_numbers_that_are_no_design(numbers, words):
    with pytest.raises(LinkproofError, match=re.escape(words)):
        rewritten(RIMOLDI, "rimoldi-164", None, numbers)


def test_a_variant_that_there_is_not():
    with pytest.raises(UnknownNameError, match="known are as-built"):
        rewritten(RIMOLDI, "rimoldi-164", "as-bulit", {})


# Numbers by name.


def with_number(linkage, path, number):
    return changes.changed(linkage, lambda name, kind, value: number if name == path else value)


@pytest.mark.parametrize("name", MADE_UP)
def test_every_number_can_be_set_alone(name):
    linkage = mechanism(name).linkage
    assert changes.changed(linkage, lambda path, kind, value: value) == linkage
    before = changes.numbers(linkage)
    assert len(before) > 10
    for path, value in before.items():
        if ".along." not in path:  # a component of a unit vector takes the other one with it
            after = changes.numbers(with_number(linkage, path, value + 1.0))
            assert after == {**before, path: value + 1.0}


@pytest.mark.parametrize("part", changes.EMPTY_PARTS)
def test_a_part_left_out_is_gone_and_no_other(part):
    linkage = load("slotted-takeup") if part == "thread" else mechanism("spring-and-damper").linkage
    bare = changes.without(linkage, part)
    assert getattr(bare, part) == changes.EMPTY_PARTS[part]
    assert {name for name in vars(bare) if getattr(bare, name) != getattr(linkage, name)} <= {part}
