"""Parts as Markdown: the same words, no picture, no script."""

from markupsafe import Markup

from reports.document.markdown import inline, table, written
from reports.document.parts import (
    Bullets,
    Card,
    Cards,
    Cell,
    Command,
    Drawn,
    Facts,
    Figure,
    Figures,
    Fold,
    Link,
    Mono,
    Paragraph,
    Section,
    Table,
    Widget,
)


def test_rows_of_a_table_are_as_wide_as_their_head_and_bars_are_escaped():
    found = Table(
        "What <it> is.",
        ("name", "kind", "1/2 | value"),
        (("a|b", "<x>", "3"), ("[/c]", Cell("y", "pass", note="of z"), "40")),
        "llr",
        "A note.",
        groups=(("", 1), ("of it", 2)),
        bold=2,
    )
    caption, grid, note = table(found).split("\n\n")
    assert (caption, note) == ("What <it> is.", "A note.")
    assert grid.splitlines() == [
        "| name | of it kind | of it 1/2 \\| value |",
        "| --- | --- | ---: |",
        "| a\\|b | <x> | **3** |",
        "| [/c] | y (of z) | **40** |",
    ]


def test_words_keep_links_and_commands():
    assert inline(("see ", Link("it", "a.html"), ": ", Mono("x --y"))) == "see [it](a.html): `x --y`"


def test_every_part_is_its_words_and_headings_go_down():
    figure = Figure("f", "caption", "alt", lambda: None)
    section = Section("k", "Rest", (Fold("more", (Command("a\nb"),)), Section("", "Within", (Facts((("n", "v"),)),))))
    parts = (
        Paragraph("words", "lead"), Bullets(("one", "two")), Figures((figure,)), Cards((Card("card", (figure,)),)),
        Widget("k", "n", "label", {}, markup=Markup("<i>"), instead=(Paragraph("instead"),)),
        Drawn(Markup("<svg>"), "alt"),
        Figures(()), section,
    )  # fmt: skip
    assert written(parts).split("\n\n") == [
        "words", "- one\n- two", "caption", "## card", "caption", "instead", "alt",
        "## Rest", "more", "```\na\nb\n```", "### Within", "- n: v",
    ]  # fmt: skip
