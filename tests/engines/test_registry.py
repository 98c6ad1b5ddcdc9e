"""Plug-ins that cannot be loaded: each costs its own rows, and says in which file and line."""

import json
import sys

import pytest

from analytic.description.crank_motion import crank_motion
from analytic.description.loading import load
from analytic.kinematics.mechanism import Mechanism
from comparisons.campaign.campaign import CampaignRequest, compare
from comparisons.reference.case import Case
from comparisons.runs.run_engine import AdapterError, run_engine
from comparisons.runs.workers import LocalPool
from engines import registry
from engines.contract import Setting
from engines.scene import Channel
from tests.commands import linkproof, refused
from tests.comparisons.faults import PATIENCE, announce

ADAPTER = """from engines.registry import NO_ABILITIES
class Adapter:
    name = "{name}"
    abilities = NO_ABILITIES
    is_control = False
    def version(self):
        return "1.0"
    def run(self, scene, setting):
        raise ZeroDivisionError("ran")
    def methods(self, scene):
        raise KeyError("methods")
    def run_method(self, scene, method, step):
        raise ZeroDivisionError("ran")
"""
MODULES = {
    "raising": "import math\nraise ValueError('at import')\n",
    "misspelt": "class Adapter:\n    def (\n",
    "needing": "import a_package_that_nobody_has\n",
    "leaving": "import sys\nsys.exit(3)\n",
    "hanging": "import time\nwhile True:\n    time.sleep(0.01)\n",
    "partial": "class Adapter:\n    name = 'partial'\n    def version(self):\n        return None\n",
    "unversioned": ADAPTER.format(name="unversioned").replace('return "1.0"', "return 1 / 0"),
    "failing": ADAPTER.format(name="failing"),
}
REASONS = {
    "raising": "ValueError: at import (FOLDER/raising.py, line 2)",
    "misspelt": "SyntaxError: invalid syntax (misspelt.py, line 2) (FOLDER/misspelt.py, line 2)",
    "needing": "ModuleNotFoundError: No module named 'a_package_that_nobody_has' (FOLDER/needing.py, line 1)",
    "missing": "ModuleNotFoundError: No module named 'missing' (announced in missing)",
    "hanging": "TimeoutError: loading it took longer than 0.3 s (FOLDER/hanging.py, line 3)",
    "partial": "PluginError: expected an adapter with name, abilities, is_control, version, run, got one without "
    "abilities, is_control, run (announced in partial)",
    "unversioned": "ZeroDivisionError: division by zero (FOLDER/unversioned.py, line 7)",
    "failing": "ZeroDivisionError: ran (FOLDER/failing.py, line 9)",
}
CASE = Case(Mechanism(load("juki-mf7923d")), crank_motion("constant-speed", ramp_time=0.03, hold_time=0.0))


@pytest.fixture
def plugins(tmp_path, monkeypatch):
    """A folder on the path with a package that announces all these modules, and one that has the name of another's."""
    for name, text in MODULES.items():
        (tmp_path / f"{name}.py").write_text(text)
    names = [*MODULES, "missing"]
    announce(tmp_path, "some-engines", {name: f"{name}:Adapter" for name in [*names, "twin"]})
    announce(tmp_path, "other-engines", {"twin": "failing:Adapter"})
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.setattr(registry, "LONGEST_LOADING", PATIENCE)
    monkeypatch.setattr(registry, "_FAILED", {})
    yield tmp_path
    for name in names:
        sys.modules.pop(name, None)


def test_an_error_of_a_plugin_is_raised_with_its_file_and_line_when_it_is_run(plugins, monkeypatch):
    reasons = {}
    for name in sorted(REASONS, key="hanging".__eq__):  # the one that is never done comes last
        monkeypatch.setattr(registry, "LONGEST_LOADING", 0.3 if name == "hanging" else PATIENCE)
        for _ in range(2):  # the second time from what is known of the first
            with pytest.raises(AdapterError) as caught:
                run_engine(registry.engine(name), CASE.scene([Channel.TORQUE]), Setting.TUNED)
            reasons[name] = str(caught.value).replace(str(plugins), "FOLDER")
    assert reasons == {name: f"the adapter of {name} raised {words}" for name, words in REASONS.items()}
    with pytest.raises(SystemExit):
        run_engine(registry.engine("leaving"), CASE.scene([Channel.TORQUE]), Setting.TUNED)


def test_two_plugins_of_one_name_are_unavailable_and_both_are_named(plugins):
    twin = registry.engine("twin")
    reason = "engine 'twin' is announced by other-engines 1.0 and some-engines 1.0: uninstall all of them but one"
    assert (twin.version(), registry.why_unavailable(twin)) == (None, reason)
    request = CampaignRequest((CASE.mechanism.linkage,), (CASE.motion,), "", ("direct", "twin"), quantities=("Mkr",))
    direct, other = compare(request, pool=LocalPool(0))
    assert {record.outcome for record in direct.records} == {"passed"}
    assert {(record.outcome, record.detail) for record in other.records} == {("unavailable", reason)}


@pytest.mark.nightly
def test_commands_run_all_other_engines_and_refuse_a_name_that_two_have(plugins, monkeypatch):
    (plugins / "hanging.py").write_text("")  # it would be waited for
    words = ("compare", "juki-mf7923d", "--quantity", "Jeq", "--json", "--jobs", "0")
    done = linkproof(*words, "--engine", "direct", "--engine", "raising")
    assert (done.returncode, done.stderr) == (1, "")
    rows = {row["engine"]: (row["outcome"], row["detail"]) for row in json.loads(done.stdout)["records"]}
    assert rows["direct"] == ("passed", "")
    assert rows["raising"][0] == "adapter-error"
    assert f"({plugins}/raising.py, line 2)" in rows["raising"][1]
    listed = linkproof("engines", "raising", "twin")
    assert (listed.returncode, listed.stderr) == (0, "")
    assert "raising (the adapter of raising raised ValueError: at import (" in listed.stdout
    assert "twin (engine 'twin' is announced by" in listed.stdout
    checked = linkproof("check-engine", "raising")
    assert (checked.returncode, checked.stderr.count("raising.py, line 2")) == (1, 1)
    for command in (("compare", "--engine", "twin"), ("stress", "--engine", "twin"), ("check-engine", "twin")):
        assert "engine 'twin' is announced by other-engines 1.0 and some-engines 1.0" in refused(*command)
