"""Parts as Markdown: the same words, no picture, no script."""

import pytest

from reports.document.markdown import inline, table, written
from reports.document.parts import Bullets, Facts, Fold, PageFigure, PageLink, Paragraph, Section, Table, TableCell


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


def test_headings_go_down_and_pictures_are_left_out():
    figure = PageFigure("f", "caption", "alt", lambda: None)
    within = Section("", "Within", (Facts((("n", "v"),)), Fold("more", (Paragraph("folded"),))))
    parts = (Paragraph("words", "lead"), Bullets(("one", "two")), figure, Section("k", "Rest", (within,)))
    assert written(parts).split("\n\n") == [
        "words",
        "- one\n- two",
        "## Rest",
        "### Within",
        "- n: v",
        "more",
        "folded",
    ]
