"""What is printed: no markup, no control characters, no text lost."""

import io
import sys

from reports.document.screen import line, rendered, show, table

FOREIGN = "[/rod] [bold]x[/] :smile: \x1b[2J\x07 \u202e"


def test_foreign_text_is_neither_markup_nor_obeyed():
    shown = "[/rod] [bold]x[/] :smile: \\x1b[2J\\x07 \\u202e"
    assert rendered(line(FOREIGN)) == f"{shown}\n"
    assert shown in rendered(table((FOREIGN,), [(FOREIGN,), ((FOREIGN, "red"),)]))


def test_a_pipe_gets_every_column_whole_and_no_spaces_at_the_ends(capsys):
    wide = ["x" * 300, "a sentence that a terminal would fold " * 9, ""]
    show(table(("a", "b", "c"), [wide]))
    head, row = capsys.readouterr().out.splitlines()
    assert row == f"{wide[0]}  {wide[1].rstrip()}"
    assert head == head.rstrip()


def test_a_terminal_folds_and_cuts_nothing():
    text = rendered(table(("a", "b"), [("x" * 50, "y" * 50)]), width=40)
    assert (text.count("x"), text.count("y")) == (50, 50)
    assert max(map(len, text.splitlines())) <= 40


def test_figures_stand_to_the_right_of_words():
    assert rendered(table(("name", "of", "n"), [("a", "b", "1"), ("a", "b", "10")], align="llr")).splitlines()[1:] == [
        "a     b    1", "a     b   10",
    ]  # fmt: skip


def test_remarks_go_to_stderr(capsys):
    show(line("remark"), stderr=True)
    assert capsys.readouterr() == ("", "remark\n")


def test_nothing_is_printed_of_nothing(monkeypatch):
    monkeypatch.setattr(sys, "stdout", io.StringIO())
    show()
    assert sys.stdout.getvalue() == ""
