"""The command line as a user meets it: exit codes, JSON, one sentence for every fault."""

import json
import os
import re
import signal
import subprocess
import sys
from dataclasses import asdict
from pathlib import Path

import pytest

from analytic.description.loading import catalogue, literature
from analytic.errors import LinkproofError
from comparisons.campaign.results import load
from comparisons.runs.journal import FOLDER
from comparisons.runs.record_file import RECORDS
from tests.commands import COMMAND, ROOT, linkproof, refused
from tests.comparisons.faults import announce, children, wait_for

JUKI = ROOT / "analytic" / "catalogue" / "juki-mf7923d.toml"

REPORT = {
    "RESULTS.md",
    "assets",
    "compare",
    "data",
    "figures",
    "index.html",
    "mechanisms",
    "mechanisms.json",
}


def test_help_imports_nothing_heavy():
    script = (
        "import sys; sys.argv = ['linkproof', '--help']\n"
        "from reports.command_line.main import main\n"
        "try:\n main()\nexcept SystemExit: pass\n"
        "print([m for m in ('numpy', 'pydantic', 'exudyn', 'pymunk', 'matplotlib', 'rich') if m in sys.modules])"
    )
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True)
    assert "compare" in done.stdout
    assert done.stdout.strip().endswith("[]")


def test_list_names_the_catalogue():
    rows = json.loads(linkproof("list", "--json", "-").stdout)["records"]
    assert {"juki-mf7923d", "rimoldi-164"} <= {row["mechanism"] for row in rows}
    assert all(row["source"] and row["variants"] for row in rows)
    assert {row["shelf"] for row in rows if row["mechanism"] in catalogue()} == {"catalogue"}
    assert {row["mechanism"] for row in rows if row["shelf"] == "literature"} == set(literature())
    assert "juki-mf7923d" in linkproof("list").stdout


def test_a_new_file_is_checked_and_a_fault_in_it_told_behind_what_is_right(tmp_path):
    assert linkproof("new", "mine", cwd=tmp_path).returncode == 0
    done = linkproof("check", "mine.toml", "--svg", "scheme.svg", cwd=tmp_path)
    assert (done.returncode, done.stderr) == (0, "")
    assert "crank        turns fully" in done.stdout
    assert "</svg>" in (tmp_path / "scheme.svg").read_text(encoding="utf-8")
    mine = tmp_path / "mine.toml"
    mine.write_text(mine.read_text(encoding="utf-8").replace("O2 = [0, 0]", "o2 = [0, 0]"), encoding="utf-8")
    done = linkproof("check", "mine.toml", cwd=tmp_path)
    assert done.returncode == 2
    assert "mobility     3 = 3·3 links - 2·3 pins and slides" in done.stdout
    assert done.stderr.startswith("linkproof: 'mine': expected mobility 1, got 3")
    assert done.stderr.count("\n") == 1
    refused("new", "mine", cwd=tmp_path)


def test_the_schema_is_json():
    assert json.loads(linkproof("schema").stdout)["title"] == "linkproof linkage file"


def test_show_gives_the_reduced_inertia_of_a_variant():
    facts = json.loads(linkproof("show", "juki-mf7923d", "--variant", "as-printed", "--json", "-").stdout)
    assert facts["Jeq"]["mean"] == pytest.approx(8.339e-5, rel=1e-4)
    assert facts["Jeq"]["max"] == pytest.approx(9.128e-5, rel=1e-4)
    assert facts["Jeq"]["min"] < facts["Jeq"]["mean"]
    assert "RRP" in facts["structure"]
    text = linkproof("show", "juki-mf7923d").stdout
    assert "stroke 31 mm" in text


def test_published_lists_every_figure_in_every_variant():
    rows = json.loads(linkproof("published", "rimoldi-164", "--json", "-").stdout)["records"]
    fields = {"mechanism", "variant", "quantity", "published", "ours", "deviation", "verdict", "source"}
    assert all(fields <= set(row) for row in rows)
    assert {"as-built", "as-printed"} <= {row["variant"] for row in rows}


