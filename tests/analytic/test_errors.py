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


def test_nothing_may_be_known():
    assert str(UnknownNameError("variant", "x", [])) == "unknown variant 'x': known are none"
