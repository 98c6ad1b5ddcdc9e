"""An option is written in one place: commands, Python's keywords and the command that repeats a request have it."""

from dataclasses import dataclass
from typing import Annotated

import numpy as np
import pytest
from click.testing import CliRunner

import linkproof as package
from analytic.errors import LinkproofError
from reports.api.options import Mechanism, Motion, Numbers, Option, checked, command_line
from reports.command_line.parameters import CommandGroup, study_command
from reports.document.study import Study
from reports.document.terminal import Printout


@dataclass(frozen=True, repr=False)
class Film(Study):
    """What the lubricated linkage is asked."""

    given: dict

    def printout(self):
        """The arguments."""
        return Printout((), [command_line(ask, self.given)])

    def to_dict(self):
        """The same."""
        return {}


@checked
def ask(
    mechanism: Mechanism,
    motion: Motion = Motion(),
    *,
    film: Annotated[float | None, Option("Thickness of the oil film.", "MICROMETRES")] = None,
    at: Annotated[Numbers | None, Option("Angles.", "DEGREES")] = None,
):
    """Ask for results."""
    return Film(locals())


def test_a_new_option_of_a_function_is_everywhere():
    app = CommandGroup()
    study_command(app, "ask", ask, "quiet")
    text = CliRunner().invoke(app, ["ask", "--help"]).output
    assert "--film MICROMETRES" in text
    assert text.index("Options:") < text.index("--film") < text.index("Motion:") < text.index("--regime")
    done = CliRunner().invoke(app, ["ask", "press", "--film", "3", "--at", "0,30", "--no-gravity"])
    assert (done.exit_code, done.output) == (0, "linkproof ask press --film 3 --at 0,30 --no-gravity\n")
    assert ask("press", Motion(gravity=False), film=3, at=[0, 30]).given["film"] == 3
    with pytest.raises(LinkproofError, match=r"film: expected a number, got 'x'"):
        ask("press", film="x")
    with pytest.raises(LinkproofError, match=r"motion: expected a Motion, got 3; pass Motion\(...\)"):
        ask("press", 3)


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"speed": "3000"}, "speed: expected a number of rpm, got '3000'; pass a number"),
        ({"speed": True}, "speed: expected a number of rpm, got True"),
        ({"gravity": "yes"}, "gravity: expected True or False, got 'yes'; pass one of them"),
        ({"at": ["x"]}, "at: expected a number of degrees, got 'x'"),
        ({"time": [0.0, None]}, "time: expected a number of s, got None"),
    ],
)
def test_a_keyword_of_another_type_is_one_sentence(options, words):
    options = dict(options)
    at_or_time = {name: options.pop(name) for name in ("at", "time") if name in options}
    with pytest.raises(LinkproofError, match=words):
        package.results("juki-mf7923d", Motion(**options), **at_or_time)


def test_whole_numbers_paths_and_several_words_are_taken_as_they_are_typed(tmp_path):
    with pytest.raises(LinkproofError, match=r"samples: expected a whole number, got 12.5"):
        package.tolerance("rimoldi-164", {"rod.mass": 0.1}, "stroke", samples=12.5)
    found = package.tolerance("rimoldi-164", {"rod.mass": 0.1}, "stroke", samples=np.int64(12)).dataset
    assert found.attrs["samples"] == 12


def test_a_command_in_an_attribute_repeats_what_was_computed():
    linkage = package.load("rimoldi-164", "as-printed")
    over, keep = {"rod.mass": "±5%", "rod.B.x": (170, 180)}, {"stroke": (29.0, None)}
    best = package.optimise(
        linkage, motion=package.SteadyMotion(speed=500), minimise="Mkr.peak", over=over, keep=keep, step="0.1mm"
    ).dataset
    assert best.attrs["command"] == (
        "linkproof optimise rimoldi-164 --minimise Mkr.peak --over 'rod.mass=±5%' --over rod.B.x=170:180 "
        "--keep stroke=29: --round 0.1mm --variant as-printed --speed 500"
    )
    rod = best["rod.B.x"].attrs
    assert (rod["low"], rod["high"], rod["units"]) == (pytest.approx(170.0), pytest.approx(180.0), "mm")