def test_compare_writes_json_records_and_exits_0(tmp_path):
    done = linkproof("compare", "juki-mf7923d", "--engine", "direct", "--json", tmp_path / "r.json")
    assert done.returncode == 0, done.stdout + done.stderr
    assert "direct" in done.stdout
    rows = json.loads((tmp_path / "r.json").read_text())["records"]
    fields = {
        "mechanism", "variant", "regime", "engine", "setting", "quantity", "unit", "error_max", "error_rms", "limit",
        "outcome", "seconds", "steps",
    }  # fmt: skip
    assert all(fields <= set(row) for row in rows)
    assert [row["quantity"] for row in rows][:7] == ["Jeq", "Teq", "Mkr", "Peq", "S", "v", "a"]
    assert {(r["variant"], r["regime"], r["setting"]) for r in rows} == {("as-built", "run-up", "tuned")}


def test_json_on_stdout_is_nothing_but_json():
    done = linkproof("compare", "juki-mf7923d", "--engine", "direct", "--quantity", "Jeq", "--json", "-")
    assert [row["quantity"] for row in json.loads(done.stdout)["records"]] == ["Jeq"]


def test_naive_alone_over_its_limit_exits_1():
    pytest.importorskip("pymunk")
    done = linkproof("compare", "juki-mf7923d", "--engine", "pymunk", "--setting", "naive", "--quantity", "Mkr")
    assert done.returncode == 1
    assert "over-limit" in done.stdout


def test_a_users_own_file_runs_from_where_it_lies(tmp_path):
    mine = tmp_path / "mine.toml"
    mine.write_text(JUKI.read_text())
    done = linkproof("compare", "mine.toml", "--engine", "direct", "--quantity", "Mkr", "--json", "-", cwd=tmp_path)
    (record,) = json.loads(done.stdout)["records"]
    assert record["mechanism"] == "mine"
    assert record["outcome"] == "passed"


def test_out_holds_all_and_the_report_is_rebuilt_from_it(tmp_path):
    done = linkproof("compare", "juki-mf7923d", "--engine", "direct", "--out", tmp_path / "out")
    assert done.returncode == 0, done.stderr
    assert {path.name for path in (tmp_path / "out").iterdir()} == REPORT
    page = (tmp_path / "out" / "index.html").read_text()
    (tmp_path / "out" / "index.html").unlink()
    assert linkproof("report", tmp_path / "out").returncode == 0
    assert (tmp_path / "out" / "index.html").read_text() == page
    (tmp_path / "out" / "mechanisms.json").unlink()
    assert "run compare with --out again" in refused("report", tmp_path / "out")


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        (["show", "juki"], "did you mean 'juki-mf7923d'?"),
        (["show", "juki-mf7923d", "--variant", "as-bilt"], "did you mean 'as-built'?"),
        (["compare", "juki-mf7923d", "--quantity", "Jek"], "did you mean 'Jeq'?"),
        (["compare", "juki-mf7923d", "--regime", "runup"], "did you mean 'run-up'?"),
        (["compare", "juki-mf7923d", "--engine", "exodyn"], "did you mean 'exudyn'?"),
        (["compare", "juki-mf7923d", "--setting", "tunned"], "did you mean 'tuned'?"),
        (["compare", "no/such.toml"], "got 'no/such.toml', which does not exist"),
        (["compare", "juki-mf7923d", "--speed", "0"], "--speed: expected a finite number of rpm other than 0, got 0"),
        (["compare", "juki-mf7923d", "--speed", "nan"], "expected a finite number"),
        (["compare", "juki-mf7923d", "--ramp-time", "0"], "expected a positive finite number"),
        (["report", "no/such/folder"], "nothing to report in"),
        (["compare", "juki-mf7923d", "--engine", "direct", "--json", "/dev/null/r.json"], "cannot write"),
        (["compare", "juki-mf7923d", "-q", "-v"], "--quiet and --verbose exclude each other"),
        (["compare", "juki-mf7923d", "--resume"], "name it with --out"),
        (["compare", "juki-mf7923d", "--time-limit", "0"], "expected a positive finite number of s, got 0"),
        (["compare", "juki-mf7923d", "--memory-limit", "inf"], "expected a positive finite number of GiB, got inf"),
        (["compare", "juki-mf7923d", "--jobs", "-1"], "expected a number of processes, or 0 for none, got -1"),
        (["compare", "juki-mf7923d", "--jobs", "0", "--time-limit", "9"], "--jobs 0 starts none"),
    ],
)
def test_misuse_is_one_sentence_and_exit_code_2(words, sentence):
    assert sentence in refused(*words)


