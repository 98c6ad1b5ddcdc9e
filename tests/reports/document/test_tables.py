"""One table, three ways of writing it: the same cells in each."""

import re

from markupsafe import Markup
from rich.console import Console
from rich.text import Text

from reports.document.tables import ReportTable, markdown
from reports.document.templates import render

TABLE = ReportTable(
    "What <it> is.",
    ("name", "kind", "1/2 | value"),
    (("a|b", "<x>", "3"), ("[/c]", "y", "40")),
    "llr",
    "A note.",
    bold=2,
)


def test_markdown_rows_are_as_wide_as_their_head_and_bars_are_escaped():
    caption, table, note = markdown(TABLE).split("\n\n")
    assert (caption, note) == ("What <it> is.", "A note.")
    assert table.splitlines() == [
        "| name | kind | 1/2 \\| value |",
        "| --- | --- | ---: |",
        "| a\\|b | <x> | **3** |",
        "| [/c] | y | **40** |",
    ]


def test_a_page_escapes_words_and_keeps_markup():
    found = render("study_section.html", title="t", about="", tables=[TABLE])
    assert "What &lt;it&gt; is." in found
    assert re.findall(r"<t[dh](?: [^>]*)?>(.*?)</t[dh]>", found) == [
        *("name", "kind", "1/2 | value", "a|b", "&lt;x&gt;", "<strong>3</strong>", "[/c]", "y", "<strong>40</strong>"),
    ]
    assert found.count('class="num"') == 3
    marked = ReportTable("", ("name",), ((Markup("<code>c</code>"),),))
    assert "<code>c</code>" in render("study_section.html", title="t", about="", tables=[marked])


def test_a_terminal_reads_no_markup_and_aligns_figures():
    console = Console(width=60)
    with console.capture() as captured:
        console.print(TABLE)
    lines = captured.get().splitlines()
    assert [line.split() for line in lines[2:4]] == [["a|b", "<x>", "3"], ["[/c]", "y", "40"]]
    assert lines[2].rstrip().endswith("          3")


def test_colours_of_a_cell_stay_on_the_terminal():
    table = ReportTable("", ("a", "b"), (("x", Text("red", style="red")),))
    assert "| x | red |" in markdown(table)
