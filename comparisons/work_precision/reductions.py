"""Scenes with something left out, and queries to the closed form: what costs are measured on."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Final

from analytic.description.changes import LOADS, with_bare_slots, without
from analytic.description.linkage import Linkage
from comparisons.judging.quantities import QUANTITIES
from engines.scene import Channel
from engines.scene_builder import is_pin_mass

EVERYTHING: Final = frozenset(Channel)
SPEED, ACCELERATION = 100.0, 50.0  # rad/s and rad/s² in the closed form; any others cost the same

OUTPUT: Final = frozenset({"S", "v", "a"})  # quantities of the output, which not every linkage names

Rest = Callable[[Linkage], Linkage]


@dataclass(frozen=True)
class StepReduction:
    """A scene with less in it: the channels asked of the engine, and what is left of the linkage."""

    name: str
    about: str
    channels: frozenset[Channel] = EVERYTHING
    rest: Rest | None = None


@dataclass(frozen=True)
class Query:
    """Quantities for ``evaluate``, at a crank speed, rad/s, and acceleration, rad/s²."""

    name: str
    quantities: tuple[str, ...]
    rest: Rest | None = None
    speed: float = SPEED
    acceleration: float = ACCELERATION

    def names(self, linkage: Linkage) -> tuple[str, ...]:
        """Those of the quantities that a linkage has."""
        return tuple(name for name in self.quantities if linkage.output is not None or name not in OUTPUT)


def reduced(linkage: Linkage, part: StepReduction | Query) -> Linkage | None:
    """What a reduction or a query leaves of a linkage; None where it takes something out that the linkage has not."""
    if part.rest is None:
        return linkage
    rest = part.rest(linkage)
    return None if rest == linkage else rest


def without_gravity(linkage: Linkage) -> Linkage:
    """The linkage where nothing weighs anything."""
    return without(linkage, "gravity")


def without_loads(linkage: Linkage) -> Linkage:
    """The linkage without forces, torques, springs and dampers; its weight stays."""
    return without(linkage, *LOADS)


def without_slot_masses(linkage: Linkage) -> Linkage:
    """The linkage with bare pins in its slots, where a slider is nothing but a mass and an inertia there."""
    loaded = {force.link for force in linkage.forces} | {end for spring in linkage.springs for end in spring.links}
    bare = {s.link for s in linkage.sliders if is_pin_mass(linkage, s) and s.link not in loaded}
    return with_bare_slots(linkage, bare) if bare else linkage


REDUCTIONS: Final = (
    StepReduction("everything", "all channels, weights and loads"),
    StepReduction("no joint forces", "motion and drive torque", EVERYTHING - {Channel.JOINT_FORCE}),
    StepReduction(
        "motion alone",
        "positions, velocities and accelerations",
        frozenset({Channel.POSITION, Channel.VELOCITY, Channel.ACCELERATION}),
    ),
    StepReduction("Jeq alone", "velocities, from which Jeq is read", QUANTITIES["Jeq"].channels),
    StepReduction("nothing recorded", "no channel", frozenset()),
    StepReduction("no gravity", "all channels, no weights", rest=without_gravity),
    StepReduction("no loads", "all channels, no forces, torques, springs or dampers", rest=without_loads),
    StepReduction("slots without mass", "all channels, bare pins in the slots", rest=without_slot_masses),
)
"""The scenes that are compared; the first is the whole one."""

QUERIES: Final = (
    Query("everything", ("S", "v", "a", "Jeq", "Teq", "Q", "Mkr", "Peq")),
    Query("Mkr", ("Mkr",)),
    Query("Mkr, no gravity", ("Mkr",), without_gravity),
    Query("Mkr, no loads", ("Mkr",), without_loads),
    Query("Mkr, crank at rest", ("Mkr",), speed=0.0, acceleration=0.0),
    Query("Q", ("Q",)),
    Query("Jeq", ("Jeq",)),
    Query("a", ("a",)),
    Query("v", ("v",)),
    Query("S", ("S",)),
)
"""The requests to the closed form; the first contains all others."""
