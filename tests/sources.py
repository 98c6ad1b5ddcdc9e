"""The source as its rules see it: every file with the nodes of its syntax tree, parsed once."""

import ast
from functools import cache
from pathlib import Path

ROOT = Path(__file__).parents[1]
PACKAGES = ("linkproof", "analytic", "engines", "comparisons", "reports")
SOURCES = [path for package in PACKAGES for path in (ROOT / package).rglob("*.py")]


@cache
def nodes():
    """Every file of the source with all nodes of its syntax tree."""
    return {path: [*ast.walk(ast.parse(path.read_text(encoding="utf-8")))] for path in SOURCES}


def docstrings(path):
    """The docstring of a file and of everything in it, as written."""
    documented = (ast.Module, ast.ClassDef, ast.FunctionDef, ast.AsyncFunctionDef)
    return [ast.get_docstring(node, clean=False) or "" for node in nodes()[path] if isinstance(node, documented)]
