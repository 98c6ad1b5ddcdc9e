"""What is taken for the same print, and what is not."""

import pytest

from tests.printed import is_same

pytestmark = pytest.mark.nightly  # a test of tests


@pytest.mark.parametrize(
    ("text", "other", "same"),
    [
        ("stroke  +0.00 %  kept", "stroke  -0.00 %  kept", True),
        ("stroke  −0.00 %  kept", "stroke   0.00 %  kept", True),
        ("peak  9.999 N", "peak  10.00 N", True),
        ("peak  1.2e-7 N", "peak  1.3e-7 N", True),
        ("gap  3.1e-17 m", "gap  0 m", True),
        ("peak  1.251 N", "peak  1.253 N", False),
        ("peak  1.2e-7 N", "peak  1.4e-7 N", False),
        ("peak  1.25 N", "peak  -1.25 N", False),
        ("25 of 101 frames", "26 of 101 frames", False),
        ("Evaluated: 12 designs", "Evaluated: 15 designs", True),
        ("1.25 N", "1.25 m", False),
        ("1.25 N", "1.25  N", False),
        ("1.25 N 2", "1.25 N", False),
    ],
)
def test_last_digits_are_forgiven_and_nothing_else(text, other, same):
    assert is_same(text, other) is is_same(other, text) is same
