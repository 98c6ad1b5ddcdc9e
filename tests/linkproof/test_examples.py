"""The examples of public docstrings show what they give."""

import doctest
import inspect

import pytest

import linkproof

SLOW = {"bench", "check_engine"}
FUNCTIONS = [name for name in linkproof.__all__ if inspect.isfunction(getattr(linkproof, name))]


@pytest.mark.parametrize("name", [pytest.param(n, marks=[pytest.mark.nightly] * (n in SLOW)) for n in FUNCTIONS])
def test_an_example_gives_what_it_shows(name, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    text = inspect.getdoc(getattr(linkproof, name))
    example = doctest.DocTestParser().get_doctest(text, {"linkproof": linkproof}, name, None, None)
    assert example.examples
    told = []
    doctest.DocTestRunner(verbose=False).run(example, out=told.append)
    assert "".join(told) == ""


def test_a_linkage_is_a_line_a_table_in_a_notebook_and_a_picture():
    linkage = linkproof.load("juki-mf7923d")
    assert repr(linkage) == f"<Linkage: juki-mf7923d (as-built): {linkage.title}>"
    assert "<td>needle_bar</td><td>0.076 kg</td><td>D</td>" in linkage._repr_html_()
    assert linkage.plot().axes
