"""Reading a linkage file: TOML, then the variant, then validation, then SI units and the joints it implies."""

from __future__ import annotations

import tomllib
from collections.abc import Mapping
from functools import lru_cache
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from analytic.description.conversion import interpret
from analytic.description.diagnosis import Source, sentence, shown
from analytic.description.linkage import Linkage
from analytic.description.schema import Document
from analytic.errors import DescriptionError, UnknownNameError

CATALOGUE = Path(__file__).parents[1] / "catalogue"


def catalogue() -> tuple[str, ...]:
    """Names of the mechanisms that come with the suite, sorted."""
    return tuple(sorted(path.stem for path in CATALOGUE.glob("*.toml")))


def find(name: str) -> Path:
    """Path of a mechanism: a catalogue name, or the path of a user's own ``.toml`` file."""
    path = Path(name)
    if path.suffix.lower() == ".toml" or path.parent != Path():
        if not _is_file(path):
            raise DescriptionError(
                f"expected the path of a linkage file, got '{name}', which is no file; give the path of a .toml file "
                f"that exists, or one of the mechanisms {', '.join(catalogue())}"
            )
        return path
    if name not in catalogue():
        raise UnknownNameError("mechanism", name, catalogue())
    return CATALOGUE / f"{name}.toml"


def _is_file(path: Path) -> bool:
    try:
        return path.is_file()
    except (OSError, ValueError):  # a name too long for the system, or with a null character
        return False


def load(name: str, variant: str | None = None) -> Linkage:
    """Read a mechanism by catalogue name or path, in the variant asked for (its first one if None).

    Raises DescriptionError, with the file's line where one is known, or UnknownNameError.
    """
    path = find(str(name))
    try:
        text = path.read_text(encoding="utf-8-sig")
    except UnicodeDecodeError as error:
        raise DescriptionError(f"{path}: expected a text file in UTF-8, got other bytes; save it as UTF-8") from error
    except OSError as error:
        raise DescriptionError(f"{path}: expected a readable file, got '{error.strerror}'; check it") from error
    return parse(text, path.stem, str(path) if path.parent != CATALOGUE else path.name, variant)


@lru_cache(maxsize=64)
def parse(text: str, name: str, origin: str, variant: str | None = None) -> Linkage:
    """Turn a file's text into a Linkage; ``origin`` names the file in messages."""
    raw = _tables(text, origin)
    overlays = raw.pop("variants", {})
    base_name = str(raw.get("variant", "base"))
    if not isinstance(overlays, dict) or not all(isinstance(part, dict) for part in overlays.values()):
        raise DescriptionError(
            f"{origin}: variants: expected tables [variants.NAME], got {shown(overlays)}; write them so"
        )
    if base_name in overlays:
        raise DescriptionError(
            f"{origin}: variants: expected other names than '{base_name}', which is the file itself (key variant), got "
            f"[variants.{base_name}]; rename one of them"
        )
    names = (base_name, *sorted(overlays))
    chosen = base_name if variant is None else variant
    if chosen not in names:
        raise UnknownNameError(f"variant of '{name}'", chosen, names)
    if chosen != base_name:
        _check_links(raw.get("links"), overlays[chosen].get("links"), f"{origin}: variant '{chosen}'")
        raw = _merged(raw, overlays[chosen])
        raw["variant"] = chosen
    source = Source(origin, text, None if chosen == base_name else chosen)
    return interpret(_validated(raw, source), name, names, source)


def _tables(text: str, origin: str) -> dict[str, Any]:
    """The file as nested dictionaries."""
    if not text.strip():
        raise DescriptionError(
            f"{origin}: expected a linkage description, got an empty file; start from a catalogue file"
        )
    try:
        return tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        raise DescriptionError(
            f"{origin}: expected valid TOML, got a slip of syntax: {error}; correct it there"
        ) from error
    except RecursionError:
        raise DescriptionError(
            f"{origin}: expected tables and short lists, got very deep nesting; flatten it"
        ) from None


def _check_links(base: object, over: object, where: str) -> None:
    """A variant's link of another name is a slip, unless it is a whole new link."""
    if isinstance(base, dict) and isinstance(over, dict):
        for link, table in over.items():
            if link not in base and not (isinstance(table, dict) and "mass" in table):
                raise DescriptionError(f"{where}: {UnknownNameError('link', link, base)}")


def _merged(base: Mapping[str, Any], over: Mapping[str, Any]) -> dict[str, Any]:
    """The base document with a variant's keys laid over it, table by table; lists are replaced whole."""
    result = dict(base)
    for key, value in over.items():
        mergeable = isinstance(value, dict) and isinstance(result.get(key), dict)
        result[key] = _merged(result[key], value) if mergeable else value
    return result


def _validated(raw: Mapping[str, Any], source: Source) -> Document:
    try:
        return Document.model_validate(raw)
    except ValidationError as error:
        raise DescriptionError(sentence(error, source)) from None
