"""The sentence of an interrupted campaign, and what makes two campaigns the same request."""

import dataclasses
from pathlib import Path

import pytest

from analytic.errors import LinkproofError
from reports.command_line.destination import journal, report_interruption
from reports.requests.campaign import request
from reports.requests.campaign_options import CompareOptions
from reports.requests.options import command_line

OPTIONS = CompareOptions(mechanisms=("juki-mf7923d",), engine=("direct",))


def begun(folder, options=OPTIONS, text="the file", *, resume):
    campaign = request(options)
    linkages = tuple(dataclasses.replace(linkage, text=text) for linkage in campaign.linkages)
    return journal(folder, command_line("compare", options), campaign.engines, linkages, resume=resume)


@pytest.mark.parametrize(
    ("folder", "announced", "sentence"),
    [
        (
            Path("out"),
            [("first", 0, 90), ("last", 37, 90)],
            "37 of 90 runs are saved in out: repeat the command with --resume to finish",
        ),
        (None, [("label", 1, 90)], ""),
        (Path("out"), [], ""),
    ],
)
def test_an_interruption_names_the_number_of_saved_runs(folder, announced, sentence):
    passed_on = []

    def pressed():
        with report_interruption(folder) as counting:
            announce = counting(lambda *words: passed_on.append(words))
            for words in announced:
                announce(*words)
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt) as error:
        pressed()
    assert (str(error.value), passed_on) == (sentence, announced)


def test_other_faults_pass():
    with pytest.raises(ValueError, match="as it was"), report_interruption(Path("out")):
        raise ValueError("as it was")


def test_the_same_request_is_resumed_and_another_one_is_refused(tmp_path):
    begun(tmp_path, resume=False).keep("run", {})
    assert begun(tmp_path, resume=True).records.keys == ["run"]
    faster = dataclasses.replace(OPTIONS, speed=2000.0)
    for other, words in (
        ({"text": "the file, changed"}, "file of juki-mf7923d"),
        ({"options": faster}, "got `linkproof compare juki-mf7923d --speed 2000 --engine direct`"),
    ):
        with pytest.raises(LinkproofError, match=words):
            _ = begun(tmp_path, resume=True, **other).records
    assert begun(tmp_path, resume=False).records.keys == []
