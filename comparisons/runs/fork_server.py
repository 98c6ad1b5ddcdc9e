"""The server that forks workers clears up after them; imported by that server alone.

It ends when the command and all workers have ended, by whatever signal, and then ends what their engines have started
and removes the folder of their temporary files. A signal to the group of the command's processes does not reach it.
"""

from __future__ import annotations

import atexit
import contextlib
import ctypes
import os
import shutil
import signal
import sys
from multiprocessing import forkserver
from pathlib import Path
from typing import Any, Final

_PR_SET_CHILD_SUBREAPER: Final = 36


def _clear_up() -> None:
    with contextlib.suppress(OSError):  # a system that does not list them
        while children := Path(f"/proc/self/task/{os.getpid()}/children").read_text(encoding="ascii").split():
            for child in map(int, children):
                os.kill(child, signal.SIGKILL)
                os.waitpid(child, 0)
    server: Any = forkserver
    shutil.rmtree(Path(server._forkserver._forkserver_address).parent, ignore_errors=True)


os.setpgid(0, 0)
if sys.platform.startswith("linux"):  # children of processes that have ended become its own
    ctypes.CDLL(None).prctl(_PR_SET_CHILD_SUBREAPER, 1)
atexit.register(_clear_up)
