"""Unknown names come with the nearest known one."""

import pytest

from analytic.errors import LinkproofError, UnknownNameError


@pytest.mark.parametrize(
    ("name", "hint"),
    [
        ("rokcer", "did you mean 'rocker'? "),
        ("ROCKER", "did you mean 'rocker'? "),
        ("roc", "did you mean 'rocker'? "),
        ("needle", "did you mean 'needle_bar'? "),
        ("xyz", ""),
        ("", ""),
    ],
)
def test_the_nearest_name_is_offered(name, hint):
    error = UnknownNameError("link", name, ["rocker", "needle_bar", "crank"])
    assert isinstance(error, LinkproofError)
    assert str(error) == f"unknown link '{name}': {hint}known are crank, needle_bar, rocker"


def test_a_name_far_from_all_others_gets_no_hint_and_each_name_is_listed_once():
    assert str(UnknownNameError("variant", "x", [])) == "unknown variant 'x': known are none"
    assert str(UnknownNameError("setting", "fast", ["naive", "tuned", "best"])).startswith(
        "unknown setting 'fast': known"
    )
    assert "did you mean 'best'? " in str(UnknownNameError("setting", "beat", ["naive", "tuned", "best"]))
    assert str(UnknownNameError("quantity", "x", ["S", "v", "S"])).endswith("known are S, v")


def test_long_names_and_long_lists_make_no_long_message():
    message = str(UnknownNameError("link", "x" * 20_000, [f"link{number}" for number in range(10_000)]))
    assert message.startswith(f"unknown link '{'x' * 60}...': known are link0, ")
    assert message.endswith(" and 9970 more")
    long = str(LinkproofError("expected " + "x" * 20_000 + "; correct it"))
    assert len(long) <= 1500
    assert long.endswith("x; correct it")


def test_control_characters_are_escaped():
    message = str(LinkproofError("got '\x1b[2J', '\u202e', '\ud800' and 'ω²'"))
    assert message == r"got '\x1b[2J', '\u202e', '\ud800' and 'ω²'"


@pytest.mark.parametrize(
    ("word", "symbol"),
    [("torque", "Mkr"), ("Power", "Peq"), ("stroke", "S"), ("acceleration", "a"), ("forces", "joint_force")],
)
def test_a_quantity_is_offered_for_its_word(word, symbol):
    known = ["Jeq", "Mkr", "Teq", "Peq", "S", "v", "a", "joint_force"]
    assert f"did you mean '{symbol}'? " in str(UnknownNameError("quantity", word, known))
    assert f"did you mean '{symbol}'? " not in str(UnknownNameError("link", word, ["rod"]))
