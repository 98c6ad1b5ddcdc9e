"""What every command pays first: starting the process, and reading a file."""

from __future__ import annotations

import subprocess
import sys

from . import lacking


class Process:
    """``linkproof --help`` from the shell."""

    number, repeat, warmup_time = 1, (5, 20, 10.0), 0.0

    def setup(self):
        self.command = [sys.executable, "-m", lacking.module("reports.command_line.main").__name__]

    def time_help(self):
        return len(subprocess.run([*self.command, "--help"], capture_output=True, check=True).stdout)


class File:
    """Reading, validating and interpreting a linkage file, and finding its structure."""

    params = ("juki-mf7923d", "slotted-takeup")
    param_names = ("mechanism",)

    def setup(self, _name):
        self.loading = lacking.module("analytic.description.loading")

    def time_load(self, name):
        self.loading.parse.cache_clear()
        return len(lacking.mechanism(name).structure.bodies)
