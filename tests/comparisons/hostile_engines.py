"""Plug-ins that violate the contract or damage their process, each with the outcome of its row."""

from __future__ import annotations

import builtins
import os
from dataclasses import replace

from engines.contract import Outcome, Run
from engines.direct_adapter.adapter import DirectEngine

print("noise of an import")  # noqa: T201  the subject of a test


class _Hostile(DirectEngine):
    is_control = False
    act = staticmethod(lambda run: run)

    def version(self):
        return "1.0"

    def run(self, scene, setting):
        return self.act(super().run(scene, setting))


def _write_everywhere(run):
    for descriptor in range(3, 60):
        try:
            os.write(descriptor, b"\x00\x00\x00\x10garbagegarbagegarb")
        except OSError:
            continue
    return run


def _begin_a_message(run):
    """Write less than a message into every pipe."""
    for descriptor in range(3, 60):
        try:
            os.write(descriptor, b"\x00")
        except OSError:
            continue
    return run


def _miscount(_):
    builtins.len = lambda _: 3
    return Run(Outcome.DIVERGED, reason="changed the world")


def _interrupt(_):
    raise KeyboardInterrupt


def _hold_a_function(run):
    return replace(run, details={"f": lambda: 0})


ACTS = {
    "faithful": (lambda run: run, "passed", ""),
    "interrupting": (_interrupt, "adapter-error", "raised KeyboardInterrupt"),
    "unsendable": (_hold_a_function, "adapter-error", "texts and finite numbers, got a function"),
    "writing": (_write_everywhere, "crashed", "wrote into the pipe"),
    "beginning": (_begin_a_message, "crashed", "wrote into the pipe"),
    "miscounting": (_miscount, "crashed", "wrote into the pipe"),
}
PARTS = {
    **{name: {"name": name, "act": staticmethod(act)} for name, (act, *_) in ACTS.items()},
    "number": {"name": "number", "version": lambda _: 3.14},
    "renamed": {"name": "../../x<b>"},
}
ROWS = {
    **{name: row for name, (_, *row) in ACTS.items()},
    "number": ["adapter-error", "expected a version as text or None, got a float"],
    "nowhere": ["adapter-error", "the adapter of nowhere raised AttributeError"],
    "renamed": ["adapter-error", "expected an adapter with the name it is announced by"],
}
ENGINES = {name: type(name, (_Hostile,), parts) for name, parts in PARTS.items()}
globals().update(ENGINES)  # where entry points look for them
ENTRIES = {**{name: f"{__name__}:{name}" for name in ENGINES}, "nowhere": "no module:?"}
