"""What a model's building does to an engine's objects, written down as Python source.

While :meth:`Transcript.on` lasts, imports of the engine's package give stand-ins. Whatever is got from these is a
stand-in too; what is called or set on them is done to the real objects and noted as a line. Numbers and text come
back as they are, so that what is computed from them appears in later lines as literals. An array of the engine's notes
what is put into it.

A function of ours that an engine is given has to bring its text (:class:`Sourced`).
"""

from __future__ import annotations

import importlib
import keyword
import re
import sys
import unicodedata
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from types import ModuleType
from typing import Any

import numpy as np

from engines.stepping.driver import UnsupportedError

OPEN, CLOSE = "\ue000", "\ue001"  # around the number of a variable in a text, until it gets its name
VARIABLE = re.compile(f"{OPEN}(\\d+){CLOSE}")
TEXT = r"""'(?:[^'\\\n]|\\.)*'|"(?:[^"\\\n]|\\.)*\""""  # on one line, as ``literal`` writes it
BLOCK_QUOTE, BACKSLASHED = re.compile(r'"(?=""|\Z)'), r"\\\g<0>"  # one that would end a text of several lines
LONGEST = 300  # characters of a line that takes up the one before it
# Methods of the engines that only look something up.
LOOK = re.compile(r"\.((?i:get|num|calc|compute|is|express)\w*|joint|body|equality)$")
DEPTH = 4  # of a world in which names are looked for


@dataclass(frozen=True)
class Sourced:
    """A function of ours that an engine is given, with its text for a script."""

    call: Callable[..., Any]
    source: str

    def __call__(self, *given: object) -> Any:  # noqa: ANN401
        """What the function returns."""
        return self.call(*given)


@dataclass
class _Line:
    target: int | None
    text: str
    is_plain: bool = False  # a new object, or one looked up, without other effect


