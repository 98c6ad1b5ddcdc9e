"""Data sheets come back from their file as they were; the message about a damaged file names its key."""

import json
import random
from dataclasses import replace

import numpy as np
import pytest

from analytic.errors import LinkproofError
from comparisons.datasheet.saved import FILE, load_sheets, save_sheets
from tests.reports.designs.samples import released_sheet


@pytest.fixture(scope="module")
def sheet():
    return released_sheet()


def test_a_sheet_comes_back_as_it_was(sheet, tmp_path):
    save_sheets(tmp_path, [sheet])
    (found,) = load_sheets(tmp_path)
    assert (tmp_path / FILE).stat().st_size < 400_000
    assert (found.linkage, found.is_turn) == (sheet.linkage, True)
    assert (found.figures, found.published, found.facts) == (sheet.figures, sheet.published, sheet.facts)
    assert np.allclose(found.values["Mkr"], sheet.values["Mkr"], rtol=1e-7)
    assert found.released["driven"].facts == sheet.released["driven"].facts


def test_what_is_not_a_number_comes_back_so(sheet, tmp_path):
    values = dict(sheet.values)
    values["Mkr"] = np.where(np.arange(len(values["Mkr"])) == 7, np.nan, values["Mkr"])
    save_sheets(tmp_path, [replace(sheet, values=values)])
    assert np.flatnonzero(np.isnan(load_sheets(tmp_path)[0].values["Mkr"])).tolist() == [7]


def test_the_key_of_a_damage_is_named(sheet, tmp_path):
    save_sheets(tmp_path, [sheet])
    document = json.loads((tmp_path / FILE).read_text())
    document["sheets"][0]["values"]["Mkr"] = "none"
    (tmp_path / FILE).write_text(json.dumps(document))
    with pytest.raises(LinkproofError, match=r"sheets\.0\.values\.Mkr.*run compare with --out again"):
        load_sheets(tmp_path)


def test_a_folder_without_a_file_and_a_file_of_another_version_are_refused_in_one_sentence(sheet, tmp_path):
    with pytest.raises(LinkproofError, match=r"mechanisms\.json.*run compare with --out again"):
        load_sheets(tmp_path)
    save_sheets(tmp_path, [sheet])
    text = (tmp_path / FILE).read_text()
    (tmp_path / FILE).write_text(text.replace('"format":2', '"format":1'))
    with pytest.raises(LinkproofError, match="was written by another version of linkproof: delete it"):
        load_sheets(tmp_path)


def test_no_damage_goes_unseen(sheet, tmp_path):
    save_sheets(tmp_path, [sheet])
    content, chance = (tmp_path / FILE).read_bytes(), random.Random(1)
    for _ in range(30):
        place = chance.randrange(len(content) - 1)
        other = bytes([chance.choice([code for code in b'0x",]}' if code != content[place]])])
        (tmp_path / FILE).write_bytes(content[:place] + other + content[place + chance.choice([1, 9]) :])
        with pytest.raises(LinkproofError, match="run compare with --out again"):
            load_sheets(tmp_path)