@pytest.mark.parametrize(
    ("old", "new", "sentence"),
    [
        ("mass    = 0.03", "mass    = -0.03", "got -0.03"),
        ("mass    = 0.03", "mass    = nan", "got nan"),
        ("inertia = 0.19e-4\n", "", "links.coupler.inertia is missing"),
        ("D = [54.5, 0]", "D = [0, 0]", "got 0; move one of them"),
        ("D = [54.5, 0]", "D = [10.0, 0]", "cannot be assembled at"),
        ('length = "mm"', 'length = "mmm"', "did you mean 'mm'?"),
        ("[links.coupler]", "[links.coupler", "mine.toml:24: not valid TOML"),
        ("mass    = 0.03", "mas     = 0.03", "did you mean 'mass'?"),
        ('crank   = "crank"', 'crank   = "crnk"', "did you mean 'crank'?"),
    ],
)
def test_a_bad_file_is_one_sentence_and_nothing_is_written(tmp_path, old, new, sentence):
    text = JUKI.read_text()
    assert old in text
    (tmp_path / "mine.toml").write_text(text.replace(old, new))
    assert sentence in refused("compare", "mine.toml", "--out", "out", "--json", "r.json", cwd=tmp_path)
    assert [path.name for path in tmp_path.iterdir()] == ["mine.toml"]


BLOCKED = """
import importlib.metadata, runpy, sys
known = importlib.metadata.version
def version(name):
    if name == "pymunk":
        raise importlib.metadata.PackageNotFoundError(name)
    return known(name)
importlib.metadata.version = version
class Absent:
    def find_spec(self, name, path=None, target=None):
        if name.split(".")[0] == "pymunk":
            raise ModuleNotFoundError("No module named 'pymunk'", name="pymunk")
sys.meta_path.insert(0, Absent())
sys.argv = ["linkproof", "compare", "juki-mf7923d", *sys.argv[1:]]
runpy.run_module("reports.command_line.main", run_name="__main__")
"""


def without_pymunk(*words):
    command = [sys.executable, "-c", BLOCKED, *words]
    return subprocess.run(command, capture_output=True, text=True, check=False)


def test_an_engine_that_is_not_installed_is_refused_where_it_is_named():
    done = without_pymunk("--engine", "pymunk")
    assert done.returncode == 2
    cure = "pip install --upgrade 'linkproof[pymunk]' brings it; or leave it out"
    assert f"pymunk is not installed: {cure}" in done.stderr


def test_an_engine_that_is_not_installed_is_a_visible_row_where_it_is_not_named():
    done = without_pymunk("--quantity", "Jeq", "--json", "-", "--jobs", "0")  # blocked in this process alone
    outcomes = {row["engine"]: row["outcome"] for row in json.loads(done.stdout)["records"]}
    assert outcomes["pymunk"] == "unavailable"
    assert outcomes["direct"] == "passed"
    assert done.returncode == 0


def test_thread_feed_is_held_against_a_required_curve(tmp_path):
    (tmp_path / "required.csv").write_text("phi_deg,feed_mm\n0,10\n90,20\n")
    words = ("thread", "slotted-takeup", "--required", tmp_path / "required.csv")
    facts = json.loads(linkproof(*words, "--json", "-").stdout)
    assert facts["feed"]["min"] == pytest.approx(6e-3, abs=1e-5)
    held = facts["comparison"]
    assert [a - r for a, r in zip(held["actual"], held["required"], strict=True)] == pytest.approx(held["difference"])
    assert "largest difference" in linkproof(*words).stdout


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        (["thread", "juki-mf7923d"], "has no thread"),
        (["thread", "slotted-takeup", "--required", "none.csv"], "none.csv"),
        (["compare", "juki-mf7923d", "--quantity", "thread_feed"], "has no thread"),
        (["compare", "slotted-takeup", "--regime", "fre"], "did you mean 'free'?"),
        (["compare", "slotted-takeup", "--regime", "free", "--quantity", "Mkr"], "is given, not a result"),
    ],
)
def test_misuse_of_thread_and_own_regimes_is_one_sentence(tmp_path, words, sentence):
    assert sentence in refused(*words, cwd=tmp_path)


def test_a_released_crank_is_compared_by_its_own_motion():
    words = ("compare", "slotted-takeup", "--regime", "free", "--engine", "direct", "--quantity", "phi", "--json", "-")
    (record,) = json.loads(linkproof(*words).stdout)["records"]
    assert record["outcome"] == "passed"
    assert record["error_max"] < 1e-12