@dataclass
class Transcript:
    """The lines so far; ``package`` is the engine's."""

    package: str
    lines: list[_Line] = field(default_factory=list)
    kinds: list[str] = field(default_factory=list)  # of each variable, a first name
    imports: dict[int, tuple[str, str]] = field(default_factory=dict)  # variables that are imported: statement, name
    known: dict[int, Any] = field(default_factory=dict)  # by identity of what they stand for
    real: dict[str, ModuleType] = field(default_factory=dict)

    @contextmanager
    def on(self) -> Iterator[None]:
        """Stand-ins for the package's modules, which have to be imported already."""
        importlib.import_module(self.package)
        prefix = f"{self.package}."
        self.real = {name: each for name, each in sys.modules.items() if f"{name}.".startswith(prefix)}
        stand_ins = {name: self._imported(each, f"import {name}", name) for name, each in self.real.items()}
        sys.modules.update(stand_ins)
        try:
            yield
        finally:
            sys.modules.update(self.real)

    @contextmanager
    def off(self) -> Iterator[None]:
        """The real modules, for what the engine imports itself."""
        stand_ins = {name: sys.modules[name] for name in self.real}
        sys.modules.update(self.real)
        try:
            yield
        finally:
            sys.modules.update(stand_ins)

    def wrapped(self, real: Any, text: str) -> Any:  # noqa: ANN401 - what is recorded is anybody's
        """A stand-in for what the engine gave, which is had by ``text``; numbers and text are themselves."""
        if id(real) in self.known:
            return self.known[id(real)]
        if isinstance(real, np.ndarray):
            noted = real.view(_NotedArray)
            noted.transcript, noted.text = self, text
            return noted
        if isinstance(real, type) and issubclass(real, BaseException):
            return real
        if not (isinstance(real, list) or callable(real) or self.is_ours(real)):
            return real
        stand_in = StandIn(self, real, text)
        if isinstance(real, type) or self.is_ours(real):
            self.known[id(real)] = stand_in
        return stand_in

    def is_ours(self, real: object) -> bool:
        """Whether something is an object of the engine's."""
        return type(real).__module__.partition(".")[0] == self.package and not isinstance(
            real, (int, float, str, tuple)
        )

    def called(self, real: Any, text: str, is_plain: bool) -> Any:  # noqa: ANN401
        """Note a call and stand in for its result."""
        if id(real) in self.known or not (callable(real) or isinstance(real, list) or self.is_ours(real)):
            self.lines.append(_Line(None, text, is_plain))
            return self.known.get(id(real), real)
        number = self._variable(type(real).__name__)
        self.lines.append(_Line(number, text, is_plain))
        self.known[id(real)] = StandIn(self, real, f"{OPEN}{number}{CLOSE}")
        return self.known[id(real)]

    def found(self, module: ModuleType, name: str) -> Any:  # noqa: ANN401
        """What a module has by a name."""
        real = getattr(module, name)
        within = isinstance(module, ModuleType) and module.__name__ != self.package
        if id(real) in self.known or not within or not callable(real):
            return self.wrapped(real, f"{self.known[id(module)].source}.{name}")
        return self._imported(real, f"from {module.__name__} import {name}", name)

    def _imported(self, real: Any, statement: str, name: str) -> Any:  # noqa: ANN401
        number = self._variable(name)
        self.imports[number] = (statement, name)
        stand_in = StandIn(self, real, f"{OPEN}{number}{CLOSE}")
        self.known[id(real)] = stand_in
        return stand_in

    def _variable(self, kind: str) -> int:
        self.kinds.append(re.sub("(?<=[a-z])(?=[A-Z])", "_", kind.removesuffix("Index")).lower())
        return len(self.kinds) - 1

    def source(self, world: object, rest: str) -> tuple[list[str], list[str], str]:
        """The import statements, the lines, and the ``rest`` of a script that uses them, all with names.

        A variable that ``world`` holds is called as it is there.
        """
        told = dict(_told(world, DEPTH))
        held = {number for number, name in told.items() if "*" not in name}
        lines = self._joined(self._needed(rest, held), rest, held)
        text = "\n".join([*(line.text for line in lines), rest])
        used = {int(number) for number in VARIABLE.findall(text)}
        names = self._names(told, rest, used | {line.target for line in lines if line.target is not None})

        def named(text: str) -> str:
            return VARIABLE.sub(lambda found: names[int(found[1])], text)

        statements = sorted({statement for number, (statement, _) in self.imports.items() if number in used})
        statements = [folded(each) for each in _merged(statements)]
        whole = [
            f"{OPEN}{line.target}{CLOSE} = {line.text}" if line.target is not None else line.text for line in lines
        ]
        return statements, [folded(named(line)) for line in whole], named(rest)

    def _needed(self, rest: str, held: set[int]) -> list[_Line]:
        """The lines without those that only make what nobody uses; a result that nobody uses gets no name."""
        used = {int(number) for number in VARIABLE.findall(rest)}
        kept: list[_Line] = []
        for line in reversed(self.lines):
            if line.target not in used | held and line.is_plain:
                continue
            used |= {int(number) for number in VARIABLE.findall(line.text)}
            kept.append(_Line(line.target if line.target in used | held else None, line.text, line.is_plain))
        return kept[::-1]

    def _joined(self, lines: list[_Line], rest: str, held: set[int]) -> list[_Line]:
        """Lines whose result only the next one uses, written into it, but for what the world holds by a name."""
        everything = "\n".join([*(line.text for line in lines), rest])
        uses: dict[int | None, int] = {}
        for number in VARIABLE.findall(everything):
            uses[int(number)] = uses.get(int(number), 0) + 1
        result: list[_Line] = []
        for line in lines:
            while result and result[-1].is_plain and uses.get(result[-1].target) == 1 and result[-1].target not in held:
                token = f"{OPEN}{result[-1].target}{CLOSE}"
                text = line.text.replace(token, result[-1].text)
                if token not in line.text or len(VARIABLE.sub("x" * 12, text)) > LONGEST:
                    break
                line = _Line(line.target, text, line.is_plain)  # noqa: PLW2901
                result.pop()
            result.append(line)
        return result

    def _names(self, told: Mapping[int, str], rest: str, used: set[int]) -> dict[int, str]:
        """A name for every variable: what the world calls it, else its kind with a number."""
        names = {number: name for number, (_, name) in self.imports.items()}
        taken = {*re.findall(r"[^\W\d]\w*", re.sub(f"{TEXT}|#.*", "", rest)), *names.values(), *keyword.kwlist}
        counts: dict[str, int] = {}
        for number in sorted(used - names.keys()):
            kind = self.kinds[number]
            key = told.get(number, "").removesuffix("_*")
            name = f"{key}_{kind}" if told.get(number) != key != kind else key
            name = re.sub(r"\W+", "_", unicodedata.normalize("NFKC", name)).strip("_")  # as Python reads it
            while not name.isidentifier() or name in taken:
                counts[kind] = counts.get(kind, 0) + 1
                name = f"{kind}_{counts[kind]}" if counts[kind] > 1 else kind
            names[number] = name
            taken.add(name)
        return names


