"""Scenes with less in them, and what less can be asked of the closed form: what an economy is measured on."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Final

from analytic.description.linkage import Linkage, Slot
from comparisons.judging.quantities import QUANTITIES
from engines.scene import Channel
from engines.scene_builder import is_pin_mass

EVERYTHING: Final = frozenset(Channel)
SPEED, ACCELERATION = 100.0, 50.0  # rad/s and rad/s² in the closed form; any others cost the same

Rest = Callable[[Linkage], Linkage]


@dataclass(frozen=True)
class Reduction:
    """A scene with less in it: the channels asked of the engine, and what is left of the linkage."""

    name: str
    about: str
    channels: frozenset[Channel] = EVERYTHING
    rest: Rest | None = None


@dataclass(frozen=True)
class Ask:
    """What is asked of the closed form: names of ``evaluation.QUANTITIES``, and the crank's speed and acceleration."""

    name: str
    quantities: tuple[str, ...]
    rest: Rest | None = None
    speed: float = SPEED
    acceleration: float = ACCELERATION


def rest_of(linkage: Linkage, part: Reduction | Ask) -> Linkage | None:
    """What a reduction leaves of a linkage; None where it takes something out that the linkage has not."""
    if part.rest is None:
        return linkage
    rest = part.rest(linkage)
    return None if rest == linkage else rest


def without_gravity(linkage: Linkage) -> Linkage:
    """The linkage where nothing weighs anything."""
    return replace(linkage, gravity=(0.0, 0.0))


def without_loads(linkage: Linkage) -> Linkage:
    """The linkage without forces, torques, springs and dampers; its weight stays."""
    return replace(linkage, forces=(), torques=(), springs=(), dampers=())


def without_slot_masses(linkage: Linkage) -> Linkage:
    """The linkage with bare pins in its slots, where a slider is nothing but a mass and an inertia there."""
    loaded = {force.link for force in linkage.forces} | {end for spring in linkage.springs for end in spring.links}
    bare = {s.link: s for s in linkage.sliders if is_pin_mass(linkage, s) and s.link not in loaded}
    if not bare:
        return linkage
    pins = [replace(pin, links=tuple(name for name in pin.links if name not in bare)) for pin in linkage.pins]
    return replace(
        linkage,
        links={name: link for name, link in linkage.links.items() if name not in bare},
        pins=tuple(pin for pin in pins if len(pin.links) > 1),
        sliders=tuple(slider for slider in linkage.sliders if slider.link not in bare),
        slots=(*linkage.slots, *(Slot(slider.point, slider.guide) for slider in bare.values())),
    )


REDUCTIONS: Final = (
    Reduction("everything", "all channels, weights and loads"),
    Reduction("no joint forces", "motion and drive torque", EVERYTHING - {Channel.JOINT_FORCE}),
    Reduction(
        "motion alone",
        "positions, velocities and accelerations",
        frozenset({Channel.POSITION, Channel.VELOCITY, Channel.ACCELERATION}),
    ),
    Reduction("Jeq alone", "velocities, from which Jeq is read", QUANTITIES["Jeq"].channels),
    Reduction("nothing recorded", "no channel", frozenset()),
    Reduction("no gravity", "all channels, no weights", rest=without_gravity),
    Reduction("no loads", "all channels, no forces, torques, springs or dampers", rest=without_loads),
    Reduction("slots without mass", "all channels, bare pins in the slots", rest=without_slot_masses),
)
"""The scenes that are held against each other; the first is the whole one."""

ASKS: Final = (
    Ask("everything", ("S", "v", "a", "Jeq", "Teq", "Q", "Mkr", "Peq")),
    Ask("Mkr", ("Mkr",)),
    Ask("Mkr, no gravity", ("Mkr",), without_gravity),
    Ask("Mkr, no loads", ("Mkr",), without_loads),
    Ask("Mkr, crank at rest", ("Mkr",), speed=0.0, acceleration=0.0),
    Ask("Q", ("Q",)),
    Ask("Jeq", ("Jeq",)),
    Ask("a", ("a",)),
    Ask("v", ("v",)),
    Ask("S", ("S",)),
)
"""What the closed form is asked for; the first is all of it."""

OUTPUT: Final = frozenset({"S", "v", "a"})  # quantities of the output, which not every linkage names
