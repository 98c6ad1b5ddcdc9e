"""Jobs and engines that fail in every way, for tests of the workers. Imports little, since workers import it."""

from __future__ import annotations

import ctypes
import os
import signal
import subprocess
import sys
import threading
import time
from contextlib import suppress
from pathlib import Path

LONG, PATIENCE = 3600.0, 600.0  # s that a job hangs, and that a test waits at most


def job(kind, value=None):
    """Call the function of this module named ``kind``; 'fine' returns the value."""
    return globals()[kind](value)


def fine(value):
    return value


def wait_for(condition):
    """Wait until the condition holds, for minutes where a machine is that busy."""
    patience = time.monotonic() + PATIENCE
    while not condition() and time.monotonic() < patience:
        time.sleep(0.01)
    return condition()


class Clock:
    """Time as the pool of workers sees it, which can be made to run faster."""

    sleep, rate = staticmethod(time.sleep), 1.0
    _read = _shown = time.time()

    def time(self):
        now = time.time()
        self._shown, self._read = self._shown + self.rate * (now - self._read), now
        return self._shown


def slow(path):
    """Return the path of a file once it is there."""
    assert wait_for(Path(path).exists)
    return path


def abort(_):
    os.abort()


def leave_at_once(value):
    os._exit(value)


def leave(value):
    sys.exit(value)


def swell(_):
    held = []
    while True:
        held.append(bytearray(1 << 24))


def swell_in_c(_):
    """Let operator new throw std::bad_alloc where nothing catches it."""
    library = ctypes.CDLL("libstdc++.so.6")
    library._Znwm.argtypes, library._Znwm.restype = [ctypes.c_size_t], ctypes.c_void_p
    library._Znwm(1 << 45)


def write(value):
    print("noise " * 40000)  # noqa: T201  what is on trial
    sys.stderr.write("noise")
    for descriptor in (1, 2):
        os.write(descriptor, b"noise" * 40000)
    ctypes.CDLL(None).puts(b"noise")
    return value


def crash(_):
    ctypes.string_at(0)


def fail(_):
    raise ValueError("first line\nsecond line")


def unsendable(_):
    return lambda: None


class Unreadable:
    """Can be sent, and not be read."""

    def __reduce__(self):
        return (fail, (None,))


def unreadable(_):
    return Unreadable()


def garble(_):
    """Write bytes that nobody can read into every open pipe."""
    for descriptor in range(3, 64):
        with suppress(OSError):
            os.write(descriptor, b"\0\0\0\x10garbagegarbagegarbage")


def interrupt_itself(value):
    os.kill(os.getpid(), signal.SIGINT)
    return value


def clocked(_):
    """When it began and when it ended, s."""
    begun = time.monotonic()
    time.sleep(0.1)
    return begun, time.monotonic()


def spoil(value):
    """End well, and bring the process down in the middle of the next job."""
    threading.Timer(0.1, os.abort).start()
    return value


def sign(path):
    """Leave its process number in a file."""
    Path(path).write_text(str(os.getpid()))


def sign_and_sleep(path):
    """Leave its process number in a file, and hang."""
    sign(path)
    time.sleep(LONG)


def sign_and_wait(folder):
    """Leave a file with its process number as name, and return the number once there is another file, "go"."""
    (Path(folder) / str(os.getpid())).touch()
    assert wait_for((Path(folder) / "go").exists)
    return os.getpid()


def fork_and_sleep(path):
    """Leave a child, its process number in a file, and hang."""
    child = subprocess.Popen([sys.executable, "-c", f"import time; time.sleep({LONG})"])
    Path(path).write_text(str(child.pid))
    time.sleep(LONG)


def announce(folder, package, entries):
    """Have a distribution in this folder announce engines, name and "module:class"."""
    place = folder / f"{package.replace('-', '_')}-1.0.dist-info"
    place.mkdir()
    (place / "METADATA").write_text(f"Metadata-Version: 2.1\nName: {package}\nVersion: 1.0\n")
    lines = [f"{name} = {value}" for name, value in entries.items()]
    (place / "entry_points.txt").write_text("\n".join(["[linkproof.engines]", *lines, ""]))
