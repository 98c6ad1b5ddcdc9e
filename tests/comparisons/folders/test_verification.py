"""A folder that someone sent is judged anew, and whatever was changed in it is told."""

import pytest

from analytic.description.loading import load
from analytic.errors import LinkproofError
from comparisons.folders.verification import verify
from comparisons.judging.limits import with_rows
from comparisons.judging.records import CURVE
from tests.comparisons.folders.saved_campaign import changed, row, save_campaign

OBSERVED = CURVE.index("observed")


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return save_campaign(tmp_path_factory.mktemp("sent") / "a", load("juki-mf7923d"))


def _found(folder, into, edit):
    return {(one.place.rpartition(": ")[2], one.sentence) for one in verify(changed(folder, into, edit)).findings}


def test_nothing_differs_in_a_folder_as_it_was_written(folder):
    found = verify(folder)
    assert found.findings == ()
    assert found.curves == sum(record.error_max is not None for record in found.records) > 8
    assert found.figures > 4
    assert found.texts == 1
    assert found.notes[0] == "judged by the limits of this version, which are the folder's"


def test_an_error_that_its_curve_does_not_show_is_told(folder, tmp_path):
    found = _found(folder, tmp_path / "b", lambda _, run: row(run, "Mkr").update(error_max=1e-5))
    assert {place for place, _ in found} == {"Mkr"}
    assert any(words.startswith("its error_max is 1e-05, its curve's is ") for _, words in found)


def test_a_curve_that_was_smoothed_is_judged_by_what_it_shows(folder, tmp_path):
    def bend(_, run):
        run["curves"]["Mkr"][OBSERVED, -5] += 0.5 * row(run, "Mkr")["peak"]

    found = _found(folder, tmp_path / "b", bend)
    assert {place for place, _ in found} == {"Mkr"}
    assert any(words.startswith("saved as passed, judged over-limit: error 0.5 of peak") for _, words in found)


def test_a_vector_is_judged_by_its_magnitudes_where_they_are_further_off(folder, tmp_path):
    def bend(_, run):
        name = [*run["curves"]][-1]
        assert name.startswith("joint_force:")
        run["curves"][name][OBSERVED, -5] += row(run, name)["peak"]

    assert any("judged over-limit" in words for _, words in _found(folder, tmp_path / "b", bend))


def test_a_text_that_is_not_what_ran_is_told_by_checksum_truth_and_key_figures(folder, tmp_path):
    def heavier(told, _):
        text = told["descriptions"][0]["text"]
        told["descriptions"][0]["text"] = text.replace("0.64\n", "0.6464\n", 1)
        assert told["descriptions"][0]["text"] != text

    words = " | ".join(f"{place}: {sentence}" for place, sentence in _found(folder, tmp_path / "b", heavier))
    assert "its text has the checksum" in words
    assert "the saved reference differs from the closed form of the folder's text by" in words
    assert "Mkr.peak was" in words


def test_a_verdict_that_the_limits_do_not_give_is_told(folder, tmp_path):
    found = _found(folder, tmp_path / "b", lambda _, run: row(run, "S").update(outcome="over-limit"))
    assert ("S", "saved as over-limit, judged passed") in found


def test_limits_of_the_senders_own_are_told_and_those_of_the_receiver_judge(tmp_path):
    own = with_rows([{"quantities": ["Mkr"], "value": 1e-30, "reason": "none"}], "own")
    folder = save_campaign(tmp_path / "a", load("juki-mf7923d"), limits=own)
    by_theirs = verify(folder)
    assert by_theirs.findings == ()
    assert by_theirs.notes[0].endswith("of which this version has not: Mkr 1e-30 (none)")
    (tmp_path / "mine.toml").write_text('[[limit]]\nquantities = ["Mkr"]\nvalue = 1e-9\n', encoding="utf-8")
    by_ours = {one.place.rpartition(": ")[2]: one.sentence for one in verify(folder, tmp_path / "mine.toml").findings}
    assert by_ours == {"Mkr": "its limit is 1e-30, judged by 1e-09; passed by both"}


def test_a_folder_of_judge_is_refused(folder, tmp_path):
    copy = changed(folder, tmp_path / "b", lambda told, _: told.update(judgement=["right"]))
    with pytest.raises(LinkproofError, match="got one of judge: judge the tool's own files again"):
        verify(copy)
