"""The types of the public functions, for editors and type checkers, made of the declared options.

``python -m tests.linkproof.stub`` writes them anew into linkproof/__init__.pyi.
"""

import inspect
from pathlib import Path

import linkproof

FILE = Path(linkproof.__file__).with_suffix(".pyi")
HEAD = '''"""Types of the public names, written by tests/linkproof/stub.py from the declared options."""

from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

import xarray
from numpy.typing import ArrayLike

from analytic.description.linkage import Linkage as Linkage
from analytic.description.loading import load as load
from analytic.errors import LinkproofError as LinkproofError
from linkproof import engine as engine
from reports.python.campaign import Comparison as Comparison
from reports.python.checking import JudgedResults
from reports.python.checking import check as check
from reports.python.checking import check_engine as check_engine
from reports.python.evaluation import evaluate as evaluate

__version__: str
Words = str | Iterable[str]
Range = str | float | tuple[float | None, float | None] | None

def refuse_strangers() -> None: ...
'''
TYPES = {"tuple[str, ...]": "Words", "tuple[float, ...] | None": "ArrayLike | None",
         "pathlib.Path | None": "str | Path | None", "Any": "object", "typing.Any": "object"}  # fmt: skip
FUNCTIONS = ("compare", "judge", "optimise", "results", "sweep", "tolerance")


def text():
    """The whole file."""
    return HEAD + "".join(f"{_function(getattr(linkproof, name))}" for name in FUNCTIONS)


def _function(function):
    signature = inspect.signature(function)
    lines, is_open = [], False
    for one in signature.parameters.values():
        if one.kind is one.KEYWORD_ONLY and not is_open:
            is_open = True
            starred = any(other.kind is other.VAR_POSITIONAL for other in signature.parameters.values())
            lines += [] if starred else ["*"]
        star = "*" if one.kind is one.VAR_POSITIONAL else ""
        default = "" if one.default is one.empty else " = ..."
        lines.append(f"{star}{one.name}: {_type(one.annotation)}{default}")
    returned = _type(signature.return_annotation)
    return f"def {function.__name__}(\n" + "".join(f"    {line},\n" for line in lines) + f") -> {returned}: ...\n"


def _type(annotation):
    words = annotation if isinstance(annotation, str) else inspect.formatannotation(annotation)
    return TYPES.get(words, words)


if __name__ == "__main__":
    FILE.write_text(text(), encoding="utf-8")
