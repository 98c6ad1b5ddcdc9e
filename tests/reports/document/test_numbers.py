"""Figures are written with the same digits everywhere."""

import pytest

from reports.document import numbers


@pytest.mark.parametrize(
    ("value", "text"),
    [(8.3391e-5, "8.339e-5"), (0.27041, "0.2704"), (31.0, "31.00"), (1000.0, "1000"), (0.0, "0"), (None, "–"),
     (68364.0, "68360"), (-12345.6, "-12350"), (9999.4, "9999"), (123456.0, "123500"), (2e6, "2.000e6")],
)  # fmt: skip
def test_a_figure_has_four_significant_digits_and_no_exponent_up_to_a_million(value, text):
    assert numbers.figure(value) == text


@pytest.mark.parametrize(("value", "text"), [(1.23e-5, "1.2e-5"), (0.0853, "8.5e-2"), (1.94, "1.9"), (19.4, "19"),
                                              (194.0, "1.9e2"), (0.0, "0"), (None, "–")])  # fmt: skip
def test_an_error_has_two(value, text):
    assert numbers.error(value) == text


def test_given_figures_keep_the_digits_they_have():
    assert [numbers.printed(value) for value in (8.3e-5, 0.16, 24.0, 6.13e-4)] == ["8.3e-5", "0.16", "24", "6.13e-4"]
    assert [numbers.bound(value) for value in (1e-4, 2.5e-6, None)] == ["1e-4", "2.5e-6", "–"]
    assert [numbers.seconds(value) for value in (1.234, 0.0123)] == ["1.23 s", "12.3 ms"]


@pytest.mark.parametrize(("value", "text"), [(2.3e-10, "1e-9"), (1e-9, "1e-9"), (0.0, "1e-13"), (3.0, "1e1")])
def test_a_bound_is_written_as_the_decade_above_it(value, text):
    assert numbers.decade(value) == text


def test_round_off_has_no_digits_where_two_reports_are_compared():
    assert [numbers.steady_error(value) for value in (None, 4e-16, 4e-6)] == ["–", "< 1e-13", "4.0e-6"]
