"""The command line as a user meets it: exit codes, JSON, one sentence for every fault; streams, signals, imports."""

import dataclasses
import inspect
import json
import os
import re
import signal
import subprocess
import sys
from contextlib import suppress
from pathlib import Path
from tempfile import TemporaryDirectory

import pytest

from analytic.description.loading import load as load_linkage
from comparisons.trials.runs.files import STORE
from engines.pymunk_adapter.adapter import PymunkEngine
from reports.api import campaign, trials
from reports.api.options import Bounds, Motion, silent
from reports.api.trials import bench, compare
from reports.studies.trials import Comparison
from tests.commands import COMMAND, ROOT, linkproof, process, refused, stored_runs
from tests.comparisons.faults import announce, wait_for

NAME = "juki-mf7923d"
REPORT = {"RESULTS.md", "assets", "data", "figures", "index.html", STORE, "mechanisms"}
LINKAGES = Path(__file__).parents[1] / "linkages"
RECORD = {
    "mechanism", "variant", "regime", "engine", "setting", "quantity", "unit", "error_max", "error_rms", "limit",
    "outcome", "seconds", "steps",
}  # fmt: skip


@pytest.mark.parametrize(
    ("words", "fields"),
    [
        (("list",), {"mechanism", "shelf", "source", "variants", "title"}),
        (("compare", NAME, "--engine", "direct"), RECORD),
        (("list", NAME), {"mechanism", "variant", "figures", "numbers"}),
        (("check", NAME), {"source", "variants", "links", "Jeq", "output", "structure"}),
        (("engines", "direct"), {"engine", "drives", "joints", "loads", "settings", "readouts", "unusable"}),
    ],
    ids=lambda value: value[0] if isinstance(value, tuple) else "",
)
def test_stdout_holds_json_alone_with_these_fields(words, fields):
    document = json.loads(linkproof(*words, "--json").stdout)
    records = document.get("records", [document])
    assert records
    assert all(fields <= set(row) for row in records)


def test_a_report_is_written_in_a_folder_whose_name_looks_like_markup(tmp_path):
    out = Path("o/[/x]")
    words = ("--engine", "direct", "--quantity", "Jeq", "--out", out)
    done = linkproof("compare", LINKAGES / "markup-names.toml", *words, cwd=tmp_path)
    assert (done.returncode, done.stderr) == (0, f"wrote {out / 'index.html'}\n")
    folder = tmp_path / out
    assert {path.name for path in folder.iterdir()} == REPORT


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        (["check", "juki"], "did you mean 'juki-mf7923d'?"),
        (["results", "minee.toml"], "which does not exist; check the path; did you mean 'mine.toml'?"),
        (["sweep", NAME, "--vary", "crank.mass=1:2:3", "--quantity", "peak_torque"], "did you mean 'Mkr.peak'?"),
        (["check", NAME, "--variant", "as-bilt"], "did you mean 'as-built'?"),
        (["compare", NAME, "--quantity", "Jek"], "did you mean 'Jeq'?"),
        (["compare", "slotted-takeup", "--regime", "fre"], "did you mean 'free'?"),
        (["compare", NAME, "--engine", "exodyn"], "did you mean 'exudyn'?"),
        (["compare", "no/such.toml"], "got 'no/such.toml', which does not exist"),
        (["compare", NAME, "--engine", "direct", "--save", "/dev/null/r.json"], "cannot write"),
        (["results", NAME, "--save", "none/r.csv"], "the folder 'none' does not exist; make it, or name another"),
        (["compare", NAME, "-q", "-v"], "--quiet and --verbose exclude each other"),
        (["compare", "slotted-takeup", "--regime", "free", "--quantity", "Mkr"], "is given, not a result"),
    ],
    ids=lambda value: " ".join(value) if isinstance(value, list) else "",
)
def test_misuse_is_one_sentence_and_exit_code_2(tmp_path, words, sentence):
    (tmp_path / "mine.toml").touch()
    assert sentence in refused(*words, cwd=tmp_path)


def test_an_engine_that_is_not_installed_is_refused_where_it_is_named_and_left_out_where_it_is_not(monkeypatch):
    monkeypatch.setattr(PymunkEngine, "why_unavailable", lambda _: "pymunk is not installed: install it")
    monkeypatch.setattr("reports.api.campaign.engine_names", lambda: ("direct", "pymunk"))
    assert "pymunk is not installed: install it; or leave it out" in refused("compare", NAME, "--engine", "pymunk")
    done = linkproof("compare", NAME, "--quantity", "Jeq", "--json", "--jobs", "0", "--verbose")
    outcomes = {row["engine"]: row["outcome"] for row in json.loads(done.stdout)["records"]}
    assert (outcomes, done.returncode) == ({"direct": "passed"}, 0)
    assert "not installed, left out: pymunk" in done.stderr


