"""From the conditions of one cell of a stress map to a case and the scene an engine is given."""

from __future__ import annotations

import math
from dataclasses import dataclass, fields, replace
from pathlib import Path

import numpy as np

from analytic.description import changes
from analytic.description.crank_motion import RPM, CrankMotion, Segment, crank_motion
from analytic.description.linkage import Linkage, ReleasedRegime, Vector
from analytic.description.loading import catalogue, load
from analytic.dynamics.reduced import damping_coefficient, reduced_inertia
from analytic.errors import LinkproofError
from analytic.kinematics.mechanism import Mechanism
from comparisons.reference.case import Case, case_of_file_regime
from engines.mechanics.joints import scene_size
from engines.scene import Body, Channel, Scene

LINKAGES = Path(__file__).with_name("linkages")
RELEASED, REVERSAL = "released", "reversal"
# Of the time constant Jeq/b that a released motion lasts: each takes the closed form a window of its own.
MOST_RELAXATIONS = 1e4
GOLDEN_ANGLE = math.pi * (3.0 - math.sqrt(5.0))  # directions that no two bodies share


@dataclass(frozen=True)
class Conditions:
    """The conditions of a cell: scene and steps; the defaults are a smooth run-up of the unchanged linkage.

    ``linkage`` is a catalogue name, or a file's among the stress maps' own. ``speed`` is in rpm, ``start_angle`` in
    degrees; ``motion`` is a regime's name, ``reversal`` or ``released``. ``turns`` is the duration of a constant speed
    or of a released crank, in turns at ``speed``; ``spinning`` says whether it is released at that speed or at rest,
    ``torque`` (N m) is then on it. ``point`` of ``link`` (or of the ground) is put at ``at + excess * slope``, m.
    ``scaled`` names what is multiplied by ``scale``, ``load`` the kind of loads that remain (springs or dampers), times
    ``load_factor``. ``disturbed`` says whether positions or velocities of the start are off by ``disturbance``.
    """

    linkage: str
    speed: float = 1000.0
    motion: str = "run-up-quintic"
    start_angle: float = 0.0
    ramp_turns: float = 2.0
    hold_turns: float = 1.0
    reversal_turns: float = 1.0
    turns: float = 1.0
    spinning: bool = True
    torque: float = 0.0
    link: str = ""
    mass_factor: float = 1.0
    point: str = ""
    at: Vector = (0.0, 0.0)
    slope: Vector = (0.0, 0.0)
    excess: float = 0.0
    scaled: str = ""
    scale: float = 1.0
    load: str = ""
    load_factor: float = 1.0
    damper_factor: float = 1.0
    disturbed: str = ""
    disturbance: float = 0.0
    steps_per_turn: float = 0.0
    effort: float = 0.0

    @property
    def differing(self) -> dict[str, str | float | bool | list[float]]:
        """The conditions that differ from the defaults, by name."""
        differing = {}
        for field in fields(self):
            value = getattr(self, field.name)
            if field.name == "linkage" or value != field.default:
                differing[field.name] = list(value) if isinstance(value, tuple) else value
        return differing

    @property
    def time_factor(self) -> float:
        """The factor of every time."""
        return self.scale if self.scaled == "time" else 1.0

    @property
    def rate(self) -> float:
        """The speed, rad/s."""
        return self.speed * RPM / self.time_factor

    @property
    def step(self) -> float:
        """The step of a method, s."""
        return 2.0 * math.pi / self.rate / self.steps_per_turn


def linkage(conditions: Conditions) -> Linkage:
    """The linkage of a cell, under its original name."""
    name = conditions.linkage
    changed = load(name if name in catalogue() else str(LINKAGES / f"{name}.toml"))
    if conditions.mass_factor != 1.0:
        changed = changes.multiplied(changed, conditions.mass_factor, "mass", "inertia", under=f"{conditions.link}.")
    if conditions.point:
        x, y = (at + conditions.excess * slope for at, slope in zip(conditions.at, conditions.slope, strict=True))
        changed = changes.with_point(changed, conditions.link, conditions.point, (x, y))
    if conditions.damper_factor:
        changed = changes.multiplied(changed, conditions.damper_factor, "turn_damping")
    else:
        changed = changes.without(changed, "dampers")
    if conditions.load:
        changed = changes.without(changed, *({"springs", "dampers"} - {conditions.load}))
        changed = changes.multiplied(changed, conditions.load_factor, "stiffness", "damping", "turn_damping")
    factors = {conditions.scaled: conditions.scale} if conditions.scaled else {}
    return changes.scaled(changed, **factors) if factors else changed


