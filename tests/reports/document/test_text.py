"""Parts as Markdown and for a terminal, figures as digits and in words: no markup, no loss of text."""

import io
import sys

import pytest

from reports.document import numbers
from reports.document.markdown import inline, table, written
from reports.document.numbers import accept_any_text
from reports.document.parts import PageLink, Paragraph, Section, Table, TableCell
from reports.document.templates import worded
from reports.document.terminal import rendered, show


def test_rows_of_a_table_are_as_wide_as_their_head_and_bars_are_escaped():
    found = Table(
        "What <it> is.",
        ("name", "kind", "1/2 | value"),
        (("a|b", "<x>", "3"), ("[/c]", TableCell("y", "pass", note="of z"), "40")),
        "llr",
        "A note.",
        groups=(("", 1), ("of it", 2)),
    )
    caption, grid, note = table(found).split("\n\n")
    assert (caption, note) == ("What \\<it> is.", "A note.")
    assert grid.splitlines() == [
        "| name | of it kind | of it 1/2 \\| value |",
        "| --- | --- | ---: |",
        "| a\\|b | \\<x> | 3 |",
        "| \\[/c\\] | y (of z) | 40 |",
    ]


@pytest.mark.parametrize(
    ("words", "expected"),
    [
        ("<script>x</script>", r"\<script>x\</script>"),
        ("[a](javascript:x)", r"\[a\](javascript:x)"),
        ("*a* _b_ `c` d\\", r"\*a\* \_b\_ \`c\` d\\"),
        ("&lt;b&gt;", r"\&lt;b\&gt;"),
        ("torque_two_routes < 1e-13 & 5", "torque_two_routes < 1e-13 & 5"),
    ],
)
def test_a_name_is_no_markup(words, expected):
    assert inline(words) == expected
    assert inline(PageLink(words, "a.html")) == f"[{expected}](a.html)"
    assert written([Section("k", words, ())]).startswith(f"## {expected}")


# Printed text: no markup, no control characters, no loss of text.


FOREIGN = "[/rod] [bold]x[/] :smile: \x1b[2J\x07 \u202e"


def test_foreign_text_is_neither_markup_nor_obeyed():
    shown = "[/rod] [bold]x[/] :smile: \\x1b[2J\\x07 \\u202e"
    assert rendered(FOREIGN) == rendered(Paragraph(FOREIGN, colour="bold")) == f"{shown}\n"
    table = rendered(Table(FOREIGN, (FOREIGN,), ((FOREIGN,), (TableCell(FOREIGN, colour="red"),)), note=FOREIGN))
    assert [line.strip() for line in table.splitlines()] == [shown] * 5


def test_a_pipe_gets_every_column_whole_and_no_spaces_at_the_ends(capsys):
    wide = ["x" * 300, "a sentence that a terminal would fold " * 9, ""]
    show(Table("", ("a", "b", "c"), [wide], "l"))
    head, row = capsys.readouterr().out.splitlines()
    assert row == f"{wide[0]}  {wide[1].rstrip()}"
    assert head == head.rstrip()


# Streams of small character sets.


def test_a_sign_that_a_character_set_lacks_is_shown_by_a_plain_one(monkeypatch):
    written = io.BytesIO()
    monkeypatch.setattr(sys, "stdout", io.TextIOWrapper(written, encoding="cp1252"))
    accept_any_text()
    sys.stdout.write("1e-5 ✓ ✗ φ 90° ½ 机 \udcff")
    sys.stdout.flush()
    assert written.getvalue().decode("cp1252") == "1e-5 + x phi 90° ½ ? ?"


# Figures are written with the same digits everywhere.


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


# Names of figures for a reader.


@pytest.mark.parametrize(
    ("quantity", "words"),
    [
        ("Jeq.mean", "Jeq, mean"),
        ("Jeq:needle_bar.mean", "Jeq of needle bar, mean"),
        ("epsilon@0s", "epsilon at 0 s"),
        ("Jeq:needle_bar.mean - rimoldi-164", "Jeq of needle bar, mean − rimoldi-164"),
        ("Mkr@0", "Mkr at 0°"),
        ("point:F:vx@-5deg", "vx of point F at -5°"),
        ("point:F:x.range", "x of point F, range"),
        ("joint_force:E:K3:x@0.5rad", "x of joint force E:K3 at 0.5 rad"),
        ("link:K2:angle@0.03s - phi", "angle of link K2 at 0.03 s − phi"),
    ],
)
def test_a_figure_is_worded_for_a_reader(quantity, words):
    assert worded(quantity) == words