def _merged(statements: Sequence[str]) -> Iterator[str]:
    """Import statements, one for each module; those of whole modules first."""
    modules: dict[str, list[str]] = {}
    for statement in statements:
        module, _, name = statement.removeprefix("from ").partition(" import ")
        modules.setdefault(module, []).append(name)
    for module, names in sorted(modules.items(), key=lambda item: item[1] != [""]):
        together = ", ".join(names)
        yield f"from {module} import {f'({together})' if len(names) > 1 else together}" if together else module


def _told(value: object, depth: int, hint: str = "") -> Iterator[tuple[int, str]]:
    """Names of variables in a world: an attribute's, or what a mapping has them by, "*" standing for their kind."""
    if isinstance(value, StandIn):
        found = VARIABLE.fullmatch(value.source)
        if found and hint:
            yield int(found[1]), hint
        return
    if not depth:
        return
    inside: Mapping[str, object] = {}
    if isinstance(value, dict):
        inside = {f"{key}_*": each for key, each in value.items() if isinstance(key, str)}
    elif type(value).__module__.startswith("engines."):
        inside = dict(getattr(value, "__dict__", {}))
    # What is named of itself comes last: of a variable's names the last one counts.
    for name, each in sorted(inside.items(), key=lambda item: isinstance(item[1], StandIn)):
        yield from _told(each, depth - 1, hint if hint.endswith("*") else name)


class StandIn:
    """What stands in for something of the engine's."""

    __slots__ = ("_real", "_source", "_transcript")

    def __init__(self, transcript: Transcript, real: object, source: str) -> None:
        for name, value in (("_transcript", transcript), ("_real", real), ("_source", source)):
            object.__setattr__(self, name, value)

    @property
    def source(self) -> str:
        """The text that stands for it in a script."""
        return str(object.__getattribute__(self, "_source"))

    def __str__(self) -> str:
        return self.source

    def __getattr__(self, name: str) -> Any:  # noqa: ANN401
        if name.startswith("__"):
            return getattr(self._real, name)
        if isinstance(self._real, ModuleType):
            return self._transcript.found(self._real, name)
        return self._transcript.wrapped(getattr(self._real, name), f"{self.source}.{name}")

    def __setattr__(self, name: str, value: object) -> None:
        setattr(self._real, name, bare(value))
        self._transcript.lines.append(_Line(None, f"{self.source}.{name} = {literal(value)}"))

    def __call__(self, *given: object, **named: object) -> Any:  # noqa: ANN401, D102
        words = [*map(literal, given), *(f"{name}={literal(value)}" for name, value in named.items())]
        text = f"{self.source}({', '.join(words)})"
        with self._transcript.off():
            real = self._real(*map(bare, given), **{name: bare(value) for name, value in named.items()})
        return self._transcript.called(real, text, isinstance(self._real, type) or bool(LOOK.search(self.source)))

    def __getitem__(self, key: object) -> Any:  # noqa: ANN401
        return self._transcript.wrapped(self._real[bare(key)], f"{self.source}[{_key(key)}]")

    def __setitem__(self, key: object, value: object) -> None:
        self._real[bare(key)] = bare(value)
        self._transcript.lines.append(_Line(None, f"{self.source}[{_key(key)}] = {literal(value)}"))

    def __len__(self) -> int:
        return len(self._real)

    def __bool__(self) -> bool:
        return bool(self._real)

    def __iter__(self) -> Iterator[Any]:
        return (self[number] for number in range(len(self)))

    def __int__(self) -> int:
        return int(self._real)


