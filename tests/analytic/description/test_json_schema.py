"""The JSON schema takes every file that linkproof reads, and refuses what linkproof refuses for its keys and kinds."""

import tomllib

import pytest
from jsonschema import Draft4Validator

from analytic.description.json_schema import json_schema
from analytic.description.loading import CATALOGUE, LITERATURE
from analytic.description.schema import Document
from analytic.description.units import UNITS
from tests.analytic.linkages import FOLDER, JUKI

SCHEMA = json_schema()
VALIDATOR = Draft4Validator(SCHEMA)
FILES = sorted(path for folder in (CATALOGUE, LITERATURE, FOLDER) for path in folder.glob("*.toml"))


def faults(text):
    return [error.message for error in VALIDATOR.iter_errors(tomllib.loads(text))]


def test_the_schema_itself():
    Draft4Validator.check_schema(SCHEMA)
    assert not {"$defs", "prefixItems", "const"} & set(str(SCHEMA).replace("'", " ").split())


def test_every_file_that_is_read_is_valid():
    assert {path.name: faults(path.read_text(encoding="utf-8")) for path in FILES} == {path.name: [] for path in FILES}


@pytest.mark.parametrize(
    ("old", "new", "fault"),
    [
        ("inertia = 0.64e-4", "inertai = 0.64e-4", "'inertai' was unexpected"),
        ('length = "mm"', 'length = "MM"', "'MM' is not one of ['m', 'cm', 'mm', 'um', 'in', 'ft']"),
        ("mass    = 0.64", 'mass = "{n}"', "'{n}' is not of type 'number'"),
        ("mass    = 0.64", "mass = -1", "-1 is less than the minimum of 0"),
        ('crank   = "crank"\n', "", "is not valid under any of the given schemas"),
        ("A = [15.5, 0]", "A = [15.5, 0, 1]", "is not valid under any of the given schemas"),
        ("centre = [-12.9, 0]", "center = [-12.9, 0]", "'center' was unexpected"),
        ("through = [0, 0], ", "", "'through' is a required property"),
    ],
)
def test_what_is_refused(old, new, fault):
    assert old in JUKI
    assert any(fault in message for message in faults(JUKI.replace(old, new, 1)))


def test_a_variant_may_change_a_part_of_a_table():
    assert faults(JUKI + "\n[variants.x.links.crank]\npoints = { A = { angle = 3 } }\n") == []


def test_it_completes_units_and_choices_and_says_what_each_key_is():
    definitions = SCHEMA["definitions"]
    assert definitions["UnitsTable"]["properties"]["mass"]["enum"] == list(UNITS["mass"])
    assert definitions["ThreadTable"]["properties"]["feed"]["enum"] == ["shortening", "lengthening"]
    tables = {name: part for name, part in definitions.items() if not name.startswith("Variant")}
    keys = {f"{name}.{key}": part for name, table in tables.items() for key, part in table["properties"].items()}
    keys |= SCHEMA["properties"]
    assert set(Document.model_fields) | {"variants"} == set(SCHEMA["properties"])
    silent = [key for key, part in keys.items() if "description" not in part]
    assert silent == []
