"""A header as words with their meanings: names of a linkage, words of several languages, and what is neither."""

from __future__ import annotations

import re
import tomllib
import unicodedata
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Final

TOKEN: Final = re.compile(r"[^\W\d_]+|\d+")
# Where a word begins inside another: camelCase, and the last capital of a run of them.
CAMEL: Final = re.compile(r"(?<=[a-z])(?=[A-Z])|(?<=[A-Z])(?=[A-Z][a-z])")
NOTHING: Final = "nothing"  # the meaning of words that change nothing
SHORTEST, SHORTEST_FOREIGN = 3, 2  # letters of a word written together with others


@dataclass(frozen=True)
class Word:
    """A part of a header with all that it may mean; a name of the linkage means ``:name``."""

    text: str
    meanings: frozenset[str] = frozenset()


Table = Mapping[tuple[str, ...], frozenset[str]]


def plain(text: str) -> str:
    """A text without case, accents and the marks of letters."""
    decomposed = unicodedata.normalize("NFKD", text.casefold())
    letters = "".join(c for c in decomposed if not unicodedata.combining(c) or c in "\u3099\u309a")
    return unicodedata.normalize("NFC", letters).replace("ł", "l").replace("ø", "o")


def tokens(text: str) -> list[str]:
    """The words and numbers of a text."""
    return TOKEN.findall(CAMEL.sub(" ", text))


def _table() -> dict[tuple[str, ...], frozenset[str]]:
    table: dict[tuple[str, ...], frozenset[str]] = {}
    for meaning, words in tomllib.loads(Path(__file__).with_name("words.toml").read_text(encoding="utf-8")).items():
        for word in words:
            key = tuple(plain(word).split())
            table[key] = table.get(key, frozenset()) | {meaning}
    return table


WORDS: Final[Table] = _table()
MOST_WORDS: Final = max(map(len, WORDS))  # of a phrase


def named(names: Iterable[str]) -> Table:
    """What names mean by their words; a number alone is that of a plot, "Angular Velocity2", and no name."""
    table: dict[tuple[str, ...], frozenset[str]] = {}
    for name in names:
        key = _key(tokens(name))
        if not all(map(str.isdigit, key)):
            table[key] = table.get(key, frozenset()) | {f":{name}"}
    return table


def _key(words: Iterable[str]) -> tuple[str, ...]:
    """Words of a name: single letters differ by case."""
    return tuple(word if len(word) == 1 else word.casefold() for word in words)


def words(header: str, names: Table) -> Iterator[Word]:
    """The words of a header that mean something or are unknown; numbers that belong to no name are left out."""
    every, at = tokens(header), 0
    longest = max(MOST_WORDS, *map(len, names))
    while at < len(every):
        for count in range(min(longest, len(every) - at), 0, -1):
            part = every[at : at + count]
            meanings = names.get(_key(part), frozenset()) | WORDS.get(tuple(map(plain, part)), frozenset())
            if meanings:
                break
        at += count
        text = " ".join(part)
        together = [meanings] if meanings or text.isdigit() else known_parts(plain(text)) or [meanings]
        yield from (Word(text, one) for one in together if not text.isdigit() and one != {NOTHING})


@lru_cache(maxsize=4096)
def known_parts(word: str) -> tuple[frozenset[str], ...]:
    """The meanings of known words that are written together in one, as in German and Chinese; () if any is unknown."""
    if (word,) in WORDS:
        return (WORDS[word,],)
    least = SHORTEST if word.isascii() else SHORTEST_FOREIGN
    for cut in range(len(word) - least, least - 1, -1):
        first = WORDS.get((word[:cut],))
        if first and (rest := known_parts(word[cut:])):
            return (first, *rest)
    return ()
