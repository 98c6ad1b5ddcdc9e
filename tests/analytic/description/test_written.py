"""A number that is rounded to zero has no sign, however a processor rounded it."""

import pytest

from analytic.description.written import change, csv_text, fixed, signed


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        (fixed(-0.0, 2), "0.00"), (fixed(-1e-17, 2), "0.00"), (fixed(-0.004, 2), "0.00"), (fixed(-0.006, 2), "-0.01"),
        (fixed(-0.4, 0), "0"), (signed(0.0, ".2f"), "0.00"), (signed(-0.0, ".2g"), "0"),
        (signed(-1e-9, ".3f"), "0.000"),
        (signed(1e-9, ".3f"), "0.000"), (signed(-0.0, ".0e"), "0e+00"), (signed(-3e-16, ".0e"), "-3e-16"),
        (signed(0.25, ".1%"), "+25.0%"), (signed(-1e-5, ".1%"), "0.0%"), (signed(10.0, ".4g"), "+10"),
        (change(3.2e-16), "0.00 %"), (change(-3.2e-16), "0.00 %"), (change(-0.0111), "-1.11 %"),
        (change(0.1), "+10.00 %"),
    ],
)  # fmt: skip
def test_a_rounded_zero_has_no_sign(text, expected):
    assert text == expected


@pytest.mark.parametrize(
    ("name", "cell"), [("=1+1", "'=1+1"), ("+a", "'+a"), ("-a", "'-a"), ("@a", "'@a"), ("a=b", "a=b")]
)
def test_a_name_in_a_csv_table_is_no_formula(name, cell):
    assert csv_text(name) == cell
