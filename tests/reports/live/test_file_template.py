"""A file as a template: unchanged it is the file, and a number put in it is the linkage's."""

import pytest

from analytic.description.changes import named_numbers
from analytic.description.loading import catalogue, literature, load, parse
from reports.live import templates
from tests.analytic.linkages import FOLDER, MADE_UP

ALL_FILES = [*catalogue(), *literature(), *(str(FOLDER / f"{name}.toml") for name in MADE_UP)]
FILES = [
    *ALL_FILES[::6],
    *(pytest.param(name, marks=pytest.mark.nightly) for name in ALL_FILES if name not in ALL_FILES[::6]),
]


def put(template, values):
    """The text with these numbers as they are written."""
    written = template.literals | values
    return "".join(written[part] if place % 2 else part for place, part in enumerate(template.parts))


@pytest.mark.parametrize("name", FILES)
def test_unchanged_it_is_the_file_and_with_all_numbers_written_out_the_same_linkage(name):
    linkage = load(name)
    numbers = {one: number for one, number in named_numbers(linkage).items() if number.kind != "direction"}
    own, whole = templates(linkage, numbers)
    assert put(own, {}) == linkage.text
    assert set(whole.literals) == set(numbers) >= set(own.literals)
    again = named_numbers(parse(put(whole, {}), "again", "again.toml"))
    assert {one: again[one].value for one in numbers} == pytest.approx(
        {one: number.value for one, number in numbers.items()}, rel=1e-15
    )
    mass = f"{linkage.crank}.mass"
    for template in (one for one in (own, whole) if mass in one.literals):
        text = put(template, {mass: repr(2.0 * float(template.literals[mass]))})
        assert named_numbers(parse(text, "other", "other.toml"))[mass].value == pytest.approx(2.0 * numbers[mass].value)


def test_another_variant_than_the_file_s_own_has_its_numbers_written_out():
    linkage = load("juki-mf7923d", "as-printed")
    numbers = named_numbers(linkage)
    (only,) = templates(linkage, [one for one, number in numbers.items() if number.kind != "direction"])
    assert only.literals["coupler.centre.x"] == "-12.9"
    assert "variants" not in put(only, {})
