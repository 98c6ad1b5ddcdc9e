"""A header as words that mean something: names of the linkage, words of several languages, and what is left over."""

from __future__ import annotations

import itertools
import re
import tomllib
import unicodedata
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Final

from analytic.description.linkage import GROUND, Linkage

_WORDS: Final = tomllib.loads(Path(__file__).with_name("words.toml").read_text(encoding="utf-8"))
TOGETHER: Final = "together"
LONGEST: Final = 200  # characters of a header that is looked at
TOKEN: Final = re.compile(r"[^\W\d_]+|\d+")
# Where a word begins inside another: camelCase, and the last capital of a run of them.
CAMEL: Final = re.compile(r"(?<=[a-z])(?=[A-Z])|(?<=[A-Z])(?=[A-Z][a-z])")


def plain(text: str) -> str:
    """A text without case, accents and the marks of letters."""
    decomposed = unicodedata.normalize("NFKD", text.casefold())
    kept = "".join(c for c in decomposed if not unicodedata.combining(c) or c in "\u3099\u309a")
    return unicodedata.normalize("NFC", kept).replace("ł", "l").replace("ø", "o")


def _meanings() -> dict[str, set[str]]:
    meanings: dict[str, set[str]] = {}
    for meaning, table in _WORDS.items():
        for word in table["words"] if meaning != TOGETHER else ():
            meanings.setdefault(" ".join(plain(word).split()), set()).add(meaning)
    for language in _WORDS[TOGETHER]:
        for first, then in itertools.product(language["first"], language["then"]):
            meanings.setdefault(plain(first + then), set()).update(meanings[plain(first)] | meanings[plain(then)])
    return meanings


MEANINGS: Final[Mapping[str, set[str]]] = _meanings()
STEMS: Final = tuple(sorted((word[:-1] for word in MEANINGS if word.endswith("*")), key=len, reverse=True))
MOST_WORDS: Final = max(word.count(" ") for word in MEANINGS) + 1
ENDING: Final = 5  # letters behind a stem


@dataclass(frozen=True)
class Word:
    """A part of a header: one of its meanings each, or the name of a link, point or joint (``kind`` says which)."""

    text: str
    meanings: frozenset[str] = frozenset()
    kind: str = ""


@dataclass(frozen=True)
class Names:
    """Names of a linkage by the tokens they consist of, each with its kinds: link, point, joint."""

    by_tokens: Mapping[tuple[str, ...], tuple[tuple[str, str], ...]]

    @property
    def longest(self) -> int:
        """Tokens of the longest name."""
        return max((len(tokens) for tokens in self.by_tokens), default=0)


def names_of(linkage: Linkage) -> Names:
    """The names in a linkage."""
    named: dict[tuple[str, ...], list[tuple[str, str]]] = {}
    points = {point for link in linkage.links.values() for point in link.points} | {*linkage.ground}
    for kind, names in (("link", linkage.links), ("point", points), ("joint", linkage.joint_names)):
        for name in sorted(names):
            named.setdefault(_tokens_of_name(name), []).append((kind, name))
    # A number alone is that of a plot, "Angular Velocity2", not the name of a link.
    return Names({tokens: tuple(found) for tokens, found in named.items() if not all(map(str.isdigit, tokens))})


def _tokens_of_name(name: str) -> tuple[str, ...]:
    return tuple(word if len(word) == 1 else word.casefold() for word in TOKEN.findall(name))


def words(header: str, names: Names) -> list[Word]:
    """The words of a header from left to right; digits behind a word that are no name's are left out."""
    tokens = TOKEN.findall(header[:LONGEST])
    found: list[Word] = []
    at = 0
    while at < len(tokens):
        taken, parts = _next(tokens[at:], names)
        found += parts
        at += taken
    return found


def _next(tokens: list[str], names: Names) -> tuple[int, list[Word]]:
    """How many tokens the next words take, and the words: the longest name, else the longest phrase, else parts."""
    for count in range(min(names.longest, len(tokens)), 0, -1):
        named = names.by_tokens.get(_tokens_of_name(" ".join(tokens[:count])))
        if named:
            return count, [Word(name, frozenset(_phrase(tokens[:count])), kind) for kind, name in named]
    for count in range(min(MOST_WORDS, len(tokens)), 0, -1):
        meanings = _phrase(tokens[:count])
        if meanings:
            return count, [Word(" ".join(tokens[:count]), frozenset(meanings))]
    token = tokens[0]
    if token.isdigit():
        return 1, []
    pieces = [token] if known_meanings(token) else CAMEL.split(token)
    return 1, [Word(piece, known_meanings(piece)) for piece in pieces]


def _phrase(tokens: Iterable[str]) -> set[str]:
    return set(MEANINGS.get(plain(" ".join(tokens)), ()))


def known_meanings(word: str) -> frozenset[str]:
    """What a word means, exactly or by its stem; nothing for an unknown one."""
    text = plain(word)
    stem = next((f"{stem}*" for stem in STEMS if text.startswith(stem) and len(text) <= len(stem) + ENDING), "")
    return frozenset(MEANINGS.get(text) or MEANINGS.get(stem) or ())


def bodies(found: Iterable[Word], kind: str) -> Iterator[str]:
    """Names of a kind among the words of a header, the ground left out."""
    return (word.text for word in found if word.kind == kind and word.text != GROUND)
