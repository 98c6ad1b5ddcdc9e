"""A saved campaign comes back whole, with no engine in sight."""

import json
import subprocess
import sys

import numpy as np
import pytest

from analytic.description.crank_motion import crank_motion
from analytic.description.loading import find, load
from analytic.errors import LinkproofError
from analytic.kinematics.mechanism import Mechanism
from comparisons.campaign import campaign
from comparisons.campaign.campaign import CampaignRequest
from comparisons.campaign.results import described, document, save
from comparisons.campaign.results import load as load_results
from comparisons.datasheet.building import bare_sheet
from comparisons.judging.records import from_rows, to_json
from engines.contract import Outcome, Run, Setting
from tests.comparisons.perfect_engine import perfect_motion

JUKI, MOTION = load("juki-mf7923d", "as-printed"), crank_motion("run-up", clockwise=True, start_angle=0.3)


def _compared(request, run):
    """What a campaign makes of this run of an engine."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(campaign, "run_engine", lambda *_: run)
        return list(campaign.compare(request))


@pytest.fixture(scope="module")
def saved(tmp_path_factory):
    request = CampaignRequest((JUKI,), (MOTION,), "as tested", ("direct",))
    motion = perfect_motion(Mechanism(JUKI), MOTION, 701)
    run = Run(Outcome.FINISHED, history=motion.history, details={"step": 1e-3})
    (result,) = _compared(request, run)
    folder = tmp_path_factory.mktemp("saved")
    told = document(request, [result], "linkproof compare juki-mf7923d")
    save(folder, [result], told, [bare_sheet(JUKI, "")])
    return folder, result


def test_curves_come_back_to_the_last_bit(saved):
    folder, result = saved
    results = load_results(folder)
    for name, found in result.deviations.items():
        time, angle, observed, reference = results.curve(result.records[0].run, name)
        np.testing.assert_array_equal(time, found.time)
        np.testing.assert_array_equal(angle, found.angle)
        np.testing.assert_array_equal(observed, found.observed)
        np.testing.assert_array_equal(reference, found.reference)


def test_records_linkages_and_motions_come_back(saved):
    folder, result = saved
    results = load_results(folder / "curves.nc")
    assert results.records == result.records
    assert results.invariants == result.invariants
    assert results.linkages == (JUKI,)
    assert results.motions == (MOTION,)
    assert results.document["environment"]["numpy"] == np.__version__


def test_the_dataset_is_labelled(saved):
    folder, result = saved
    curves = load_results(folder).curves
    assert [str(q) for q in curves.quantity.values] == list(result.deviations)
    assert {str(e) for e in curves.engine.values} == {"direct"}
    torque = curves.isel(curve=list(curves.quantity.values).index("Mkr"))
    assert str(torque.unit.values) == "N m"
    assert int(torque.row_size) == len(result.deviations["Mkr"].time)
    assert int(curves.row_size.sum()) == curves.sizes["sample"]


def test_the_json_beside_it_holds_the_same_records(saved):
    folder, result = saved
    assert from_rows(json.loads((folder / "records.json").read_text())["records"]) == result.records
    assert sorted(path.name for path in folder.iterdir()) == ["curves.nc", "mechanisms.json", "records.json"]


def test_loading_imports_no_engine(saved):
    script = (
        "import sys; from pathlib import Path; from comparisons.campaign.results import load;"
        f"load(Path({str(saved[0])!r})); print([m for m in ('exudyn', 'pymunk') if m in sys.modules])"
    )
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"


@pytest.mark.parametrize("content", [None, b"", b"not a dataset", b"CDF\x02garbage"])
def test_what_is_no_dataset_is_refused_in_one_sentence(tmp_path, content):
    if content is not None:
        (tmp_path / "curves.nc").write_bytes(content)
    with pytest.raises(LinkproofError, match=r"curves\.nc") as refused:
        load_results(tmp_path)
    assert "\n" not in str(refused.value)


def test_curves_without_the_crank_angle_are_refused(saved, tmp_path):
    curves = load_results(saved[0]).curves.drop_vars("angle")
    curves.to_netcdf(tmp_path / "curves.nc", engine="scipy", format="NETCDF3_64BIT")
    with pytest.raises(LinkproofError, match="run compare with --out again"):
        load_results(tmp_path)


def test_json_never_holds_nan():
    with pytest.raises(ValueError, match="Out of range float"):
        to_json({"records": [float("nan")]})


def test_a_campaign_of_failures_can_be_saved(tmp_path):
    request = CampaignRequest((JUKI,), (MOTION,), "as tested", ("direct",), (Setting.NAIVE,))
    (failed,) = _compared(request, Run(Outcome.DIVERGED, "ran away"))
    told = document(request, [failed], "linkproof compare")
    save(tmp_path, [failed], told, [bare_sheet(JUKI, "")])
    assert load_results(tmp_path).records == failed.records


def test_a_saved_text_with_a_byte_order_mark_is_read_again():
    text = find("juki-mf7923d").read_text(encoding="utf-8")
    assert described("\ufeff" + text, "juki-mf7923d", None, (0.0, -9.81)) == load("juki-mf7923d")
