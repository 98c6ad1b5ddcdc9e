"""Linkage files by path and by name, their variants, and names of files that do not exist."""

import os
import re

import pytest

from analytic.description.loading import catalogue, find, literature, load, parse, read
from analytic.errors import DescriptionError, LinkproofError, UnknownNameError
from tests.analytic.faults import JUKI
from tests.analytic.linkages import FOLDER


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("juki", "unknown mechanism 'juki': did you mean 'juki-mf7923d'? known are"),
        ("andrew-squeezer", "did you mean 'andrews-squeezer'"),
        ("", "unknown mechanism '': known are"),
        ("mine.toml", "got 'mine.toml', which does not exist; check the path"),
        ("no/such/folder/mine", "expected the path of a linkage file, whose name ends in .toml, or one of the mech"),
        ("x" * 5000 + ".toml", "which does not exist"),
        ("a\0b.toml", r"got 'a\x00b.toml', which does not exist"),
        ("a-folder.toml", "which is a folder; check the path"),
        ("linkages", "expected the path of a linkage file, got the folder 'linkages'; name its"),
        ("bytes.toml", "expected a text file in UTF-8, got other bytes; save it as UTF-8"),
    ],
)
def test_a_file_that_cannot_be_read(tmp_path, monkeypatch, name, words):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "linkages").mkdir()
    (tmp_path / "a-folder.toml").mkdir()
    (tmp_path / "bytes.toml").write_bytes(bytes(range(256)))
    with pytest.raises(LinkproofError, match=re.escape(words)):
        load(name)


def test_a_file_may_begin_with_a_byte_order_mark_and_is_read_once(tmp_path):
    path = tmp_path / "mine.toml"
    path.write_text("\ufeff" + JUKI, encoding="utf-8")
    file = read(str(path))
    assert (file.text, load(str(path)).name) == (JUKI, "mine")
    assert parse("\ufeff" + JUKI, "mine", "mine.toml") == load(str(path))
    path.unlink()
    assert [file.linkage(variant).variant for variant in (None, "as-printed")] == ["as-built", "as-printed"]


def test_a_file_name_that_is_not_utf_8(tmp_path):
    path = tmp_path / os.fsdecode(b"caf\xe9.toml")
    path.write_text(JUKI.replace("mass    = 0.64", "mass    = -1"), encoding="utf-8")
    with pytest.raises(DescriptionError, match=r"caf\\udce9.toml:20: links.crank.mass") as error:
        load(str(path))
    str(error.value).encode()
    path.write_text(JUKI, encoding="utf-8")
    assert load(str(path)).name == r"caf\udce9"


def test_a_variant_overrides_some_keys_and_the_first_one_is_the_file_itself():
    built, printed = (load("juki-mf7923d", variant) for variant in (None, "as-printed"))
    assert built.variant == built.variants[0] == "as-built"
    assert built.links["coupler"].centre == (0.0129, 0.0)
    assert printed.links["coupler"].centre == (-0.0129, 0.0)
    assert printed.links["coupler"].mass == built.links["coupler"].mass


def test_catalogue_literature_and_paths():
    assert load(str(FOLDER / "scotch-yoke.toml")).name == "scotch-yoke"
    assert not set(literature()) & set(catalogue())
    assert read("andrews-squeezer").origin == "andrews-squeezer.toml"
    with pytest.raises(UnknownNameError):
        find("andrews")
