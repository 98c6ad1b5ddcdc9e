"""Names say what a thing is: words that say only that it was found, told or kept are no names in the source."""

import ast
import re
from pathlib import Path

PACKAGES = ("linkproof", "analytic", "engines", "comparisons", "reports")
VAGUE = {"told", "asked", "found", "said", "kept", "held", "one"}
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


def test_no_name_says_only_that_a_thing_was_found_told_or_kept():
    root = Path(__file__).parents[1]
    vague = {
        f"{path.relative_to(root)}: {name}"
        for package in PACKAGES
        for path in (root / package).rglob("*.py")
        for name in names(ast.parse(path.read_text(encoding="utf-8")))
        if VAGUE & {*PARTS.findall(name.lower())} and name not in MEANT
    }
    assert sorted(vague) == []
