"""Plug-ins that violate the contract, each with the outcome of its row."""

from __future__ import annotations

from dataclasses import replace

from engines.direct_adapter.adapter import DirectEngine

print("noise of an import")  # noqa: T201  the subject of a test


class _Hostile(DirectEngine):
    is_control = False
    act = staticmethod(lambda run: run)

    def version(self):
        return "1.0"

    def run(self, scene, setting):
        return self.act(super().run(scene, setting))


def _interrupt(_):
    raise KeyboardInterrupt


def _hold_a_function(run):
    return replace(run, details={"f": lambda: 0})


def _fail(_):
    raise RuntimeError("no version")


PARTS = {
    "faithful": {"expected_failures": {"silence": "its licence"}},
    "interrupting": {"act": staticmethod(_interrupt)},
    "unsendable": {"act": staticmethod(_hold_a_function)},
    "number": {"version": lambda _: 3.14},
    "unversioned": {"version": _fail},
    "renamed": {"name": "../../x<b>"},
}
ENGINES = {name: type(name, (_Hostile,), {"name": name, **parts}) for name, parts in PARTS.items()}
globals().update(ENGINES)  # where entry points look for them
