"""The JSON schema of a linkage file, made from the model that reads it; for editors, which complete and check by it.

In Draft 4, the newest that taplo knows (Even Better TOML in VS Code). Keys are described in the words of the
messages about it.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Final

from analytic.description.diagnosis import EXPECTED
from analytic.description.schema import Document
from analytic.description.units import UNITS

TITLE: Final = "linkproof linkage file"
VARIANT: Final = "Variant"  # before the names of definitions in which no key is required
Schema = dict[str, Any]


def json_schema() -> Schema:
    """The schema of a whole file, its variants included, as a new dictionary."""
    made = Document.model_json_schema(ref_template="#/definitions/{model}")
    definitions: Schema = {name: _draft_4(table) for name, table in made.pop("$defs").items()}
    document = definitions["Document"] = _draft_4(made)
    for kind, units in UNITS.items():
        definitions["UnitsTable"]["properties"][kind] |= {"enum": list(units)}
    _describe(document, definitions, "")
    document["properties"]["variants"] = {
        "type": "object",
        "additionalProperties": {"$ref": f"#/definitions/{_variant_of('Document', definitions)}"},
        "description": "a table [variants.NAME] with the keys that differ from the file's values",
    }
    document["oneOf"] = [{"required": ["crank"]}, {"required": ["cylinder"]}]
    head: Schema = {"$schema": "http://json-schema.org/draft-04/schema#", "title": TITLE}
    return {**head, **definitions.pop("Document"), "definitions": definitions}


def _draft_4(part: Any) -> Any:  # noqa: ANN401 - any part of a schema
    """A copy of a part of pydantic's JSON schema, rewritten for Draft 4, without titles.

    Null is dropped as a type and as a default, since TOML has none.
    """
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
    """Give every key of a table, and of the tables in it, the description that error messages use; in place.

    A key that has a description, or for which there is none, stays as it is. ``definitions`` are the schema's tables by
    name, ``outermost`` is the key of the file in which the table stands; "" for the file itself.
    """
    for key, part in table.get("properties", {}).items():
        root = outermost or key
        phrase = EXPECTED.get(f"{root}.{key}", EXPECTED.get(key))
        if phrase:
            part.setdefault("description", phrase)
        for name in _tables_in(part):
            _describe(definitions[name], definitions, root)


def _tables_in(part: object) -> list[str]:
    """Names of the definitions that a part refers to, in order, with repetitions."""
    if isinstance(part, Mapping):
        direct = [str(part["$ref"]).rpartition("/")[2]] if "$ref" in part else []
        return direct + [name for value in part.values() for name in _tables_in(value)]
    return [name for entry in part for name in _tables_in(entry)] if isinstance(part, list) else []


def _variant_of(name: str, definitions: Schema) -> str:
    """Add to ``definitions`` a copy of one, and of all that it refers to, without required keys.

    Returns the copy's name.
    """
    copy = f"{VARIANT}{name}"
    if copy not in definitions:
        definitions[copy] = {}  # so that a circle ends
        definitions[copy] = _without_required_keys(definitions[name])
        for key in _tables_in(definitions[copy]):
            if key.startswith(VARIANT):
                _variant_of(key.removeprefix(VARIANT), definitions)
    return copy


def _without_required_keys(part: Any) -> Any:  # noqa: ANN401 - any part of a schema
    """A copy of a part of the schema, for a variant: no key is required, references go to the variant's definitions.

    Tables in lists keep their required keys: a variant replaces lists whole.
    """
    if not isinstance(part, dict):
        return part
    looser = {key: _without_required_keys(value) for key, value in part.items() if key != "required"}
    if "items" in part:
        looser["items"] = part["items"]
    if "anyOf" in part:
        looser["anyOf"] = [_without_required_keys(entry) for entry in part["anyOf"]]
    if isinstance(looser.get("$ref"), str):
        looser["$ref"] = looser["$ref"].replace("#/definitions/", f"#/definitions/{VARIANT}")
    return looser
