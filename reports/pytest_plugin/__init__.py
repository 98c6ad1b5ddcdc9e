"""linkproof in pytest: a project's linkage files are collected as tests, one for every engine and quantity.

``linkproof.pytest_plugin`` registers this module in a project. Nothing but pytest is imported before the first linkage
file.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from importlib.metadata import entry_points
from pathlib import Path
from typing import Final

import pytest

FILE: Final = "linkproof.toml"  # as in comparisons.campaign.project, which imports numpy
ENGINES: Final = "linkproof.engines"  # as in engines.registry, which imports numpy


def pytest_configure(config: pytest.Config) -> None:
    """Announce the markers in a project."""
    if config.getoption("linkproof") or _has_project(config.rootpath):
        _announce_markers(config)


def pytest_collect_file(file_path: Path, parent: pytest.Collector) -> pytest.Collector | None:
    """The tests of a linkage file that its project lists, or that is named with ``--linkproof``.

    The file of a project is collected if it is named; else with the first of its linkages.
    """
    if file_path.suffix.lower() != ".toml":
        return None
    if file_path.name == FILE:
        return _project_tests(file_path, parent) if parent.session.isinitpath(file_path) else None
    is_named = parent.config.getoption("linkproof") and parent.session.isinitpath(file_path)
    if not is_named and not _has_project(file_path.parent):
        return None
    from reports.pytest_plugin.collecting import LinkageTests, is_listed  # noqa: PLC0415  numpy and all the rest

    if not is_named and not is_listed(file_path):
        return None
    _announce_markers(parent.config)
    tests: LinkageTests = LinkageTests.from_parent(parent, path=file_path)
    return tests


def _project_tests(file: Path, parent: pytest.Collector) -> pytest.Collector:
    from reports.pytest_plugin.collecting import ProjectTests  # noqa: PLC0415

    _announce_markers(parent.config)
    tests: ProjectTests = ProjectTests.from_parent(parent, path=file)
    return tests


def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter) -> None:
    """Print why linkage tests were skipped, unless pytest does (``-rs``)."""
    skipped = terminalreporter.stats.get("skipped", [])
    ours = [report.longrepr for report in skipped if "linkproof" in report.keywords]
    if ours and not terminalreporter.hasopt("skipped"):
        terminalreporter.section("linkproof: skipped")
        for reason, count in Counter(_skip_reason(skip) for skip in ours).items():
            terminalreporter.line(f"{count} of: {reason}")


def _skip_reason(skip: Sequence[object]) -> str:
    return str(skip[-1]).removeprefix("Skipped: ")


def _has_project(folder: Path) -> bool:
    return any((above / FILE).is_file() for above in (folder, *folder.parents))


def _announce_markers(config: pytest.Config) -> None:
    known = config.getini("markers")
    names = sorted({entry.name for entry in entry_points(group=ENGINES)})
    markers = {"linkproof": "a test of a linkage file", **{name: f"a run of the engine {name}" for name in names}}
    for name, text in markers.items():
        if f"{name}: {text}" not in known:
            config.addinivalue_line("markers", f"{name}: {text}")
