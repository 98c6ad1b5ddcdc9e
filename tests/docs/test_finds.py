"""Every script of docs/finds.md still shows its fault: its output has the words and the differences of the page."""

import re

import pytest

from tests.docs.test_snippets import FILE, PAGES, agrees, blocks, commands, shell

__all__ = ["shell"]
(PAGE,) = (page for page in PAGES if page.name == "finds.md")
SCRIPTS = [text for kind, text in blocks(PAGE) if kind == "console"]
STILL = 0.01  # of a difference: where a linkage comes apart, processors differ
ROUNDING = 1e-9
GIVEN_UP = re.compile(r"solved (\d+) of (\d+) frames")


def differences(text):
    """The last number of every row, by the row's name."""
    rows = (line.rsplit(maxsplit=5) for line in text.splitlines() if "  " in line and "difference" not in line)
    return {row[0]: abs(float(row[-1])) for row in rows}


def name(text):
    """The engine of a block."""
    return re.search(r"ondsel|simbody|mujoco|pymunk", text)[0]


@pytest.mark.parametrize(
    "text",
    [pytest.param(text, marks=pytest.mark.nightly) if name(text) == "pymunk" else text for text in SCRIPTS],
    ids=name,
)
def test_a_fault_of_an_engine_is_still_there(text, shell, tmp_path):
    for path, file in FILE.findall(PAGE.read_text(encoding="utf-8")):
        (tmp_path / path).write_text(file, encoding="utf-8")
    (export, _), (script, shown) = commands(text)
    assert shell(export, tmp_path).returncode == 0
    output = shell(script, tmp_path).stdout
    assert agrees(output, shown, measured=True), output
    if "solved" in shown:
        assert GIVEN_UP.search(output)[1] != GIVEN_UP.search(output)[2]
        return
    found, expected = differences(output), differences(shown)
    assert max(expected.values()) > ROUNDING
    assert not {name for name, off in expected.items() if off > ROUNDING and found[name] < STILL * off}
