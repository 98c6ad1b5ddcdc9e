"""An option is written in one place: commands, Python's keywords and the command that repeats a request have it."""

import inspect
from dataclasses import dataclass
from typing import Annotated

import numpy as np
import pytest
import typer
from typer.testing import CliRunner

import linkproof as package
from analytic.errors import LinkproofError
from reports.command_line.parameters import command
from reports.python.keywords import with_keywords
from reports.requests.options import Option, ResultsOptions, command_line


@dataclass(frozen=True, kw_only=True)
class Lubricated(ResultsOptions):
    """The results of a linkage, and an option that there was not before."""

    film: Annotated[float | None, Option("Thickness of the oil film.", "MICROMETRES")] = None


def test_a_new_option_of_a_request_is_everywhere():
    app, seen = typer.Typer(rich_markup_mode=None), []
    app.callback()(lambda: None)

    @command(app, "ask", summary="Ask.")
    def ask(options: Lubricated) -> None:
        """Ask for results."""
        seen.append(options)

    @with_keywords()
    def called(linkage: str, options: Lubricated) -> Lubricated:
        """Results of a linkage."""
        return options

    text = CliRunner().invoke(app, ["ask", "--help"]).output
    assert "--film MICROMETRES" in text
    done = CliRunner().invoke(app, ["ask", "press", "--film", "3", "--at", "0,30", "--no-gravity"])
    assert (done.exit_code, len(seen)) == (0, 1), done.output
    assert seen == [Lubricated(mechanism="press", film=3.0, at=(0.0, 30.0), gravity=False)]
    assert command_line("ask", seen[0]) == "linkproof ask press --at 0,30 --film 3 --no-gravity"
    assert called("press", film=3, at=[0, 30], gravity=False).film == 3
    assert "film" in inspect.signature(called).parameters
    assert "film: Thickness of the oil film." in called.__doc__


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"speed": "3000"}, "speed: expected a number of rpm, got '3000'; pass a number"),
        ({"speed": True}, "speed: expected a number of rpm, got True"),
        ({"clockwise": "yes"}, "clockwise: expected True or False, got 'yes'; pass one of them"),
        ({"at": ["x"]}, "at: expected a number of degrees, got 'x'"),
        ({"time": [0.0, None]}, "time: expected a number of s, got None"),
    ],
)
def test_a_keyword_of_another_type_is_one_sentence(options, words):
    with pytest.raises(LinkproofError, match=words):
        package.results("juki-mf7923d", **options)


def test_whole_numbers_paths_and_several_words_are_taken_as_they_are_typed(tmp_path):
    with pytest.raises(LinkproofError, match=r"samples: expected a whole number, got 12.5"):
        package.tolerance("rimoldi-164", {"rod.mass": 0.1}, "stroke", samples=12.5)
    found = package.tolerance("rimoldi-164", {"rod.mass": 0.1}, "stroke", samples=np.int64(12))
    assert found.attrs["samples"] == 12
    with pytest.raises(TypeError, match=r"unknown argument 'sped': did you mean 'speed'"):
        package.results("juki-mf7923d", sped=3)


def test_a_command_in_an_attribute_repeats_what_was_computed():
    linkage = package.load("rimoldi-164", "as-printed")
    over, keep = {"rod.mass": "±5%", "rod.B.x": (170, 180)}, {"stroke": (29.0, None)}
    best = package.optimise(linkage, minimise="Mkr.peak", over=over, keep=keep, step="0.1mm", speed=500)
    assert best.attrs["command"] == (
        "linkproof optimise rimoldi-164 --minimise Mkr.peak --over 'rod.mass=±5%' --over rod.B.x=170:180 "
        "--keep stroke=29: --variant as-printed --speed 500 --round 0.1mm"
    )
