"""Property tests: no deadline on a busy machine, and on CI the same examples every time."""

import os

from hypothesis import settings

settings.register_profile("steady", deadline=None, derandomize=bool(os.environ.get("CI")))
settings.load_profile("steady")
