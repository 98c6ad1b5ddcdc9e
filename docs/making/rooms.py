"""The rooms of the code: each with its sentence, its lines of code, and what its contract lets it import."""

from __future__ import annotations

import ast
import re
import tomllib
from functools import cache
from pathlib import Path
from typing import Any

from docs.making.pages import words
from reports.document.markdown import table
from reports.document.parts import Mono, Table

ROOT = Path(__file__).parents[2]
CONTRACTS = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["tool"]["importlinter"]["contracts"]
LAYERS = [contract for contract in CONTRACTS if contract["type"] == "layers"]
HEAD = ("layer", "room", "what is in it", "lines", "may import")


def source(module: str) -> Path:
    """The folder of a package, or the file of a module."""
    path = ROOT / module.replace(".", "/")
    return path if (path / "__init__.py").is_file() else path.with_suffix(".py")  # a folder of bytecode may be left


def sentence(module: str) -> str:
    """The first sentence of a module's docstring."""
    path = source(module)
    text = ast.get_docstring(ast.parse((path / "__init__.py" if path.is_dir() else path).read_text(encoding="utf-8")))
    return (text or "").partition("\n\n")[0].replace("\n", " ")


def lines(module: str) -> int:
    """Lines of code of a module or of all modules of a package, without blank lines, comments and docstrings."""
    path = source(module)
    return sum(map(_lines_of_code, path.rglob("*.py") if path.is_dir() else (path,)))


@cache
def _lines_of_code(path: Path) -> int:
    text = path.read_text(encoding="utf-8")
    tree = ast.parse(text)
    texts = [
        node.body[0]
        for node in ast.walk(tree)
        if isinstance(node, ast.Module | ast.ClassDef | ast.FunctionDef | ast.AsyncFunctionDef)
        and ast.get_docstring(node) is not None
    ]
    docstrings = {number for part in texts for number in range(part.lineno, (part.end_lineno or 0) + 1)}
    written = {number for number, line in enumerate(text.splitlines(), 1) if line.strip() and line.lstrip()[0] != "#"}
    return len(written - docstrings)


def layers(contract: dict[str, Any]) -> list[list[str]]:
    """The rooms of a contract by layers, from the lowest up."""
    (container,) = contract.get("containers", [""])
    named = [re.split(r" [|:] ", layer) for layer in reversed(contract["layers"])]
    return [[f"{container}.{name}".strip(".") for name in names] for names in named]


def is_of_rooms(contract: dict[str, Any]) -> bool:
    """Whether a contract orders rooms, which are folders or stand beside folders, rather than the files of one."""
    return any(source(name).is_dir() for names in layers(contract) for name in names)


def rooms() -> str:
    """A table for each contract that orders rooms, and what other contracts forbid."""
    tables = "\n\n".join(f"## {_title(contract)}\n\n{_table(contract)}" for contract in LAYERS if is_of_rooms(contract))
    notes = [
        f"- {_title(each)}. {_names(each['source_modules'])} may not import {_names(each['forbidden_modules'])}."
        for each in CONTRACTS
        if each["type"] == "forbidden"
    ]
    return "\n".join([f"{tables}\n\n## What is forbidden besides\n", *notes])


def _names(modules: list[str]) -> str:
    return ", ".join(f"`{name}`" for name in modules)


def _title(contract: dict[str, Any]) -> str:
    return str(contract["name"])[:1].upper() + str(contract["name"])[1:]


def _table(contract: dict[str, Any]) -> str:
    rows = []
    for (number, names), layer in zip(enumerate(layers(contract), 1), reversed(contract["layers"]), strict=True):
        below = {1: "nothing", 2: "layer 1"}.get(number, f"layers 1 to {number - 1}")
        may = f"{below}, and rooms of its own layer" if " : " in layer else below
        for name in names:
            where = Mono(source(name).relative_to(ROOT).as_posix())
            rows.append((str(number), where, words(sentence(name)), f"{lines(name):,}", may))
    return table(Table("", HEAD, tuple(reversed(rows)), align="rllrl"))
