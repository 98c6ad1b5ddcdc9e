"""What all tests share: property tests without deadlines, the same examples every time on CI; Ctrl-C as it is."""

import os
import signal
import sys

from hypothesis import HealthCheck, settings

settings.register_profile(
    "steady", deadline=None, suppress_health_check=[HealthCheck.too_slow], derandomize=bool(os.environ.get("CI"))
)
settings.load_profile("steady")

# A shell starts background jobs with SIGINT ignored, which children inherit: tests of Ctrl-C would send it in vain.
signal.signal(signal.SIGINT, signal.default_int_handler)

# Bytecode is written once for all processes, also by a shell that forbids it: hundreds of them import the same files.
sys.dont_write_bytecode = False
os.environ.pop("PYTHONDONTWRITEBYTECODE", None)
