"""Verdicts as a reader sees them: a sign, a word and a colour; sign and word have the meaning without the colour."""

from __future__ import annotations

import tomllib
from collections.abc import Mapping
from typing import NamedTuple

from reports.document.templates import FOLDER


class VerdictSign(NamedTuple):
    """``style`` is a class of the page's style sheet, ``colour`` a colour of the terminal."""

    symbol: str
    word: str
    style: str
    colour: str


TABLES = tomllib.loads((FOLDER / "signs.toml").read_text(encoding="utf-8"))
RUNS: Mapping[str, VerdictSign] = {verdict: VerdictSign(*row) for verdict, row in TABLES["runs"].items()}
PUBLISHED: Mapping[str, VerdictSign] = {verdict: VerdictSign(*row) for verdict, row in TABLES["published"].items()}
