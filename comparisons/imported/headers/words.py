"""A header as words with their meanings: names of a linkage, words of several languages, and what is neither."""

from __future__ import annotations

import re
import tomllib
import unicodedata
from collections import defaultdict
from collections.abc import Iterable, Iterator, Mapping
from functools import lru_cache
from pathlib import Path
from typing import Final

Meanings = frozenset[str]
Table = Mapping[tuple[str, ...], Meanings]

TOKEN: Final = re.compile(r"[^\W\d_]+|\d+")
# Where a word begins inside another: camelCase, and the last capital of a run of them.
CAMEL: Final = re.compile(r"(?<=[a-z])(?=[A-Z])|(?<=[A-Z])(?=[A-Z][a-z])")
NOTHING: Final = frozenset({"nothing"})  # the meaning of words that change nothing
SHORTEST, SHORTEST_FOREIGN = 3, 2  # letters of a word written together with others


def plain(text: str) -> str:
    """A text without case, accents and the marks of letters."""
    decomposed = unicodedata.normalize("NFKD", text.casefold())
    letters = "".join(c for c in decomposed if not unicodedata.combining(c) or c in "\u3099\u309a")
    return unicodedata.normalize("NFC", letters).replace("ł", "l").replace("ø", "o")


def tokens(text: str) -> list[str]:
    """The words and numbers of a text."""
    return TOKEN.findall(CAMEL.sub(" ", text))


def _table(pairs: Iterable[tuple[tuple[str, ...], str]]) -> Table:
    table: dict[tuple[str, ...], Meanings] = defaultdict(frozenset)
    for words, meaning in pairs:
        table[words] |= {meaning}
    return dict(table)


_FILE: Final = tomllib.loads(Path(__file__).with_name("words.toml").read_text(encoding="utf-8"))
WORDS: Final = _table((tuple(plain(word).split()), meaning) for meaning, words in _FILE.items() for word in words)


def named(names: Iterable[str]) -> Table:
    """Meanings, ``:name``, of names by their words; a number alone is a plot's, "Angular Velocity2", and no name."""
    return _table((key, f":{name}") for name in names if not all(map(str.isdigit, key := _key(tokens(name)))))


def _key(words: Iterable[str]) -> tuple[str, ...]:
    """Words of a name: single letters differ by case."""
    return tuple(word if len(word) == 1 else word.casefold() for word in words)


def words(header: str, names: Table) -> Iterator[tuple[str, Meanings]]:
    """The words of a header with all that each may mean, of which an unknown one has nothing.

    Numbers that belong to no name are left out, and words that change nothing.
    """
    every, at = tokens(header), 0
    longest = max(map(len, [*WORDS, *names]))
    while at < len(every):
        for end in range(min(len(every), at + longest), at, -1):
            part = every[at:end]
            meanings = names.get(_key(part), frozenset()) | WORDS.get(tuple(map(plain, part)), frozenset())
            if meanings:
                break
        text, at = " ".join(part), end
        if meanings or not text.isdigit():
            together = [meanings] if meanings else known_parts(plain(text)) or [meanings]
            yield from ((text, texts) for texts in together if texts != NOTHING)


@lru_cache(maxsize=4096)
def known_parts(word: str) -> tuple[Meanings, ...]:
    """The meanings of known words that are written together in one, as in German and Chinese; () if any is unknown."""
    if (word,) in WORDS:
        return (WORDS[word,],)
    least = SHORTEST if word.isascii() else SHORTEST_FOREIGN
    for cut in range(len(word) - least, least - 1, -1):
        first = WORDS.get((word[:cut],))
        if first and (rest := known_parts(word[cut:])):
            return (first, *rest)
    return ()
