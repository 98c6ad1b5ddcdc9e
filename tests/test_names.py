"""Names and docstrings say what a thing is: not only that it was found, told or kept."""

import ast
import re
from functools import cache
from pathlib import Path

PACKAGES = ("linkproof", "analytic", "engines", "comparisons", "reports")
VAGUE = {"told", "asked", "found", "said", "kept", "held", "one"}
RIDDLE = re.compile(r"[^.]*\b(?:told|asked|found|said|kept|held|that is none)\b[^.]*", re.IGNORECASE)
PARTS = re.compile(r"[a-z]+")
# Names of which such a word is a part that has its own meaning: a number, a page in one file.
MEANT = {"ONE_ROW", "ONE_BY_ONE", "ONE_OF_ITS_KIND", "counts_from_one", "is_one"}


def names(tree):
    """Every name that a file defines: of variables, fields, parameters, functions and classes."""
    for node in ast.walk(tree):
        match node:
            case ast.Name(id=name, ctx=ast.Store()) | ast.Attribute(attr=name, ctx=ast.Store()) | ast.arg(arg=name):
                yield name
            case ast.FunctionDef(name=name) | ast.AsyncFunctionDef(name=name) | ast.ClassDef(name=name):
                yield re.sub("(?<=[a-z])(?=[A-Z])", "_", name).lower()


@cache
def trees():
    """Every file of the source with its syntax tree."""
    root = Path(__file__).parents[1]
    files = [path for package in PACKAGES for path in (root / package).rglob("*.py")]
    return [(path.relative_to(root), ast.parse(path.read_text(encoding="utf-8"))) for path in files]


def docstrings(tree):
    """The docstring of a file and of everything in it."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Module | ast.ClassDef | ast.FunctionDef | ast.AsyncFunctionDef):
            yield ast.get_docstring(node) or ""


def test_no_name_says_only_that_a_thing_was_found_told_or_kept():
    vague = {
        f"{path}: {name}"
        for path, tree in trees()
        for name in names(tree)
        if VAGUE & {*PARTS.findall(name.lower())} and name not in MEANT
    }
    assert sorted(vague) == []


def test_no_docstring_speaks_of_what_is_told_or_found():
    riddles = {
        f"{path}: {match[0]}" for path, tree in trees() for text in docstrings(tree) for match in RIDDLE.finditer(text)
    }
    assert sorted(riddles) == []
