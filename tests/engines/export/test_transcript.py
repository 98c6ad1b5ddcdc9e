"""What is done to an engine's objects, as source that does the same again."""

import ast
import sys
from types import ModuleType

import numpy as np
import pytest

from engines.export.transcript import Sourced, Transcript, folded, literal
from engines.stepping.driver import UnsupportedError

ENGINE = """
import numpy as np

class Wheel:
    def __init__(self, radius, centre=(0.0, 0.0)):
        self.radius, self.centre, self.parts, self.sizes = radius, centre, [], np.ones(3)

class Machine:
    def __init__(self):
        self.wheels, self.law = [], None
    def add(self, wheel):
        self.wheels.append(wheel)
        return wheel
    def drive(self, law):
        self.law = law
    def get_count(self):
        return len(self.wheels)
"""


@pytest.fixture
def engine(monkeypatch):
    module = ModuleType("cogs")
    exec(ENGINE, vars(module))
    for kind in (module.Wheel, module.Machine):
        kind.__module__ = "cogs"
    monkeypatch.setitem(sys.modules, "cogs", module)
    return module


class World:
    """What an adapter holds, in a module of its own."""

    __module__ = "engines.cogs_adapter"

    def __init__(self, machine, wheels):
        self.machine, self.wheels = machine, wheels


def _build():
    import cogs  # noqa: PLC0415

    machine, law = cogs.Machine(), Sourced(lambda t: 2.0 * t, "lambda t: 2.0 * t")
    wheels = {"hub": machine.add(cogs.Wheel(np.float64(0.1), centre=(1.0, 0.0)))}
    wheels["hub"].radius *= 3  # computed here: the script gets the result
    wheels["hub"].sizes[:2] *= 0.5
    cogs.Wheel(9.0)  # which nobody uses
    machine.add(cogs.Wheel(0.2)).parts.append("bolt.get(")  # which is text, and no look at the wheel
    machine.wheels[-1].centre = (machine.get_count() + 0.5, float("inf"))
    machine.drive(law)
    return World(machine, wheels)


def test_the_source_does_the_same_again(engine):
    transcript = Transcript("cogs")
    with transcript.on():
        world = _build()
    assert sys.modules["cogs"] is engine
    imports, lines, rest = transcript.source(world, f"last = {world.machine}.law(4.0)")
    assert imports == ["import cogs"]
    assert lines[:2] == ["machine = cogs.Machine()", "hub_wheel = cogs.Wheel(0.1, centre=(1.0, 0.0))"]
    assert not any("9.0" in line or "get_count" in line for line in lines)
    again = {"np": np}
    exec("\n".join([*imports, *lines, rest]), again)
    first, second = again["machine"].wheels
    assert (first.radius, first.centre, first.sizes.tolist()) == (0.1 * 3, (1.0, 0.0), [0.5, 0.5, 1.0])
    assert (second.radius, second.centre, second.parts) == (0.2, (2.5, float("inf")), ["bolt.get("])
    assert again["last"] == 8.0
    assert type(first) is engine.Wheel


def test_a_function_without_its_text_is_refused_and_the_engine_is_put_back(engine):
    transcript = Transcript("cogs")
    with pytest.raises(UnsupportedError, match="given a function"), transcript.on():
        sys.modules["cogs"].Machine().drive(lambda t: t)
    assert sys.modules["cogs"] is engine


def test_names_that_python_takes_for_one_have_a_variable_each(engine):
    transcript = Transcript("cogs")
    with transcript.on():
        cogs = sys.modules["cogs"]
        machine = cogs.Machine()
        names = ("\ufb01x", "fix", "\u00b5", "\u03bc", "machine")
        world = World(machine, {name: machine.add(cogs.Wheel(1.0)) for name in names})
    imports, lines, rest = transcript.source(world, f"last = {literal(list(world.wheels.values()))}")
    again = {}
    exec("\n".join([*imports, *lines, rest]), again)
    assert again["machine"].wheels == again["last"]


@pytest.mark.parametrize("text", [
    '"""', 'a\n"""b', "'''\n", '\n"', '""\n""', "\\", "\\\n\\", "\n\r\t\0", "\x0c\x85\u2028\u2029\n", "\ud800\n",
    "\ue0000\ue001\n", "\n\u202eright to left", "{}\n{0}", "'\"", "'\"\n", "#", "#\n#", '"' * 7, "\n" + '"' * 8,
    "<a b='\\'/>", "<a>\n<b/></a>", "",
])  # fmt: skip
def test_any_text_is_written_as_itself(text):
    for written in (text, text * 100, f"{text}, '" * 50):
        source = literal(written)
        assert ast.literal_eval(source) == written
        assert all(c.isprintable() for c in source.replace("\n", ""))
        assert source.count("\n") == written.count("\n")
        assert ast.literal_eval(folded(literal([written, 1.0]))) == [written, 1.0]
