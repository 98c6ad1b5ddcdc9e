"""docs/python.md has every public name, and every variable that ``results`` gives."""

from pathlib import Path

import linkproof

PAGE = Path(__file__).parents[2] / "docs" / "python.md"


def test_every_public_name_is_on_the_page():
    text = PAGE.read_text(encoding="utf-8")
    assert [name for name in linkproof.__all__ if f"`{name}" not in text and name != "__version__"] == []


def test_every_variable_of_results_is_on_the_page():
    text = PAGE.read_text(encoding="utf-8")
    assert [name for name in linkproof.results("juki-mf7923d", at=[0]) if f"`{name}`" not in text] == []
