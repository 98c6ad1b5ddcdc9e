"""Printed text: no markup, no control characters, no loss of text."""

from reports.document.parts import Paragraph, Table, TableCell
from reports.document.terminal import rendered, show

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


def test_a_terminal_folds_and_cuts_nothing():
    text = rendered(Table("", ("a", "b"), [("x" * 50, "y" * 50)]), width=40)
    assert (text.count("x"), text.count("y")) == (50, 50)
    assert max(map(len, text.splitlines())) <= 40
