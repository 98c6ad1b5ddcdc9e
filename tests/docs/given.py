"""Files that the pages of the documentation take as given, each as the page describes it."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np

from analytic.description.crank_motion import crank_motion
from analytic.description.loading import load, read
from tests.analytic.linkages import double_rocker_text
from tests.comparisons.filejudge.layouts import Channel, exported, solidworks, with_link

CATALOGUE = Path(__file__).parents[2] / "analytic" / "catalogue"
TITLES = (("Motor Torque12", "newton-millimeter", 1e3, "Mkr"), ("Angular Displacement1", "deg", 180.0 / np.pi, "phi"),
          ("Reaction Force3", "newton", 1.0, "joint_force:A:magnitude"))  # fmt: skip


def needle() -> str:
    """The needle mechanism's run-up as SolidWorks Motion exports it: a heavier coupler, the torque of the reaction."""
    linkage, time = load("juki-mf7923d"), np.arange(701) / 1000.0
    heavier = with_link(linkage, "coupler", mass=0.04)
    motion = crank_motion("run-up-quintic")
    results = exported(heavier, motion, [name for *_, name in TITLES], time, digits=17)
    values = {signal.name: signal.values for signal in results.signals} | {"Mkr": -results.signals[0].values}
    plots = [(title, [Channel("Time", "sec", time), Channel(title, unit, factor * values[name])])
             for title, unit, factor, name in TITLES]  # fmt: skip
    return solidworks(plots, digits=6)


def short() -> str:
    """The needle mechanism with a coupler that cannot reach its guide."""
    return (CATALOGUE / "juki-mf7923d.toml").read_text(encoding="utf-8").replace("54.5", "12")


def brief() -> str:
    """The take-up with released motions of half a second, for the short run of commands."""
    return re.sub("(?m)^duration .*", "duration = 0.5", read("slotted-takeup").text)


GIVEN = {
    "needle.csv": needle,
    "short.toml": short,
    "brief.toml": brief,
    "path/to/mine.toml": lambda: (CATALOGUE / "juki-mf7923d.toml").read_text(encoding="utf-8"),
    "rocker.toml": lambda: double_rocker_text((0, 1)),
    "curve.csv": lambda: "phi_deg,feed_mm\n0,10\n90,20\n",
}


def lay_out(folder: Path) -> None:
    """Write the given files to a folder."""
    for name, text in GIVEN.items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_text(text(), encoding="utf-8")
