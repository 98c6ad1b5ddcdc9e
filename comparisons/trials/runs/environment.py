"""The environment of a campaign: versions, machine, commit, date."""

from __future__ import annotations

import datetime
import os
import platform
import subprocess
from collections.abc import Sequence
from functools import cache
from pathlib import Path

from comparisons.trials.runs.plugins import engines as adapters
from engines.registry import engine_names, installed_version

PACKAGES = ("linkproof", "numpy", "scipy")
# What an environment holds that no result depends on.
INCIDENTAL = ("date", "machine")


def environment(engines: Sequence[str] = ()) -> dict[str, str]:
    """Facts that decide a figure or a time, by name, JSON-ready: date, machine, commit and versions.

    Versions are those of Python, linkproof, NumPy and SciPy, and of these engines, by name; unknown or absent ones are
    left out.
    """
    facts, here = {name: installed_version(name) for name in PACKAGES}, engine_names()
    facts |= {engine.name: engine.version() for engine in adapters([name for name in engines if name in here])}
    return {
        "date": datetime.datetime.now(datetime.UTC).strftime("%Y-%m-%d %H:%M UTC"),
        "python": platform.python_version(),
        **{name: version for name, version in facts.items() if version},
        "machine": f"{platform.system()} {platform.machine()}, {_processor()}, {os.cpu_count()} cores",
        "commit": _commit(),
    }


def _processor() -> str:
    """The processor's name as the system tells it, by Linux or by Python; "unknown processor" where neither does."""
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
    except OSError:
        return platform.processor() or "unknown processor"
    names = [line.split(":", 1)[1].strip() for line in lines if line.startswith("model name")]
    return names[0] if names else platform.processor() or "unknown processor"


@cache
def _commit() -> str:
    """The commit of the checkout that the program runs from; "not from a checkout" for any other installation.

    It is as from ``git describe --always --dirty``, asked for once.
    """
    folder = Path(__file__).parent
    command = ["git", "-C", str(folder), "describe", "--always", "--dirty"]
    try:
        done = subprocess.run(command, capture_output=True, encoding="utf-8", errors="replace", timeout=5, check=False)
    except (OSError, subprocess.SubprocessError):
        return "not from a checkout"
    return done.stdout.strip() or "not from a checkout"
