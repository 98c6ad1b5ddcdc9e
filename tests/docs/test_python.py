"""The snippets of docs/python.md and README.md print what stands beside them, and the page has every public name."""

import contextlib
import io
import re
from pathlib import Path

import pytest

import linkproof

ROOT = Path(__file__).parents[2]
PAGE = ROOT / "docs" / "python.md"
BLOCK = re.compile(r"^```python\n(.*?)^```", re.MULTILINE | re.DOTALL)
PRINTS = re.compile(r"^ *print\(.*\)  # (.*)$", re.MULTILINE)


@pytest.mark.parametrize("page", [PAGE, ROOT / "README.md"], ids=lambda page: page.stem)
def test_its_snippets_print_what_stands_beside_them(page):
    code = "\n".join(BLOCK.findall(page.read_text(encoding="utf-8")))
    with contextlib.redirect_stdout(io.StringIO()) as printed:
        exec(compile(code, str(page), "exec"), {})
    shown = PRINTS.findall(code)
    assert shown
    assert printed.getvalue().splitlines() == shown


def test_every_public_name_is_on_the_page():
    text = PAGE.read_text(encoding="utf-8")
    assert [name for name in linkproof.__all__ if f"`{name}" not in text and name != "__version__"] == []


def test_every_variable_of_results_is_on_the_page():
    text = PAGE.read_text(encoding="utf-8")
    assert [name for name in linkproof.results("juki-mf7923d", at=[0]) if f"`{name}`" not in text] == []
