"""Linkage files and curves changed at random: an answer or a LinkproofError; no other exception, warning or hang."""

import random
import re
import signal
import warnings

import numpy as np
import pytest

import linkproof
from analytic.description.loading import CATALOGUE, LITERATURE, load
from analytic.errors import LinkproofError
from comparisons.filejudge.judge import _crank_motion
from comparisons.filejudge.reading import read_results
from tests.analytic.linkages import FOLDER
from tests.commands import linkproof as command
from tests.comparisons.filejudge import layouts
from tests.reports.command_line.test_bad_files import LateError, time_limit

SECONDS = 100  # of the processor for one file: forty windows that fall into a dead position take 45 s
FOLDERS = (CATALOGUE, LITERATURE, FOLDER)
LINKAGES = [path.read_text("utf-8") for folder in FOLDERS for path in sorted(folder.rglob("*.toml"))]
NUMBER = re.compile(r"(?<![\w\"])[-+]?\d+\.?\d*(?:e[-+]?\d+)?")
FACTORS = (-1.0, 0.5, 0.999, 1.001, 2.0, 1e3, 1e-3)
VALUES = ("0", "-1", "1e-9", "1e9", "1e300", "-1e300", "5e-324", "nan", "inf", '""', "[]", "{}", "true", "", "1,5")
SIGNS = (*'[]{}=",.#-+;:\t\n\r\0\x1bé°ÿ\u202e😀\ufeff٣ ', "NaN", "1e999", "9e299", "1" * 5000, "\n\n", "<Step>", "\n0")


JUKI = load("juki-mf7923d")
LAYOUTS = {
    "a.csv": lambda channels: layouts.csv(channels, delimiter=";", decimal=","),
    "b.csv": lambda channels: layouts.solidworks([(c.header, [channels[0], c]) for c in channels[1:]]),
    "c.csv": lambda channels: layouts.modelica([layouts.Channel(f"crank.{n}", "", c.values) if n else c
                                                for n, c in zip(("", "phi", "tau"), channels, strict=True)]),
    "a.txt": lambda channels: layouts.csv(channels, delimiter="  ", quotes=True).encode("utf-16"),
    "a.tab": layouts.adams_table,
    "a.res": layouts.adams_results,
    "b.res": layouts.robotran,
}  # fmt: skip
SAID = {  # of layouts without units or names
    "a.res": ("time.CRANK ANGLE=phi [deg]",),
    "a.tab": ("time=time [s]", "Crank angle=phi [deg]", "MOTION_1.TZ=Mkr [N*m]"),
    "b.res": ("column 1=time [s]", "column 2=phi [deg]", "column 3=Mkr [N*m]"),
}


def changed(text, chance):
    """A text with a few changes: of numbers, of lines, of signs."""
    for _ in range(chance.choice([1, 1, 1, 2, 3, 6])):
        lines, kind, numbers = text.split("\n"), chance.randrange(7), [*NUMBER.finditer(text)]
        here, there = chance.randrange(len(lines)), chance.randrange(len(lines))
        if kind < 3 and numbers:
            found = chance.choice(numbers)
            new = repr(float(found[0]) * chance.choice(FACTORS)) if kind else chance.choice(VALUES)
            text = text[: found.start()] + new + text[found.end() :]
        elif kind < 5:  # a line goes, or comes a second time
            text = "\n".join([*lines[:here], *([lines[there]] if kind == 3 else []), *lines[here + (kind == 4) :]])
        elif kind == 5:
            place = chance.randrange(len(text) + 1)
            text = text[:place] + chance.choice(SIGNS) + text[place + chance.randrange(2) :]
        else:
            place = chance.randrange(len(text) + 1)
            text = text[:place] + text[place + chance.randrange(200) :]
    return text


def changed_linkage(folder, chance):
    """The file of a changed linkage."""
    path = folder / "changed.toml"
    path.write_text(changed(chance.choice(LINKAGES), chance), "utf-8", newline="")
    return path


def compute(folder, chance):
    """Check a changed linkage, and compute its results."""
    path = changed_linkage(folder, chance)
    linkproof.check(path)
    linkproof.results(path)


def judge(folder, chance):
    """Judge changed curves of a sound linkage."""
    true, path = linkproof.results("juki-mf7923d").dataset, folder / "changed.csv"
    columns = [true["time"], np.degrees(true["phi"]), 1e3 * true["S"], true["Mkr"]]
    rows = [",".join(f"{value:.9g}" for value in row) for row in np.transpose(columns)[::12]]
    path.write_text(changed("\n".join(["time [s],phi [deg],S [mm],Mkr [N*m]", *rows]), chance), "utf-8", newline="")
    linkproof.judge("juki-mf7923d", path)


def read(folder, chance):
    """Read a damaged file of results in one of the layouts of other tools, and find the crank's motion in it."""
    time = np.linspace(0.0, 1.0, 40)
    columns = (("time", "s", time), ("Crank angle", "deg", 360.0 * time + 5.0 * np.sin(9.0 * time)),
               ("MOTION_1.TZ", "N*m", np.cos(time)))  # fmt: skip
    name, write = chance.choice(sorted(LAYOUTS.items()))
    content = write([layouts.Channel(*column) for column in columns])
    path, binary = folder / name, content if isinstance(content, bytes) else content.encode()
    path.write_bytes(changed(binary.decode("latin-1"), chance).encode("latin-1", "ignore"))
    _crank_motion(read_results([path], JUKI, SAID.get(name, ())), None, 0.0)


def run(folder, chance):
    """Run a command on a changed linkage."""
    words = chance.choice([["check"], ["results", "-q"], ["list"], ["results", "--json"]])
    done = command(words[0], changed_linkage(folder, chance), *words[1:])
    assert done.returncode in (0, 2), done.stderr


@pytest.mark.nightly
@pytest.mark.parametrize(
    ("attempt", "seed"),
    [(kind, seed) for kind, count in ((compute, 50), (judge, 20), (read, 30), (run, 5)) for seed in range(count)],
)
def test_a_hundred_of_them_are_answered_or_refused(tmp_path, attempt, seed):
    chance, faults = random.Random(seed), []
    for number in range(100):
        try:
            with time_limit(SECONDS, signal.ITIMER_PROF, signal.SIGPROF), warnings.catch_warnings():
                warnings.simplefilter("error")
                attempt(tmp_path, chance)
        except LinkproofError:
            pass
        except (Exception, LateError) as error:
            faults.append(f"{number}: {type(error).__name__}: {error}"[:300])
    assert faults == []
