"""Reading a linkage file: TOML, then the variant, then validation, then SI units and the joints it implies."""

from __future__ import annotations

import tomllib
from collections.abc import Mapping
from functools import lru_cache
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from analytic.document import EXPECTED, Document
from analytic.errors import DescriptionError, UnknownNameError
from analytic.interpretation import interpret
from analytic.linkage import Linkage

CATALOGUE = Path(__file__).parent / "catalogue"


def catalogue() -> tuple[str, ...]:
    """Names of the mechanisms that come with the suite, sorted."""
    return tuple(sorted(path.stem for path in CATALOGUE.glob("*.toml")))


def find(name: str) -> Path:
    """Path of a mechanism: a catalogue name, or the path of a user's own ``.toml`` file."""
    path = Path(name)
    if path.suffix == ".toml" or path.parent != Path():
        if not path.is_file():
            raise DescriptionError(f"no linkage file at '{name}': give the path of a .toml file that exists")
        return path
    if name not in catalogue():
        raise UnknownNameError("mechanism", name, catalogue())
    return CATALOGUE / f"{name}.toml"


def load(name: str, variant: str | None = None) -> Linkage:
    """Read a mechanism by catalogue name or path, in the variant asked for (its first one if None).

    Raises DescriptionError, with the file's line where one is known, or UnknownNameError.
    """
    path = find(str(name))
    try:
        text = path.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        raise DescriptionError(f"{path}: expected a readable UTF-8 text file ({error}); check the path") from error
    return parse(text, path.stem, str(path) if path.parent != CATALOGUE else path.name, variant)


@lru_cache(maxsize=64)
def parse(text: str, name: str, origin: str, variant: str | None = None) -> Linkage:
    """Turn a file's text into a Linkage; ``origin`` names the file in messages."""
    try:
        raw = tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        raise DescriptionError(f"{origin}: not valid TOML: {error}; correct that line") from error
    overlays = raw.pop("variants", {})
    base_name = str(raw.get("variant", "base"))
    if not isinstance(overlays, dict) or not all(isinstance(part, dict) for part in overlays.values()):
        raise DescriptionError(
            f"{origin}: variants: expected tables [variants.NAME...], got {overlays!r}; write them so"
        )
    names = (base_name, *sorted(overlays))
    chosen = base_name if variant is None else variant
    if chosen not in names:
        raise UnknownNameError(f"variant of '{name}'", chosen, names)
    if chosen != base_name:
        raw = _overlaid(raw, overlays[chosen], f"{origin}: variant '{chosen}'")
        raw["variant"] = chosen
    return interpret(_validated(raw, text, origin), name, names, origin)


def _overlaid(base: Mapping[str, Any], over: Mapping[str, Any], where: str) -> dict[str, Any]:
    """The base document with a variant's keys laid over it, table by table; lists are replaced whole."""
    for link in over.get("links", {}):
        if link not in base.get("links", {}) and "points" not in over["links"][link]:
            raise DescriptionError(f"{where}: {UnknownNameError('link', link, base.get('links', {}))}")
    return _merged(base, over)


def _merged(base: Mapping[str, Any], over: Mapping[str, Any]) -> dict[str, Any]:
    result = dict(base)
    for key, value in over.items():
        mergeable = isinstance(value, dict) and isinstance(result.get(key), dict)
        result[key] = _merged(result[key], value) if mergeable else value
    return result


def _validated(raw: Mapping[str, Any], text: str, origin: str) -> Document:
    try:
        return Document.model_validate(raw)
    except ValidationError as error:
        raise DescriptionError(_sentence(error, text, origin)) from None


def _sentence(error: ValidationError, text: str, origin: str) -> str:
    """The first fault of a document as one sentence: where, what was expected, what was got."""
    fault = error.errors(include_url=False)[0]
    keys = [str(key) for key in fault["loc"] if str(key) not in ("Polar",) and not str(key).startswith("tuple[")]
    where = f"{origin}{_line(text, keys)}: {'.'.join(keys)}"
    if fault["type"] == "extra_forbidden":
        known = _known_keys(keys[:-1])
        return f"{where}: {UnknownNameError('key', keys[-1], known)}"
    expected = next((EXPECTED[key] for key in reversed(keys) if key in EXPECTED), "")
    if fault["type"] == "missing":
        return f"{where} is missing: expected {expected or 'a value'}; add it"
    return f"{where}: expected {expected or fault['msg'].lower()}, got {fault['input']!r}; correct it"


def _known_keys(parents: list[str]) -> list[str]:
    """Keys that are allowed where an unknown one was found."""
    model: Any = Document
    for key in parents:
        fields = getattr(model, "model_fields", {})
        if key in fields:
            model = _table_of(fields[key].annotation)
    return sorted(getattr(model, "model_fields", {}))


def _table_of(annotation: Any) -> Any:
    """The table model inside an annotation such as ``dict[str, LinkTable]`` or ``Sketch | None``."""
    if hasattr(annotation, "model_fields"):
        return annotation
    inner = [_table_of(argument) for argument in getattr(annotation, "__args__", ())]
    return next((model for model in inner if hasattr(model, "model_fields")), None)


def _line(text: str, keys: list[str]) -> str:
    """Where a key stands in the file: the deepest header that matches, then the key below it; '' if not found."""
    lines = text.splitlines()
    names = [key for key in keys if not key.isdigit()]
    depth, start = 0, 0
    for number, line in enumerate(lines):
        header = line.strip().strip("[]").replace('"', "").split(".") if line.strip().startswith("[") else []
        if header and header == names[: len(header)] and len(header) > depth:
            depth, start = len(header), number
    for key in reversed(names[depth:]):
        for number in range(start, len(lines)):
            if number > start and lines[number].strip().startswith("["):
                break
            words = lines[number].split("#")[0].replace('"', " ").replace("{", " ").replace(",", " ").split()
            if key in [word.split("=")[0] for word in words]:
                return f", line {number + 1}"
    return f", line {start + 1}" if depth else ""
