"""The JSON schema of a linkage file, made from the model that reads it; for editors, which complete and check by it.

In Draft 4, the newest that taplo knows (Even Better TOML in VS Code). Keys are described in the words of the
messages about it.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any, Final

from analytic.description.diagnosis import EXPECTED
from analytic.description.repetition import MOST_COPIES, REPEATED
from analytic.description.schema import Document
from analytic.description.units import UNITS

TITLE: Final = "linkproof linkage file"
FORMULA: Final = {"type": "string", "pattern": r"\{.*\}"}
Schema = dict[str, Any]


def json_schema() -> Schema:
    """The schema of a whole file, its variants and repeated parts included."""
    made = Document.model_json_schema(ref_template="#/definitions/{model}")
    definitions: Schema = {name: _draft_4(table) for name, table in made.pop("$defs").items()}
    document = definitions["Document"] = _draft_4(made)
    for kind, units in UNITS.items():
        definitions["UnitsTable"]["properties"][kind] |= {"enum": list(units)}
    _describe(document, definitions, "")
    variant = _changed_copy("Document", "Variant", definitions, _without_required_keys)
    repeated = _changed_copy("Document", "Repeated", definitions, _with_formulas)
    parts = {key: part for key, part in definitions[repeated]["properties"].items() if key in REPEATED}
    count = {"type": "integer", "minimum": 1, "maximum": MOST_COPIES, "description": "how many copies: n = 1, 2, ..."}
    definitions[repeated] = definitions[repeated] | {"properties": {"count": count, **parts}, "required": ["count"]}
    document["properties"] |= {
        "variants": _tables_by_name(
            variant, "a table [variants.NAME] with the keys that differ from the file's values"
        ),
        "repeat": _tables_by_name(
            repeated, "a table [repeat.NAME] with count copies of its parts; {n} is a copy's number"
        ),
    }
    document["oneOf"] = [{"required": ["crank"]}, {"required": ["cylinder"]}]
    head: Schema = {"$schema": "http://json-schema.org/draft-04/schema#", "title": TITLE}
    return {**head, **definitions.pop("Document"), "definitions": definitions}


def _tables_by_name(definition: str, description: str) -> Schema:
    """The schema of a table whose keys are free names and whose values are all of one definition."""
    return {
        "type": "object",
        "additionalProperties": {"$ref": f"#/definitions/{definition}"},
        "description": description,
    }


def _draft_4(part: Any) -> Any:  # noqa: ANN401 - any part of a schema
    """A part of a schema of pydantic's in the words of Draft 4, without nulls, which TOML has not."""
    if isinstance(part, list):
        return [_draft_4(entry) for entry in part]
    if not isinstance(part, dict):
        return part
    part = {key: _draft_4(value) for key, value in part.items() if key != "title" or isinstance(value, dict)}
    if part.get("default", 0) is None:
        del part["default"]
    choices = [entry for entry in part.get("anyOf", ()) if entry != {"type": "null"}]
    if len(choices) == 1:
        part = {key: value for key, value in part.items() if key != "anyOf"} | choices[0]
    elif choices:
        part["anyOf"] = choices
    if "prefixItems" in part:
        part["items"] = part.pop("prefixItems")[0]  # all alike: pairs of numbers or of names
    if "const" in part:
        part["enum"] = [part.pop("const")]
    for bound in ("exclusiveMinimum", "exclusiveMaximum"):
        if bound in part and not isinstance(part[bound], bool):
            part[bound.replace("exclusiveM", "m")], part[bound] = part[bound], True
    return part


def _describe(table: Schema, definitions: Schema, outermost: str) -> None:
    """Give every key of a table, and of those in it, the phrase that messages have for it."""
    for key, part in table.get("properties", {}).items():
        root = outermost or key
        phrase = EXPECTED.get(f"{root}.{key}", EXPECTED.get(key))
        if phrase:
            part.setdefault("description", phrase)
        for name in _tables_in(part):
            _describe(definitions[name], definitions, root)


def _tables_in(part: object) -> list[str]:
    """Names of the definitions that a part refers to."""
    if isinstance(part, Mapping):
        direct = [str(part["$ref"]).rpartition("/")[2]] if "$ref" in part else []
        return direct + [name for value in part.values() for name in _tables_in(value)]
    return [name for entry in part for name in _tables_in(entry)] if isinstance(part, list) else []


def _changed_copy(name: str, prefix: str, definitions: Schema, change: Callable[[Schema, str], Any]) -> str:
    """Copy a definition and all that it refers to, each changed, under names with ``prefix``; returns its name."""
    copy = f"{prefix}{name}"
    if copy not in definitions:
        definitions[copy] = {}  # so that a circle ends
        definitions[copy] = change(definitions[name], prefix)
        for key in _tables_in(definitions[copy]):
            if key.startswith(prefix):
                _changed_copy(key.removeprefix(prefix), prefix, definitions, change)
    return copy


def _without_required_keys(part: Any, prefix: str) -> Any:  # noqa: ANN401 - any part of a schema
    """A part of the schema for a variant, where no key is required; references go to definitions with ``prefix``.

    Tables in lists keep their required keys: a variant replaces lists whole.
    """
    if not isinstance(part, dict):
        return part
    looser = {key: _without_required_keys(value, prefix) for key, value in part.items() if key != "required"}
    if "items" in part:
        looser["items"] = part["items"]
    if "anyOf" in part:
        looser["anyOf"] = [_without_required_keys(entry, prefix) for entry in part["anyOf"]]
    return _redirected(looser, prefix)


def _with_formulas(part: Any, prefix: str) -> Any:  # noqa: ANN401 - any part of a schema
    """A part of the schema for [repeat]: formulas may stand for numbers; ``prefix`` leads to the copies with them."""
    if isinstance(part, list):
        return [_with_formulas(entry, prefix) for entry in part]
    if not isinstance(part, dict):
        return part
    if part.get("type") in ("number", "integer"):
        return {"anyOf": [part, FORMULA]}
    return _redirected({key: _with_formulas(value, prefix) for key, value in part.items()}, prefix)


def _redirected(part: Schema, prefix: str) -> Schema:
    """A part whose reference to a definition goes to the changed copy, whose name begins with ``prefix``."""
    if isinstance(part.get("$ref"), str):
        part["$ref"] = part["$ref"].replace("#/definitions/", f"#/definitions/{prefix}")
    return part
