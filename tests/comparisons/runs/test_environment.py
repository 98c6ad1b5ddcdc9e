"""What a campaign ran on is told in words."""

import platform

from comparisons.runs import environment


def test_versions_machine_and_commit():
    facts = environment.environment()
    assert facts["python"] == platform.python_version()
    assert {"date", "machine", "commit", "numpy", "scipy", "linkproof"} <= set(facts)
    assert all(facts.values())


def test_an_absent_engine_is_left_out(monkeypatch):
    monkeypatch.setattr(environment, "PACKAGES", ("numpy", "no-such-engine"))
    assert "no-such-engine" not in environment.environment()