def test_errata_of_a_users_own_file_are_judged_by_its_own_variants(tmp_path):
    mine = tmp_path / "mine.toml"
    mine.write_text((JUKI.parent / "two-crank-takeup.toml").read_text())
    words = ("compare", mine, "--regime", "own", "--engine", "direct", "--quantity", "phi", "--json", "-")
    done = linkproof(*words)
    assert done.returncode == 0, done.stderr
    judged = {row["erratum"]: row["supports"] for row in json.loads(done.stdout)["errata"]}
    assert judged == {"S1 without US1": "corrected", "1000 fixed Runge-Kutta steps": "corrected"}


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


def interrupted(*words, when):
    """Press Ctrl-C, which every process of a terminal's foreground hears, as soon as ``when(process)`` says so."""
    command, pipe = [*COMMAND, *map(str, words)], subprocess.PIPE
    with subprocess.Popen(command, stdout=pipe, stderr=pipe, text=True, start_new_session=True) as running:
        wait_for(lambda: when(running.pid) or running.poll() is not None)
        os.killpg(running.pid, signal.SIGINT)
        out, err = running.communicate()
    return subprocess.CompletedProcess(command, running.returncode, out, err)


def lines(path):
    return path.read_bytes().count(b"\n") if path.is_file() else 0


def untimed(path):
    told = json.loads(path.read_text())
    return [untimed_row(row) for row in (*told["records"], *told["invariants"])]


def untimed_row(row):
    return {name: value for name, value in row.items() if name not in {"seconds", "setup_seconds"}}


@pytest.mark.skipif(os.name != "posix", reason="sends signals to process groups")
def test_a_campaign_interrupted_is_finished_by_resume(tmp_path, gate):
    words = ("compare", "juki-mf7923d", "--engine", "gated", "--setting", "all", "--regime", "all")
    place = tmp_path / "out" / FOLDER
    done = interrupted(*words, "--out", tmp_path / "out", when=lambda _: lines(place / RECORDS) > 1)
    assert done.returncode == 130
    assert done.stdout == ""
    kept = re.fullmatch(
        r"linkproof: interrupted; (\d+) of 12 runs are saved in (.*): repeat the command with --resume to finish\n",
        done.stderr,
    )
    assert kept is not None, done.stderr
    assert kept[2] == str(tmp_path / "out")
    assert 1 <= int(kept[1]) < 12
    assert {path.name for path in (tmp_path / "out").iterdir()} == {FOLDER}
    told = refused("compare", "juki-mf7923d", "--resume", "--out", tmp_path / "out")
    assert "`linkproof compare juki-mf7923d --regime all --engine gated --setting all`, got `linkproof" in told
    gate.touch()
    assert linkproof(*words, "--out", tmp_path / "out", "--resume").returncode == 0
    assert {path.name for path in (tmp_path / "out").iterdir()} == REPORT
    assert linkproof(*words, "--json", tmp_path / "here.json", "--jobs", "0").returncode == 0
    saved = load(tmp_path / "out")
    rows = [untimed_row(asdict(record)) for record in (*saved.records, *saved.invariants)]
    assert rows == untimed(tmp_path / "here.json")


def test_a_campaign_begun_anew_discards_what_was_unfinished(tmp_path):
    place = tmp_path / "out" / FOLDER
    place.mkdir(parents=True)
    (place / "request.txt").write_text("linkproof compare something else")
    done = linkproof("compare", "juki-mf7923d", "--engine", "direct", "--quantity", "Jeq", "--out", tmp_path / "out")
    assert done.returncode == 0, done.stderr
    assert not place.exists()


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="reads /proc")
def test_without_a_folder_an_interruption_leaves_nothing():
    done = interrupted("compare", "--regime", "all", when=children)
    assert (done.returncode, done.stdout) == (130, "")
    assert done.stderr == "linkproof: interrupted; nothing was written\n"


MARKUP = Path(__file__).parents[1] / "linkages" / "markup-names.toml"
CONTROLS = Path(__file__).parents[1] / "linkages" / "control-characters.toml"


@pytest.mark.parametrize(("command", "shown"), [("show", "[/rod]"), ("published", "Jeq:[/rod].mean")])
def test_names_are_not_read_as_markup(command, shown):
    done = linkproof(command, MARKUP)
    assert (done.returncode, done.stderr) == (0, "")
    assert shown in done.stdout


