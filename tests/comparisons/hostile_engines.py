"""Plug-ins that do what no plug-in should, each with how its own row has to end."""

from __future__ import annotations

import builtins
import os
from dataclasses import replace

import numpy as np

from engines.contract import Outcome, Run, Signal
from engines.direct_adapter.adapter import DirectEngine

print("noise of an import")  # noqa: T201  what is on trial


class _Hostile(DirectEngine):
    is_control = False
    act = staticmethod(lambda run: run)

    def version(self):
        return "1.0"

    def run(self, scene, setting):
        return self.act(super().run(scene, setting))


def _with(**parts):
    return lambda run: replace(run, **parts)


def _bent(change):
    def act(run):
        history = run.history
        bent = {name: Signal(*change(one.time, one.values)) for name in ("position", "torque")
                for one in [getattr(history, name)] if one is not None}  # fmt: skip
        return replace(run, history=replace(history, **bent))

    return act


def _write_everywhere(run):
    for descriptor in range(3, 60):
        try:
            os.write(descriptor, b"\x00\x00\x00\x10garbagegarbagegarb")
        except OSError:
            continue
    return run


def _begin_a_message(run):
    """Leave too little in every pipe for anybody to see what is wrong with it."""
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


ACTS = {
    "faithful": (lambda run: run, "passed", ""),
    "interrupting": (_interrupt, "adapter-error", "raised KeyboardInterrupt"),
    "nothing": (lambda _: None, "adapter-error", "expected a Run, got a NoneType"),
    "negative": (_with(seconds=-5.0, steps=-3), "adapter-error", "not negative, got -5.0"),
    "endless": (_with(seconds=float("inf")), "adapter-error", "finite and not negative, got inf"),
    "unsendable": (_with(details={"f": lambda: 0}), "adapter-error", "texts and finite numbers, got a function"),
    "outcome": (lambda _: Run("weird", reason=3), "adapter-error", "expected an Outcome, got a str"),
    "shape": (_bent(lambda t, v: (t, np.zeros((len(t), 7, 2)))), "adapter-error", "got (1401, 7, 2) in position"),
    "timeless": (_bent(lambda t, v: (np.where(t > 0.1, np.nan, t), v)), "adapter-error", "finite and never decrease"),
    "huge": (_bent(lambda t, v: (t, v * 1e300)), "diverged", "position is beyond 1e+100 from 0 s on"),
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
