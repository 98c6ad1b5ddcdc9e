"""The sentence of an interrupted campaign, and what makes two campaigns the same request."""

import dataclasses
from pathlib import Path

import pytest

from comparisons.runs.study import Journal
from reports.command_line.app import app
from reports.command_line.destination import journal, own_study, report_interruption
from reports.requests.campaign import request
from reports.requests.options import BenchOptions, CompareOptions, RunLimits, command_line

OPTIONS = CompareOptions(mechanisms=("juki-mf7923d",), engine=("direct",))


def begun(folder, options=OPTIONS, text="the file"):
    campaign = request(options)
    linkages = tuple(dataclasses.replace(linkage, text=text) for linkage in campaign.linkages)
    return journal(folder, command_line("compare", options), campaign.engines, linkages)


@pytest.mark.parametrize(
    ("folder", "announced", "sentence"),
    [
        (
            Path("out"),
            [("first", 0, 90), ("last", 37, 90)],
            "37 of 90 runs are saved in out: repeat the command, or linkproof compare --out out, to finish",
        ),
        (None, [("label", 1, 90)], ""),
        (Path("out"), [], ""),
    ],
)
def test_an_interruption_names_the_number_of_saved_runs(folder, announced, sentence):
    passed_on = []

    def pressed():
        with report_interruption(folder, "compare") as counting:
            announce = counting(lambda *words: passed_on.append(words))
            for words in announced:
                announce(*words)
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt) as error:
        pressed()
    assert (str(error.value), passed_on) == (sentence, announced)


def test_the_same_request_goes_on_and_another_one_begins_anew_with_a_remark(tmp_path, capsys):
    faster = dataclasses.replace(OPTIONS, speed=2000.0)
    for other, words in (
        ({"text": "the file, changed"}, "`file of juki-mf7923d "),
        ({"options": faster}, "now `linkproof compare juki-mf7923d --speed 2000 --engine direct`"),
    ):
        begun(tmp_path).keep("run", {})
        assert begun(tmp_path).records.keys == ["run"]
        assert capsys.readouterr().err == ""
        assert begun(tmp_path, **other).records.keys == []
        assert words in capsys.readouterr().err
        begun(tmp_path, **other).clear()


UNFINISHED = "linkproof compare juki-mf7923d --regime run-up --engine direct --time-limit 9"


@pytest.mark.parametrize(
    ("command", "typed", "found"),
    [
        ("compare", (CompareOptions(), RunLimits(jobs=2)), UNFINISHED),
        ("compare", (OPTIONS, RunLimits()), "linkproof compare juki-mf7923d --engine direct"),
        ("bench", (BenchOptions(),), "linkproof bench"),
    ],
)
def test_a_folder_alone_means_its_own_unfinished_study(tmp_path, command, typed, found):
    Journal(tmp_path, UNFINISHED, f"{UNFINISHED} --out elsewhere --junit other.xml").keep("run", {})
    is_finished, bags = own_study(app, command, tmp_path, typed)
    assert (is_finished, command_line(command, *bags)) == (False, found)
    assert bags[1:] == () or bags[1].jobs == typed[1].jobs