class _NotedArray(np.ndarray):
    """An array of the engine's; parts of it and what is computed from it are ordinary arrays."""

    transcript: Transcript | None = None
    text = ""

    def __setitem__(self, key: Any, value: Any) -> None:  # noqa: ANN401
        super().__setitem__(key, value)
        if self.transcript is not None:
            self.transcript.lines.append(_Line(None, f"{self.text}[{_key(key)}] = {literal(value)}"))


def bare(value: Any) -> Any:  # noqa: ANN401
    """What a stand-in stands for, also within lists, tuples and mappings; all else as it is."""
    if isinstance(value, StandIn):
        return object.__getattribute__(value, "_real")
    if type(value) in (list, tuple):
        return type(value)(map(bare, value))
    return {key: bare(each) for key, each in value.items()} if type(value) is dict else value


def literal(value: Any) -> str:  # noqa: ANN401, PLR0911
    """A value as Python source; raises UnsupportedError for what has none."""
    if isinstance(value, StandIn):
        return value.source
    if isinstance(value, np.ndarray):
        inner = literal(value.tolist())
        return f"np.array({inner})" if value.ndim else inner
    if isinstance(value, np.generic):
        return literal(value.item())
    if isinstance(value, dict):
        return "{" + ", ".join(f"{literal(key)}: {literal(each)}" for key, each in value.items()) + "}"
    if isinstance(value, (list, tuple)):
        inner = ", ".join(map(literal, value))
        return f"[{inner}]" if isinstance(value, list) else f"({inner},)" if len(value) == 1 else f"({inner})"
    if isinstance(value, float) and not np.isfinite(value):
        return f'float("{value}")'
    if isinstance(value, str):
        return _quoted(value)
    if value is None or isinstance(value, (bool, int, float, complex)):
        return repr(value)
    if isinstance(value, Sourced):
        return value.source
    raise UnsupportedError(f"the engine is given a {type(value).__name__} of the adapter's, which a script cannot hold")


def _quoted(text: str) -> str:
    """A text as Python source, whatever is in it; one of several lines on as many."""
    if "\n" not in text:
        quoted = repr(text)
        return quoted if '"' in text else f'"{quoted[1:-1]}"'
    shown = "".join(c if c == "\n" or (c.isprintable() and c != "\\") else repr(c)[1:-1] for c in text)
    return f'"""{BLOCK_QUOTE.sub(BACKSLASHED, shown)}"""'


def _key(value: Any) -> str:  # noqa: ANN401
    """What stands in brackets behind an array."""
    if isinstance(value, tuple):
        return ", ".join(map(_key, value))
    if isinstance(value, slice):
        return ":".join("" if each is None else literal(each) for each in (value.start, value.stop))
    return literal(value)


def folded(line: str, width: int = 118) -> str:
    """A long line in several, broken behind commas within brackets and outside text."""
    if len(line) <= width or "\n" in line:
        return line
    pieces = re.findall(rf"(?:{TEXT}|[^,\"'])*,? *", line)
    rows = [""]
    for piece in filter(None, pieces):
        if rows[-1] and len(rows[-1]) + len(piece.rstrip()) > width:
            rows.append("    ")
        rows[-1] += piece
    return "\n".join(row.rstrip() for row in rows)
