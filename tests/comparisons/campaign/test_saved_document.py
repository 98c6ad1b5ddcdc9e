"""A damaged campaign is refused in one sentence, or reads whole: never a traceback."""

import json
import random
from contextlib import suppress
from dataclasses import replace

import numpy as np
import pytest

from analytic.description.loading import load
from analytic.errors import LinkproofError
from comparisons.campaign.key_figures import KeyFigure
from comparisons.campaign.results import ARRAYS, DATASET
from comparisons.campaign.results import load as load_results
from comparisons.campaign.standards import JudgedCampaign
from comparisons.datasheet.saved import save_sheets
from comparisons.judging.limits import shipped_limits
from comparisons.judging.verdicts import shipped_standard
from tests.reports.made_up_results import made_up_results

INSTEAD = (None, "x", "", 3.5, -7, [1], {"a": 1})


@pytest.fixture(scope="module")
def results():
    found = made_up_results([load("juki-mf7923d")], samples=31)
    figure = KeyFigure("juki-mf7923d", "as-built", "run-up", "c", "Mkr.peak", 1.0, 1.01, changed=True)
    judged = JudgedCampaign(shipped_standard(), [], [figure], ["a note"], ["mine.toml is missing"])
    return replace(found, document={**found.document, **judged.told})


@pytest.fixture(scope="module")
def folder(results, tmp_path_factory):
    found = tmp_path_factory.mktemp("damaged")
    save_sheets(found, results.sheets)
    return found


def written(folder, document, curves):
    curves = curves.assign_attrs(document=json.dumps(document))
    curves.to_netcdf(folder / DATASET, engine="scipy", format="NETCDF3_64BIT")
    return folder


def read_all(folder):
    """All that a report asks of a campaign, straight from its file."""
    found = load_results(folder)
    assert found.invariants
    assert found.linkages
    assert all(figure.sentence for figure in found.figures)
    assert found.limits.limit("Mkr", "tuned", "run-up").value
    assert all(motion.duration and motion.peak_speed for motion in found.motions)
    for record in found.records:
        if record.error_max is not None:
            assert len(found.curve(record.run, record.quantity)) == len(ARRAYS)
    return found


def damage(document, chance):
    """Take away or replace a random value at any depth; returns its key."""
    place, keys = document, []
    while True:
        key = chance.choice(list(place) if isinstance(place, dict) else range(len(place)))
        keys.append(str(key))
        if not place[key] or not isinstance(place[key], dict | list) or chance.random() < 0.25:
            break
        place = place[key]
    if chance.random() < 0.3:
        del place[key]
    else:
        place[key] = chance.choice(INSTEAD)
    return ".".join(keys)


def test_what_is_whole_is_read(results, folder):
    found = read_all(written(folder, results.document, results.curves))
    assert found.records == results.records
    assert found.figures == results.figures
    assert found.limits == shipped_limits()
    assert [sheet.name for sheet in found.sheets] == ["juki-mf7923d"]


def test_the_document_may_be_damaged_anywhere(results, folder):
    chance, refused = random.Random(4), 0
    for _ in range(200):
        document = json.loads(json.dumps(results.document))
        damage(document, chance)
        with suppress(LinkproofError):
            read_all(written(folder, document, results.curves))
            continue
        refused += 1
    assert refused > 100


@pytest.mark.parametrize(
    ("key", "match"),
    [("records", "records: Field required"), ("motions", "motions"), ("descriptions", "descriptions")],
)
def test_the_key_that_is_missing_is_told(results, folder, key, match):
    document = {name: value for name, value in results.document.items() if name != key}
    with pytest.raises(LinkproofError, match=rf"{match}.*run compare with --out again"):
        load_results(written(folder, document, results.curves))


def test_a_campaign_that_saved_no_standard_has_the_suites(results, folder):
    newer = ("limits", "figures", "notes")
    document = {name: value for name, value in results.document.items() if name not in newer}
    found = read_all(written(folder, document, results.curves))
    assert (found.figures, found.limits) == ((), shipped_limits())


@pytest.mark.parametrize(
    ("damage", "match"),
    [({"limits": []}, "no limit of"), ({"limits": [{"value": 1.0}]}, r"limits\.0"), ({"figures": [{}]}, r"figures\.0")],
)
def test_a_damaged_standard_is_told(results, folder, damage, match):
    with pytest.raises(LinkproofError, match=match):
        load_results(written(folder, {**results.document, **damage}, results.curves))


def test_a_wrong_type_is_told_by_its_place(results, folder):
    document = json.loads(json.dumps(results.document))
    document["records"][3]["error_max"] = "small"
    with pytest.raises(LinkproofError, match=r"records\.3\.error_max"):
        load_results(written(folder, document, results.curves))


@pytest.mark.parametrize("name", [*ARRAYS, "row_size", "run", "quantity"])
def test_every_array_is_needed(results, folder, name):
    with pytest.raises(LinkproofError, match=name):
        load_results(written(folder, results.document, results.curves.drop_vars(name)))


def test_arrays_that_are_cut_off_do_not_fit(results, folder):
    with pytest.raises(LinkproofError, match="row_size"):
        load_results(written(folder, results.document, results.curves.isel(sample=slice(0, -1))))
    with pytest.raises(LinkproofError, match="row_size"):
        load_results(written(folder, results.document, results.curves.isel(curve=slice(0, -1))))


def test_a_sample_that_is_no_number_is_refused(results, folder):
    curves = results.curves.copy(deep=True)
    curves["reference"].values[5] = np.nan
    with pytest.raises(LinkproofError, match="reference: expected finite numbers"):
        load_results(written(folder, results.document, curves))


def test_the_bytes_may_be_damaged_anywhere(results, folder):
    content = (written(folder, results.document, results.curves) / DATASET).read_bytes()
    chance = random.Random(5)
    for _ in range(100):
        place, length = chance.randrange(len(content)), chance.choice([0, 1, 4, 100])
        (folder / DATASET).write_bytes(content[:place] + bytes(length) + content[place + chance.choice([0, 1, 50]) :])
        with suppress(LinkproofError):
            read_all(folder)


def test_sheets_of_another_campaign_are_refused(results, tmp_path):
    save_sheets(tmp_path, made_up_results([load("fork-takeup")], samples=31).sheets)
    with pytest.raises(LinkproofError, match=r"mechanisms\.json.*no juki-mf7923d"):
        load_results(written(tmp_path, results.document, results.curves))


def test_a_check_of_a_judged_file_has_a_largest_error_alone(results, folder):
    document = json.loads(results.curves.attrs["document"])
    document["invariants"] = [{**row, "error_rms": None} for row in document["invariants"]]
    assert read_all(written(folder, document, results.curves)).invariants[0].error_rms is None
