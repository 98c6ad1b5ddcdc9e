"""Data sheets come back from their file as they were, and a damaged file is told by its key."""

import json
import random
from dataclasses import replace

import numpy as np
import pytest

from analytic.description.loading import load
from analytic.errors import LinkproofError
from comparisons.datasheet.building import usual_sheet
from comparisons.datasheet.saved import FILE, load_sheets, save_sheets


@pytest.fixture(scope="module")
def sheet():
    return usual_sheet(load("two-crank-takeup"), regimes=("driven",))


def test_a_sheet_comes_back_as_it_was(sheet, tmp_path):
    save_sheets(tmp_path, [sheet])
    (found,) = load_sheets(tmp_path)
    assert found.linkage == sheet.linkage
    assert (found.figures, found.published, found.facts) == (sheet.figures, sheet.published, sheet.facts)
    assert np.allclose(found.values["Mkr"], sheet.values["Mkr"], rtol=1e-7)
    erratum = "S1 without US1"
    assert np.allclose(found.printed[erratum]["printed"], sheet.printed[erratum]["printed"], rtol=1e-7)
    assert found.released["driven"].facts == sheet.released["driven"].facts


def test_a_mechanism_takes_little_room(sheet, tmp_path):
    save_sheets(tmp_path, [sheet])
    assert (tmp_path / FILE).stat().st_size < 400_000


def test_what_is_not_a_number_comes_back_so(sheet, tmp_path):
    values = dict(sheet.values)
    values["Mkr"] = np.where(np.arange(len(values["Mkr"])) == 7, np.nan, values["Mkr"])
    save_sheets(tmp_path, [replace(sheet, values=values)])
    assert np.flatnonzero(np.isnan(load_sheets(tmp_path)[0].values["Mkr"])).tolist() == [7]


def test_the_key_of_a_damage_is_told(sheet, tmp_path):
    save_sheets(tmp_path, [sheet])
    told = json.loads((tmp_path / FILE).read_text())
    told["sheets"][0]["values"]["Mkr"] = "none"
    (tmp_path / FILE).write_text(json.dumps(told))
    with pytest.raises(LinkproofError, match=r"sheets\.0\.values\.Mkr.*run compare with --out again"):
        load_sheets(tmp_path)


def test_a_file_of_another_version_is_refused_in_one_sentence(sheet, tmp_path):
    save_sheets(tmp_path, [sheet])
    text = (tmp_path / FILE).read_text()
    (tmp_path / FILE).write_text(text.replace('"format":2', '"format":1'))
    with pytest.raises(LinkproofError, match="was written by another version of linkproof: delete it"):
        load_sheets(tmp_path)


def test_no_damage_goes_unseen(sheet, tmp_path):
    save_sheets(tmp_path, [sheet])
    content, chance = (tmp_path / FILE).read_bytes(), random.Random(1)
    for _ in range(200):
        place = chance.randrange(len(content) - 1)
        other = bytes([chance.choice([code for code in b'0x",]}' if code != content[place]])])
        (tmp_path / FILE).write_bytes(content[:place] + other + content[place + chance.choice([1, 9]) :])
        with pytest.raises(LinkproofError, match="run compare with --out again"):
            load_sheets(tmp_path)


def test_a_folder_without_sheets_is_refused(tmp_path):
    with pytest.raises(LinkproofError, match=r"mechanisms\.json.*run compare with --out again"):
        load_sheets(tmp_path)


def test_a_whole_turn_is_whole_when_it_is_read_back(sheet, tmp_path):
    save_sheets(tmp_path, [sheet])
    assert load_sheets(tmp_path)[0].is_turn