def test_a_quiet_run_prints_one_line_and_a_verbose_one_every_record():
    words = ("compare", NAME, "--engine", "direct", "--quantity", "joint_force", "--jobs", "0")
    quiet = linkproof(*words, "--quiet")
    assert (quiet.stdout.count("\n"), "passed" in quiet.stdout, quiet.stderr) == (1, True, "")
    verbose = linkproof(*words, "--verbose").stdout
    assert verbose.endswith(quiet.stdout)
    assert verbose.count("joint_force:") == int(quiet.stdout.split()[0])


@pytest.mark.parametrize(
    ("error", "code", "sentence"),
    [
        (TypeError("a slip"), 3, "this is a fault of linkproof: TypeError: a slip (reports/api/"),
        (MemoryError(), 1, "out of memory: run fewer at once, or raise --memory-limit\n"),
    ],
)
def test_a_fault_of_ours_and_memory_at_its_limit_are_one_sentence(monkeypatch, error, code, sentence):
    def fail():
        raise error

    monkeypatch.setattr("reports.designs.shelves.listed_mechanisms", fail)
    done = linkproof("list")
    assert (done.returncode, done.stderr.count("\n")) == (code, 1)
    assert done.stderr.startswith(f"linkproof: {sentence}")


# What follows is about a process: each test starts one.
def test_output_to_a_small_character_set_is_readable():
    done = process("results", NAME, text=False, PYTHONIOENCODING="cp1252")
    assert (done.returncode, done.stderr) == (0, b"")
    assert "phi from 0° to 360°" in done.stdout.decode("cp1252")


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="needs a device that is always full")
def test_a_full_stdout_is_one_sentence():
    with open("/dev/full", "w") as full:
        done = process("list", "--json", stdout=full)
    assert done.returncode == 2
    assert re.fullmatch("linkproof: cannot write to stdout: .*\n", done.stderr)


@pytest.mark.nightly
@pytest.mark.skipif(sys.platform == "win32", reason="pipes differ there")
def test_a_reader_that_leaves_costs_no_report(tmp_path):
    words = ("compare", NAME, "--engine", "direct", "--quantity", "Jeq", "--jobs", "0", "--json", "--out", "o")
    reading, writing = os.pipe()
    os.close(reading)
    with os.fdopen(writing, "wb") as pipe:
        done = process(*words, cwd=tmp_path, stdout=pipe)
    assert done.returncode == 0, done.stderr
    assert {path.name for path in (tmp_path / "o").iterdir()} >= {STORE, "index.html", "RESULTS.md"}


PRESSED = """
import sys
class Press:
    def find_spec(self, name, path=None, target=None):
        if name == "numpy":
            raise KeyboardInterrupt
sys.meta_path.insert(0, Press())
from reports.command_line.main import main
main()
"""


def test_ctrl_c_during_an_import_is_one_sentence():
    done = subprocess.run([sys.executable, "-c", PRESSED, "check", NAME], cwd=ROOT, capture_output=True, check=False)
    assert (done.returncode, done.stdout) == (130, b"")
    assert done.stderr.decode() == "linkproof: interrupted; nothing was written\n"


GATED = """
from engines.contract import Setting
from engines.direct_adapter.adapter import DirectEngine
from tests.comparisons.faults import slow

class GatedEngine(DirectEngine):
    name = "gated"

    def run(self, scene, setting):
        if setting is Setting.BEST:
            slow({gate!r})
        return super().run(scene, setting)
"""


@pytest.fixture
def gate(tmp_path, monkeypatch):
    """The file for which the engine 'gated' waits in one of its settings."""
    folder = tmp_path / "installed"
    folder.mkdir()
    (folder / "gated_engine.py").write_text(GATED.format(gate=str(tmp_path / "gate")))
    announce(folder, "gated-engine", {"gated": "gated_engine:GatedEngine"})
    monkeypatch.syspath_prepend(folder)
    monkeypatch.setenv("PYTHONPATH", os.pathsep.join([str(folder), str(ROOT)]))
    return tmp_path / "gate"


@pytest.fixture
def short_folder():
    """An empty folder whose sockets have paths of no more than the 107 letters that Linux takes."""
    with TemporaryDirectory(dir="/tmp") as name:
        yield Path(name)


