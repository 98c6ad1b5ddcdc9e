"""The command line as a user meets it: run in this process, or in a process of its own where the test is about one."""

from __future__ import annotations

import gc
import io
import os
import signal
import sqlite3
import subprocess
import sys
from contextlib import chdir, closing, contextmanager, nullcontext, redirect_stderr, redirect_stdout, suppress
from pathlib import Path
from unittest.mock import patch

from comparisons.trials.runs.files import STORE, write_file
from comparisons.trials.runs.workers import LocalPool
from reports.command_line.main import main
from reports.document.html import Picture

ROOT = Path(__file__).parents[1]
COMMAND = (sys.executable, "-m", "reports.command_line.main")


def pool_here(_processes=None):
    """A pool that runs its jobs in this process, which has imported what they need."""
    return LocalPool(0)


def stored_runs(folder):
    """How many runs a command has stored in a folder that it is still writing into."""
    query = "SELECT count(*) FROM runs JOIN studies ON study = studies.id WHERE kind = ''"
    with suppress(sqlite3.OperationalError), closing(sqlite3.connect(f"file:{folder / STORE}?mode=ro", uri=True)) as db:
        return db.execute(query).fetchone()[0]
    return 0  # it is being made, or written to


def empty_picture(files, figure):
    """The picture of a page with nothing in it, for tests of anything but the drawings, which take most of the time."""
    name = f"figures/{Path(files.page.file).stem}/{figure.name}.svg"
    write_file(files._file(name), '<svg xmlns="http://www.w3.org/2000/svg" width="9" height="9"/>')
    return Picture(files.root + name, 9, 9, wide=False)


def linkproof(*words, cwd=None, stderr=None):
    """Output and exit code of a command run in this process, with empty pictures; ``stderr`` as in ``subprocess``."""
    argv, thresholds = ["linkproof", *map(str, words)], gc.get_threshold()
    out, code = io.StringIO(), 0
    err = out if stderr == subprocess.STDOUT else io.StringIO()
    here = patch("reports.site.LocalPool", pool_here)
    place = nullcontext() if cwd is None else chdir(cwd)
    drawing = patch("reports.document.html._PageFiles.picture", empty_picture)
    with here, drawing, place, patch.object(sys, "argv", argv), redirect_stdout(out), redirect_stderr(err):
        try:
            main()
        except SystemExit as end:
            code = end.code or 0
        finally:
            gc.set_threshold(*thresholds)
    return subprocess.CompletedProcess(argv, code, out.getvalue(), err.getvalue())


def process(*words, cwd=None, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, **environment):
    """The same of a process of its own, with more in its environment."""
    path = os.pathsep.join(filter(None, [environment.pop("PYTHONPATH", ""), str(ROOT)]))
    return subprocess.run(
        [*COMMAND, *map(str, words)],
        stdout=stdout, stderr=stderr, text=text, cwd=cwd, check=False,
        env=os.environ | environment | {"PYTHONPATH": path},
    )  # fmt: skip


def refused(*words, cwd=None):
    """The sentence of a command that has to fail with exit code 2, nothing on stdout and one line on stderr."""
    done = linkproof(*words, cwd=cwd)
    assert done.returncode == 2, done.stderr
    assert done.stdout == ""
    assert done.stderr.startswith("linkproof: ")
    assert done.stderr.count("\n") == 1
    return done.stderr


@contextmanager
def watching(file, *words):
    """The address that ``linkproof watch`` serves a file at; it ends by Ctrl-C, with nothing more to say."""
    command = [*COMMAND, "watch", str(file), "--no-open", *words]
    environment = os.environ | {"PYTHONPATH": str(ROOT)}
    with subprocess.Popen(command, stderr=subprocess.PIPE, text=True, env=environment) as server:
        try:
            address, note = server.stderr.readline().rstrip("\n"), server.stderr.readline()
            assert address.startswith("http://127.0.0.1:"), address
            assert note.endswith("Ctrl-C ends it.\n"), note
            yield address
        finally:
            server.send_signal(signal.SIGINT)
            rest = server.stderr.read()
    assert (server.returncode, rest) == (0, "")
