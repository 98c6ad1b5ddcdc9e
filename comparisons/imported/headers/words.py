"""A header as words that mean something: names of the linkage, words of several languages, and what is left over."""

from __future__ import annotations

import re
import tomllib
import unicodedata
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Final

from analytic.description.linkage import GROUND, Linkage

_WORDS: Final = tomllib.loads(Path(__file__).with_name("words.toml").read_text(encoding="utf-8"))
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
        for word in table["words"]:
            meanings.setdefault(" ".join(plain(word).split()), set()).add(meaning)
    return meanings


MEANINGS: Final[Mapping[str, set[str]]] = _meanings()
STEMS: Final = tuple(sorted((word[:-1] for word in MEANINGS if word.endswith("*")), key=len, reverse=True))
MOST_WORDS: Final = max(word.count(" ") for word in MEANINGS) + 1
LONGEST_TOKEN: Final = 40  # letters of words written together
SHORTEST_PART: Final = 3  # Latin letters of a word inside another


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
    parts = [part for piece in CAMEL.split(token) for part in _parts(piece)]
    return 1, parts


def _phrase(tokens: Iterable[str]) -> set[str]:
    return set(MEANINGS.get(plain(" ".join(tokens)), ()))


@lru_cache(maxsize=4096)
def _parts(token: str) -> tuple[Word, ...]:
    """A token as known words written together, else as one unknown word."""
    text = plain(token)
    if len(text) > LONGEST_TOKEN:
        return (Word(token),)
    best: list[tuple[Word, ...] | None] = [()] + [None] * len(text)
    for end in range(1, len(text) + 1):
        for start in range(end):
            before = best[start]
            word = _word(text[start:end], is_whole=end - start == len(text), is_last=end == len(text))
            if before is not None and word and (best[end] is None or len(before) + 1 < len(best[end] or ())):
                best[end] = (*before, word)
    return best[-1] or (Word(token),)


def means_something(token: str) -> bool:
    """Whether a token is a known word, or several written together; a Latin one has more than three letters."""
    is_long = SHORTEST_PART < len(token) <= LONGEST_TOKEN or not plain(token).isascii()
    return is_long and all(word.meanings for word in _parts(token))


def _word(text: str, *, is_whole: bool, is_last: bool) -> Word | None:
    if not is_whole and text.isascii() and len(text) < SHORTEST_PART:
        return None
    meanings = MEANINGS.get(text)
    if meanings is None and is_last:
        stem = next((stem for stem in STEMS if text.startswith(stem) and len(text) <= len(stem) + 5), None)
        meanings = MEANINGS[f"{stem}*"] if stem else None
    return Word(text, frozenset(meanings)) if meanings else None


def bodies(found: Iterable[Word], kind: str) -> Iterator[str]:
    """Names of a kind among the words of a header, the ground left out."""
    return (word.text for word in found if word.kind == kind and word.text != GROUND)
