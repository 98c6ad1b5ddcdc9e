"""What an interrupted campaign says of itself, and what makes two campaigns the same."""

import dataclasses
from pathlib import Path

import pytest

from analytic.errors import LinkproofError
from reports.command_line.interruption import interruptible, journal
from reports.requests.campaign import request
from reports.requests.options.campaign import CompareOptions
from reports.requests.options.declaring import command_line

CHOICE = CompareOptions(mechanisms=("juki-mf7923d",), engine=("direct",))


def begun(folder, choice=CHOICE, text="the file", *, resume):
    asked = request(choice)
    linkages = tuple(dataclasses.replace(linkage, text=text) for linkage in asked.linkages)
    return journal(folder, command_line("compare", choice), asked.engines, linkages, resume=resume)


def interrupted(folder, *heard, by=lambda *_: None):
    """Announce these, then press Ctrl-C."""
    with interruptible(folder) as counting:
        announce = counting(by)
        for words in heard:
            announce(*words)
        raise KeyboardInterrupt


def test_an_interruption_tells_how_many_runs_are_kept():
    heard = []
    with pytest.raises(KeyboardInterrupt) as told:
        interrupted(Path("out"), ("first", 0, 90), ("last", 37, 90), by=lambda *words: heard.append(words))
    assert str(told.value) == "37 of 90 runs are saved in out: repeat the command with --resume to finish"
    assert heard == [("first", 0, 90), ("last", 37, 90)]


@pytest.mark.parametrize(("folder", "heard"), [(None, [("label", 1, 90)]), (Path("out"), [])])
def test_an_interruption_without_anything_kept_says_nothing(folder, heard):
    with pytest.raises(KeyboardInterrupt) as told:
        interrupted(folder, *heard)
    assert str(told.value) == ""


def test_other_faults_pass():
    with pytest.raises(ValueError, match="as it was"), interruptible(Path("out")):
        raise ValueError("as it was")


def test_the_same_request_is_resumed_and_begun_anew(tmp_path):
    begun(tmp_path, resume=False).keep("run", {})
    assert begun(tmp_path, resume=True).records.keys == ["run"]
    assert begun(tmp_path, resume=False).records.keys == []


def test_a_changed_linkage_file_is_another_request(tmp_path):
    begun(tmp_path, resume=False).keep("run", {})
    with pytest.raises(LinkproofError, match="file of juki-mf7923d"):
        _ = begun(tmp_path, text="the file, changed", resume=True).records


def test_another_command_is_another_request(tmp_path):
    begun(tmp_path, resume=False).keep("run", {})
    faster = dataclasses.replace(CHOICE, speed=2000.0)
    with pytest.raises(LinkproofError, match="got `linkproof compare juki-mf7923d --speed 2000 --engine direct`"):
        _ = begun(tmp_path, faster, resume=True).records
