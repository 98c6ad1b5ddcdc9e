"""What all tests share: property tests without deadlines, the same examples every time on CI; Ctrl-C as it is.

With ``--numprocesses auto`` there is one worker more than cores: browsers and commands are waited for.
"""

import os
import signal

import pytest
from hypothesis import HealthCheck, settings

settings.register_profile(
    "steady", deadline=None, suppress_health_check=[HealthCheck.too_slow], derandomize=bool(os.environ.get("CI"))
)
settings.load_profile("steady")

# A shell starts background jobs with SIGINT ignored, which children inherit: tests of Ctrl-C would send it in vain.
signal.signal(signal.SIGINT, signal.default_int_handler)


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_auto_num_workers(config):
    """Cores that this process may use, and one for those that wait."""
    del config
    return (len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1) + 1