def motion(conditions: Conditions) -> CrankMotion:
    """The crank motion of a cell whose crank is driven."""
    turn, start = 2.0 * math.pi / conditions.rate, math.radians(conditions.start_angle)
    if conditions.motion == REVERSAL:
        return reversal(conditions.rate, start, conditions.hold_turns * turn, conditions.reversal_turns * turn)
    constant = conditions.motion == "constant-speed"
    return crank_motion(
        conditions.motion,
        speed=conditions.rate,
        ramp_time=turn * (conditions.turns if constant else 2.0 * conditions.ramp_turns),
        hold_time=0.0 if constant else turn * conditions.hold_turns,
        start_angle=start,
    )


def reversal(speed: float, start_angle: float, hold: float, change: float) -> CrankMotion:
    """Speed to the other direction and back within ``change`` each, constant for ``hold`` before, between and after, s.

    The change follows a quintic, so that the acceleration is continuous.
    """
    segments: list[Segment] = []
    time, angle = 0.0, start_angle
    for sense, span, turning in ((1, hold, False), (1, change, True), (-1, hold, False), (-1, change, True),
                                 (1, hold, False)):  # fmt: skip
        rates = [sense * speed]
        if turning:  # ω (1 − 2 (10 x³ − 15 x⁴ + 6 x⁵)) with x = t / span
            rates += [0.0, 0.0] + [-2.0 * sense * speed * c / span**k for k, c in ((3, 10.0), (4, -15.0), (5, 6.0))]
        coefficients = (angle, *(rate / (k + 1) for k, rate in enumerate(rates)))
        segments.append(Segment(time, time + span, coefficients))
        time, angle = time + span, float(segments[-1].value(time + span))
    return CrankMotion(REVERSAL, tuple(segments))


def case(conditions: Conditions) -> Case:
    """The case of a cell. Raises AssemblyError, or LinkproofError, where there is no motion to hold an engine to."""
    mechanism = Mechanism(linkage(conditions))
    if conditions.motion != RELEASED:
        return Case(mechanism, motion(conditions))
    turn = 2.0 * math.pi / conditions.rate
    released = ReleasedRegime(
        name="driven" if conditions.torque else "free",
        torque=conditions.torque,
        start_angle=math.radians(conditions.start_angle),
        start_speed=conditions.rate if conditions.spinning else 0.0,
        duration=conditions.turns * turn,
    )
    lasts = released.duration * float(np.max(damping_coefficient(mechanism.turn) / reduced_inertia(mechanism.turn)))
    if lasts > MOST_RELAXATIONS:
        raise LinkproofError(
            f"'{mechanism.linkage.name}': expected a released crank for {MOST_RELAXATIONS:.0e} times its time constant "
            f"Jeq/b or less, got {lasts:.0e}; damp less"
        )
    return case_of_file_regime(mechanism, released)


def scene(conditions: Conditions, case: Case) -> Scene:
    """The scene of a cell, with every channel and, on request, a disturbed start."""
    undisturbed = case.scene(frozenset(Channel))
    if not conditions.disturbed:
        return undisturbed
    size = conditions.disturbance * scene_size(undisturbed)
    if conditions.disturbed == "velocity":
        size *= abs(conditions.rate)
    bodies = (_displaced(body, number, conditions.disturbed, size) for number, body in enumerate(undisturbed.bodies))
    return replace(undisturbed, bodies=tuple(bodies))


def _displaced(body: Body, number: int, level: str, size: float) -> Body:
    """A body with its place or its velocity off by ``size``, m or m/s."""
    direction = np.array([math.cos(number * GOLDEN_ANGLE), math.sin(number * GOLDEN_ANGLE)])
    x, y = np.array(getattr(body, level)) + size * direction
    place = (float(x), float(y))
    return replace(body, velocity=place) if level == "velocity" else replace(body, position=place)
