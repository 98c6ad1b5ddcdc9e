"""Parts as Markdown: the same words, no picture, no script."""

from reports.document.markdown import inline, table, written
from reports.document.parts import (
    Bullets,
    Facts,
    Fold,
    Mono,
    PageFigure,
    PageLink,
    Paragraph,
    Section,
    Table,
    TableCell,
)


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
    assert (caption, note) == ("What <it> is.", "A note.")
    assert grid.splitlines() == [
        "| name | of it kind | of it 1/2 \\| value |",
        "| --- | --- | ---: |",
        "| a\\|b | <x> | 3 |",
        "| [/c] | y (of z) | 40 |",
    ]


def test_words_keep_links_and_commands():
    assert inline(("see ", PageLink("it", "a.html"), ": ", Mono("x --y"))) == "see [it](a.html): `x --y`"


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
