"""What a script is written of: data that is its own source, and loops that need no linkproof."""

import ast
import sys
from types import ModuleType

import numpy as np
import pytest

from analytic.description.crank_motion import crank_motion
from comparisons.case import scene
from engines.contract import Outcome, Setting
from engines.exported_script import script, written
from engines.mujoco_adapter import EXPERT, MujocoEngine
from engines.scene import Channel, Prescribed
from engines.stepping.intervals import UnsupportedError
from tests.analytic.linkages import mechanism


class Shouting(str):
    """A text that shows itself as code."""

    __slots__ = ()

    def __repr__(self):
        return "__import__('os').getcwd()"

    __str__ = __repr__


@pytest.mark.parametrize("text", [
    '"""', 'a\n"""b', "'''\n", '\n"', '""\n""', "\\", "\\\n\\", "\n\r\t\0", "\x0c\x85\u2028\u2029\n", "\ud800\n",
    "\ue0000\ue001\n", "\n\u202eright to left", "{}\n{0}", "'\"", "'\"\n", "#", "#\n#", '"' * 7, "\n" + '"' * 8,
    "# -*- coding: utf-7 -*-", "__import__('os')", "\\N{BELL}", "%s", "",
])  # fmt: skip
def test_any_text_is_written_as_itself(text):
    for given in (text, text * 100, f"{text}, '" * 50, {text: [text, (text,)]}):
        source = written(given)
        assert ast.literal_eval(source) == given
        assert all(c.isprintable() for c in source.replace("\n", ""))


@pytest.mark.parametrize(("value", "plain"), [
    (np.float64(0.1) * 3, 0.1 * 3), (np.arange(4).reshape(2, 2), [[0, 1], [2, 3]]), (np.array(2.5), 2.5),
    (Shouting("a"), "a"), ({Channel.TORQUE: (1, True, None)}, {"torque": (1, True, None)}), ((2 - 1j,), (2 - 1j,)),
])  # fmt: skip
def test_data_is_written_in_plain_types(value, plain):
    source = written(value)
    assert ast.literal_eval(source) == plain
    assert type(ast.literal_eval(source)) is type(plain)


@pytest.mark.parametrize("value", [object(), [lambda: 0], {"a": np}, {1, 2}])
def test_what_is_no_data_is_no_source(value):
    with pytest.raises(TypeError, match="plain data"):
        written(value)


@pytest.fixture
def loop(monkeypatch, tmp_path):
    """An engine with a loop of this source; MuJoCo is only what is installed."""
    pytest.importorskip("mujoco")

    def engine(source):
        (tmp_path / "own_loop.py").write_text(source)
        monkeypatch.syspath_prepend(tmp_path)
        monkeypatch.delitem(sys.modules, "own_loop", raising=False)
        adapter = MujocoEngine()
        monkeypatch.setattr(adapter, "loop", "own_loop", raising=False)
        return adapter

    return engine


GIVEN = scene(mechanism("juki-mf7923d"), Prescribed(crank_motion()), frozenset())
ENDING = "def build(model):\n    {}\n\ndef follow(world, course):\n    {}\n"


@pytest.mark.parametrize("line", [
    "from engines.scene import Scene", "import numpy, linkproof.engine", "from . import other",
    "from analytic import x",
])  # fmt: skip
def test_a_loop_that_needs_linkproof_is_refused(loop, line):
    adapter = loop(f'"""A loop."""\nimport numpy\ndef unused():\n    {line}\n')
    with pytest.raises(UnsupportedError, match=r"line 4 of its loop 'own_loop' imports a part of linkproof"):
        script(adapter, GIVEN, EXPERT, "", lambda _: [])


@pytest.mark.parametrize(("build", "follow", "outcome", "words"), [
    ("raise ArithmeticError('no such joint')", "pass", Outcome.UNSUPPORTED, "no such joint"),
    ("pass", "raise ArithmeticError('it broke')", Outcome.DIVERGED, "it broke"),
    ("pass", "return {'position': ([0.0], [[[1.0] * 3] * 3])}", Outcome.FINISHED, ""),
])  # fmt: skip
def test_how_a_loop_ends_a_run(loop, build, follow, outcome, words):
    run = loop(ENDING.format(build, follow)).run(GIVEN, Setting.TUNED)
    assert (run.outcome, run.reason) == (outcome, words)


def test_an_error_of_a_loop_is_one_of_the_adapter(loop):
    with pytest.raises(ZeroDivisionError):
        loop(ENDING.format("pass", "1 / 0")).run(GIVEN, Setting.TUNED)


def test_a_loop_without_a_docstring_and_with_annotations_of_the_future_is_a_script(loop):
    source = "from __future__ import annotations\n" + ENDING.format("pass", "return {}")
    text = script(loop(source), GIVEN, EXPERT, "about 'it'\\", lambda _: [])
    module = ModuleType("case")
    exec(compile(text, "case.py", "exec"), vars(module))
    assert module.samples == {}
    assert ast.get_docstring(ast.parse(text)).startswith("about 'it'\\")
