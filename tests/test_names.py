"""Names and docstrings say what a thing is: not only that it was found, told or kept."""

import ast
import re

from tests.sources import SOURCES, docstrings, nodes

VAGUE = {"told", "asked", "found", "said", "kept", "held", "one"}
RIDDLE = re.compile(r"[^.]*\b(?:told|asked|found|said|kept|held|that is none)\b[^.]*", re.IGNORECASE)
PARTS = re.compile(r"[a-z]+")
# Names of which such a word is a part that has its own meaning: a number, a page in one file.
MEANT = {"ONE_ROW", "ONE_BY_ONE", "ONE_OF_ITS_KIND", "counts_from_one", "is_one"}


def names(nodes_of_file):
    """Every name that a file defines: of variables, fields, parameters, functions and classes."""
    for node in nodes_of_file:
        match node:
            case ast.Name(id=name, ctx=ast.Store()) | ast.Attribute(attr=name, ctx=ast.Store()) | ast.arg(arg=name):
                yield name
            case ast.FunctionDef(name=name) | ast.AsyncFunctionDef(name=name) | ast.ClassDef(name=name):
                yield re.sub("(?<=[a-z])(?=[A-Z])", "_", name).lower()


def test_no_name_says_only_that_a_thing_was_found_told_or_kept():
    vague = {
        f"{path}: {name}"
        for path, every in nodes().items()
        for name in names(every)
        if VAGUE & {*PARTS.findall(name.lower())} and name not in MEANT
    }
    assert sorted(vague) == []


def test_no_docstring_speaks_of_what_is_told_or_found():
    riddles = {
        f"{path}: {match[0]}" for path in SOURCES for text in docstrings(path) for match in RIDDLE.finditer(text)
    }
    assert sorted(riddles) == []