def test_paths_are_not_read_as_markup(tmp_path):
    done = linkproof("compare", MARKUP, "--engine", "direct", "--out", "o/[/x]", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert done.stderr == f"report: {Path('o/[/x]/index.html')}\n"
    assert linkproof("report", "o/[/x]", cwd=tmp_path).stderr == done.stderr


@pytest.mark.parametrize("command", ["show", "published"])
def test_control_characters_of_a_file_do_not_reach_the_terminal(command):
    assert refused(command, CONTROLS).rstrip("\n").isprintable()


def test_a_quiet_run_says_one_line_and_a_verbose_one_every_record():
    words = ("compare", "juki-mf7923d", "--engine", "direct", "--quantity", "joint_force")
    quiet = linkproof(*words, "--quiet")
    assert quiet.stdout.count("\n") == 1
    assert "passed" in quiet.stdout
    assert quiet.stderr == ""
    verbose = linkproof(*words, "--verbose").stdout
    assert verbose.endswith(quiet.stdout)
    assert verbose.count("joint_force:") == int(quiet.stdout.split()[0])


def test_output_to_a_small_character_set_is_readable():
    environment = os.environ | {"PYTHONIOENCODING": "cp1252"}
    done = subprocess.run([*COMMAND, "published", "juki-mf7923d"], capture_output=True, env=environment, check=False)
    assert (done.returncode, done.stderr) == (0, b"")
    assert "9.127e-05 + +0.3%" in done.stdout.decode("cp1252")


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="needs a device that is always full")
def test_a_full_stdout_is_one_sentence():
    with open("/dev/full", "w") as full:
        done = subprocess.run(
            [*COMMAND, "list", "--json", "-"], stdout=full, stderr=subprocess.PIPE, text=True, check=False
        )
    assert done.returncode == 2
    assert re.fullmatch("linkproof: cannot write to stdout: .*\n", done.stderr)


def test_memory_at_its_limit_is_one_sentence():
    script = "import typer; typer.Typer.__call__ = lambda *_, **__: bytearray(1 << 62)"
    command = [sys.executable, "-c", f"{script}; from reports.command_line.main import main; main()"]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 1
    assert done.stderr == "linkproof: expected more memory, got none that is free; give less at once, or allow more\n"


@pytest.mark.skipif(os.name != "posix", reason="a folder in use cannot be deleted")
def test_a_deleted_working_folder_matters_only_where_it_is_needed(tmp_path):
    script = "import os, sys; os.rmdir(os.getcwd()); from reports.command_line.main import main; main()"
    folder = tmp_path / "gone"
    folder.mkdir()
    done = subprocess.run(
        [sys.executable, "-c", script, "show", "juki-mf7923d"],
        cwd=folder, env=os.environ | {"PYTHONPATH": str(JUKI.parents[2])}, capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert (done.returncode, done.stderr) == (0, "")


PRESSED = """
import sys
module = sys.argv.pop(1)
class Press:
    def find_spec(self, name, path=None, target=None):
        if name == module:
            raise KeyboardInterrupt
sys.meta_path.insert(0, Press())
from reports.command_line.main import main
main()
"""


@pytest.mark.parametrize("module", ["analytic.errors", "numpy"])
def test_an_interruption_of_any_import_is_one_sentence(module):
    command = [sys.executable, "-c", PRESSED, module, "show", "juki-mf7923d"]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert (done.returncode, done.stdout) == (130, "")
    assert done.stderr == "linkproof: interrupted; nothing was written\n"


@pytest.mark.skipif(os.name == "nt", reason="no such shell")
def test_closed_streams_are_no_fault():
    script = f'"{sys.executable}" -m reports.command_line.main schema >&- 2>&-'
    assert subprocess.run(["sh", "-c", script], check=False).returncode == 0


@pytest.mark.parametrize("command", ["bench", "stress"])
def test_a_folder_with_results_takes_new_ones(command, tmp_path, monkeypatch):
    def begin(*_, **__):
        raise LinkproofError("the runs begin")

    monkeypatch.setattr(f"reports.command_line.commands.{command}.journal", begin)
    (tmp_path / command).mkdir()
    assert linkproof(command, "--quick", "--out", tmp_path).stderr == "linkproof: the runs begin\n"