def interrupted(*words, by, when):
    """Send a signal to every process of a terminal's foreground, as Ctrl-C does, as soon as ``when()`` is true."""
    command, pipe = [*COMMAND, *map(str, words)], subprocess.PIPE
    with subprocess.Popen(command, stdout=pipe, stderr=pipe, text=True, start_new_session=True) as running:
        wait_for(lambda: when() or running.poll() is not None)
        os.killpg(running.pid, by)
        out, err = running.communicate()
    return subprocess.CompletedProcess(command, running.returncode, out, err)


def untimed(rows):
    return [{name: value for name, value in row.items() if name not in {"seconds", "setup_seconds"}} for row in rows]


@pytest.mark.skipif(os.name != "posix", reason="sends signals to process groups")
@pytest.mark.parametrize("by", [signal.SIGINT, pytest.param(signal.SIGTERM, marks=pytest.mark.nightly)])
def test_an_interrupted_campaign_is_finished_by_its_folder_alone(tmp_path, gate, monkeypatch, short_folder, by):
    monkeypatch.setenv("TMPDIR", str(short_folder))
    out = tmp_path / "out"
    words = f"compare {NAME} --regime run-up --regime run-up-quintic --engine gated --setting all".split()
    done = interrupted(*words, "--out", out, by=by, when=lambda: stored_runs(out) > 1)
    assert (done.returncode, done.stdout) == (130, "")
    assert wait_for(lambda: not any(short_folder.iterdir()))
    rest = f" of 6 runs are saved in {out}: repeat the command, or linkproof compare --out {out}, to finish\n"
    number = re.fullmatch(rf"linkproof: interrupted; (\d+){re.escape(rest)}", done.stderr)
    assert number is not None, done.stderr
    assert 1 <= int(number[1]) < 6
    assert {path.name for path in out.iterdir()} == {STORE}
    gate.touch()
    done = linkproof("compare", "--out", out, "--json")
    assert (done.returncode, {path.name for path in out.iterdir()}) == (0, REPORT)
    finished, whole = json.loads(done.stdout), json.loads(linkproof(*words, "--json", "--jobs", "0").stdout)
    for part in ("records", "invariants"):
        assert untimed(finished[part]) == untimed(whole[part]) != []


DEFAULTS = {name: each.default for name, each in inspect.signature(compare).parameters.items()}


def begun(folder, text="the file", **options):
    """The keys of the runs that a comparison's folder keeps when it is begun, and is killed after one more."""
    given = DEFAULTS | {"mechanisms": ("juki-mf7923d",), "out": folder, "announce": silent} | options
    linkages, keys = [dataclasses.replace(load_linkage("juki-mf7923d"), text=text)], []

    def make(finished, _):
        keys.extend(finished.keys)
        finished.add("run", {})
        raise RuntimeError("killed")

    with suppress(RuntimeError):
        campaign.kept(Comparison, make, compare, given, engines=["direct"], linkages=linkages)
    return keys


def test_the_same_request_goes_on_and_another_one_begins_anew_with_a_remark(tmp_path, capsys):
    for other, words in (
        ({"text": "the file, changed"}, "`file of juki-mf7923d "),
        ({"motion": Motion(speed=2000.0)}, "now `linkproof compare juki-mf7923d --speed 2000`"),
    ):
        begun(tmp_path)
        capsys.readouterr()
        assert begun(tmp_path) == ["run"]
        assert capsys.readouterr().err == ""
        assert begun(tmp_path, **other) == []
        assert words in capsys.readouterr().err


UNFINISHED = {
    "mechanisms": ("juki-mf7923d",), "engine": ("direct",), "motion": Motion(regime="run-up"),
    "bounds": Bounds(time_limit=9.0, jobs=1), "junit": Path("other.xml"),
}  # fmt: skip


def test_a_folder_alone_means_its_own_unfinished_study(tmp_path):
    begun(tmp_path, **UNFINISHED)
    alone = DEFAULTS | {"out": tmp_path, "bounds": Bounds(jobs=2)}

    def called(function, name="compare", **given):
        """What the folder's own study is called with, where the function of this name is called."""

        def stand_in(**arguments):
            return arguments

        stand_in.__signature__, stand_in.__name__ = inspect.signature(function), name
        return trials.own_study(stand_in, given, "Comparison")

    found = called(compare, **alone)
    assert found["bounds"] == Bounds(time_limit=9.0, jobs=2)
    assert {name: found[name] for name in ("engine", "motion", "junit")} == {
        "engine": ("direct",), "motion": Motion(regime="run-up"), "junit": None,
    }  # fmt: skip
    assert called(compare, **alone | {"engine": ("direct",)}) is None
    of_bench = {"mechanisms": (), "motion": Motion(), "engine": (), "quantity": (), "quick": False}
    assert called(bench, "bench", **of_bench | {"out": tmp_path, "announce": silent}) is None
