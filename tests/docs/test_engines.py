"""The tables of docs/engines.md are those of the adapters."""

from pathlib import Path

from docs.making.readouts import renewed

PAGE = Path(__file__).parents[2] / "docs" / "engines.md"


def test_the_page_has_the_adapters_own_words():
    page = PAGE.read_text(encoding="utf-8")
    assert page == renewed(page), "write it anew: python -m docs.making.readouts docs/engines.md"
