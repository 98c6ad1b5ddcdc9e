"""What all tests share: property tests without deadlines, the same examples every time on CI; Ctrl-C as it is."""

import gc
import os
import signal
import sys

import pytest
from hypothesis import HealthCheck, settings

from comparisons.trials.runs.worker_process import start_server
from tests.pages import browser

settings.register_profile(
    "steady", deadline=None, suppress_health_check=[HealthCheck.too_slow], derandomize=bool(os.environ.get("CI"))
)
settings.load_profile("steady")

# A shell starts background jobs with SIGINT ignored, which children inherit: tests of Ctrl-C would send it in vain.
signal.signal(signal.SIGINT, signal.default_int_handler)

# Bytecode is written once for all processes, also by a shell that forbids it: hundreds of them import the same files.
sys.dont_write_bytecode = False
os.environ.pop("PYTHONDONTWRITEBYTECODE", None)


def pytest_collection_finish():
    """What is there by now stays: looking through all of it for garbage takes a twentieth of the time."""
    gc.collect()
    gc.freeze()
    gc.set_threshold(50_000)  # as in a command


@pytest.fixture(autouse=True, scope="session")
def _workers_are_forked_with_what_they_need():
    """The server starts once, and the first test to use it would settle what every worker imports for itself."""
    start_server(["comparisons.trials.conformance.conformance", "engines.direct_adapter.adapter"])


@pytest.fixture(scope="session")
def _at_a_browser():
    """A browser is there, or the test is skipped or fails."""
    browser.demand()


@pytest.fixture(scope="session")
def launched(_at_a_browser):
    """One browser for all tests of a process: a function from its name."""
    with browser.launching() as found:
        yield found
