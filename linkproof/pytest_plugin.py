"""The entry of the pytest plug-in: it imports linkproof only for a project (linkproof.toml) or with --linkproof.

Another project may have its own package ``reports``.
"""

from __future__ import annotations

from pathlib import Path
from types import ModuleType
from typing import TYPE_CHECKING

import pytest

from linkproof import refuse_strangers

if TYPE_CHECKING:
    from reports.pytest_plugin.campaign import Assertion

FILE = "linkproof.toml"


def pytest_addoption(parser: pytest.Parser) -> None:
    """Add ``--linkproof``: linkage files named on the command line are tests in any folder."""
    text = f"test the linkage files (.toml) that are named, though no {FILE} is above them"
    parser.getgroup("linkproof").addoption("--linkproof", action="store_true", help=text)


def pytest_configure(config: pytest.Config) -> None:
    """Register the plug-in in a project."""
    if config.getoption("linkproof") or _has_project(config.rootpath):
        _plugin(config)


def pytest_collect_file(file_path: Path, parent: pytest.Collector) -> pytest.Collector | None:
    """Register the plug-in at the first file of a project further down."""
    config = parent.config
    if file_path.suffix.lower() != ".toml" or config.pluginmanager.has_plugin(FILE) or not _has_project(file_path):
        return None
    collected: pytest.Collector | None = _plugin(config).pytest_collect_file(file_path, parent)
    return collected


@pytest.fixture(scope="session")
def linkproof_compare() -> Assertion:
    """A function that compares a linkage file as ``linkproof compare`` does, and fails the test if the command fails.

    It takes the arguments of ``linkproof.compare`` and returns its ``Comparison``; equal calls compare once a session.
    """
    refuse_strangers()
    from reports.pytest_plugin.campaign import Assertion  # noqa: PLC0415  numpy and all the rest

    return Assertion()


def _has_project(place: Path) -> bool:
    return any((folder / FILE).is_file() for folder in (place, *place.parents))


def _plugin(config: pytest.Config) -> ModuleType:
    try:
        refuse_strangers()
    except ImportError as error:
        raise pytest.UsageError(str(error)) from error
    from reports import pytest_plugin  # noqa: PLC0415  not a stranger's

    config.pluginmanager.register(pytest_plugin, FILE)
    return pytest_plugin
