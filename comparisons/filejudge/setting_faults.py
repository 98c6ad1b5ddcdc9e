"""One setting of a tool as a fault: gravity, assembly mode, damping; direction, start, clock, speed, run-up."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from analytic.description.crank_motion import RAMPS, RPM, CrankMotion, crank_motion
from analytic.description.linkage import RotaryDamper, rotate
from analytic.description.written import fixed, signed
from comparisons.filejudge.fault import ChangedMotion, Correction, Fault, FaultKind, Simulation, is_rotary
from comparisons.motion.case import Motion

Array = NDArray[np.float64]

EARTH: Final = 9.80665
MOST_MODES: Final = 8  # of a linkage whose other assembly modes are tried
START_ANGLES: Final = 12  # start angles from which a fit of the start angle begins
PHASE_CAPTURE: Final = 0.7  # rad, from which a fit finds the phase
MOST_PACES: Final = 150
QUARTER_TURNS: Final = (90.0, -90.0, 180.0)
ZERO_ANGLE: Final = 1e-6  # rad: the rounding of a start angle
SHORTEST_RAMP: Final = 1e-9  # s, of a ramp
# Units that a column of the crank's angle or speed may have in spite of its header, with their SI values.
CRANK_UNITS: Final = {
    "phi": {"rad": 1.0, "deg": math.pi / 180.0, "turns": 2.0 * math.pi},
    "omega": {"rad/s": 1.0, "deg/s": math.pi / 180.0, "rpm": math.pi / 30.0, "turns per second": 2.0 * math.pi},
}
SAME_UNIT: Final = 1e-6  # relative


def model_settings(simulation: Simulation) -> Iterator[Fault]:
    """Gravity, assembly modes and dampers that are not in the file."""
    yield from _gravity_faults(simulation)
    yield from _mode_faults(simulation)
    yield from _damper_faults(simulation)


def _gravity_faults(simulation: Simulation) -> Iterator[Fault]:
    """Faults of gravity: another size along the file's direction, and any vector."""
    (x, y), size = simulation.linkage.gravity, math.hypot(*simulation.linkage.gravity)
    if not any(link.mass for link in simulation.linkage.links.values()):
        return

    def with_gravity(simulation: Simulation, g: Array) -> Simulation:
        return simulation.with_linkage(replace(simulation.linkage, gravity=(float(g[0]), float(g[1]))))

    def along(simulation: Simulation, k: Array) -> Simulation:
        return with_gravity(simulation, np.array([x, y]) * k[0])

    def words(k: Array) -> str:
        if abs(k[0]) < 1e-9:
            return "gravity is off"
        if math.isclose(k[0], -1.0):
            return "gravity points the other way"
        return f"gravity is {k[0] * size:.4g} m/s² in place of {size:.4g} m/s²"

    if size:
        usual = (0.0, -1.0, *(g / size for g in (EARTH, 9.81, 9.8) if g != size), 2.0, 1e3, 1e-3)
        yield Fault("gravity", FaultKind.SETTING, along, words, (1.0,), (1.0,), usual=tuple((k,) for k in usual))
    quarter_turns = [rotate((x, y), turn) for turn in ((0.0, 1.0), (0.0, -1.0))] if size else []
    axes = ((0.0, -EARTH), (0.0, -9.81), (0.0, EARTH), (0.0, 9.81), (-EARTH, 0.0), (EARTH, 0.0))
    yield Fault(
        "gravity's direction", FaultKind.SEVERAL, with_gravity,
        lambda g: f"gravity is ({fixed(g[0], 3)}, {fixed(g[1], 3)}) m/s² in place of ({x:zg}, {y:zg}) m/s²",
        (x, y), (EARTH, EARTH), usual=tuple(quarter_turns) or axes,
    )  # fmt: skip


def _mode_faults(simulation: Simulation) -> Iterator[Fault]:
    """Faults of one group each that is assembled in its other mode."""
    dyads = simulation.mechanism.structure.dyads
    open_dyads = [number for number, dyad in enumerate(dyads) if dyad.has_two_modes]
    for number in open_dyads[:MOST_MODES]:
        signs = tuple(-dyad.sign if n == number else dyad.sign for n, dyad in enumerate(dyads))
        words = f"{dyads[number].words} are assembled in their other mode"
        yield Fault(
            f"mode:{dyads[number].first}", FaultKind.SETTING,
            lambda simulation, _, signs=signs: simulation.with_modes(signs),  # type: ignore[misc]
            lambda _, words=words: words,  # type: ignore[misc]
            reshapes=True,
        )  # fmt: skip


def _damper_faults(simulation: Simulation) -> Iterator[Fault]:
    """Faults of friction that grows with the speed, in a pin that has none in the file."""
    linkage = simulation.linkage
    inertia = sum((k.inertia or 0.0) + k.mass * linkage.extent() ** 2 for k in linkage.links.values())
    size = (inertia or 1.0) * (simulation.motion.peak_speed or 1.0)
    present = {frozenset(damper.links) for damper in linkage.dampers}
    for pin in linkage.pins:
        for link in pin.joints.values():
            pair = (pin.hub, link)
            if frozenset(pair) not in present:
                present.add(frozenset(pair))
                yield Fault(
                    f"damping:{pin.point}", FaultKind.SEVERAL, _damper_change(pair),
                    lambda b, at=pin.point: f"a rotary damper of {b[0]:.3g} N m s acts in the pin '{at}'",  # type: ignore[misc]
                    (0.0,), (size,),
                )  # fmt: skip


def _damper_change(pair: tuple[str, str]) -> Callable[[Simulation, Array], Simulation]:
    """The change that adds a rotary damper, N m s, between two links."""

    def apply(simulation: Simulation, b: Array) -> Simulation:
        linkage = simulation.linkage
        return simulation.with_linkage(replace(linkage, dampers=(*linkage.dampers, RotaryDamper(pair, float(b[0])))))

    return apply


@dataclass(frozen=True)
class CrankColumn:
    """The column that gives the crank's motion: the angle, phi, or the speed, omega; "" of what does not turn.

    ``unit`` is printed in its ``header``; ``value`` is its SI value.
    """

    name: str
    header: str
    unit: str
    value: float


def motion_settings(motion: Motion, column: CrankColumn | None = None) -> Iterator[Fault]:
    """Every fault of the crank's motion; speed and ramps only where a regime, not a column of the file, gives it."""
    start, from_column = float(motion.angle(0.0)), column is not None
    if column is not None:
        yield from _unit_faults(column, start)
    direction = "the crank angle is mirrored" if from_column else "the crank turns the other way"
    yield _motion_fault("direction", lambda m, _: ChangedMotion(m, -1.0, 2.0 * start), lambda _: direction,
                        cure=_mirror_cure(2.0 * start) if from_column else lambda _: {})  # fmt: skip
    yield Fault(
        "view from behind", FaultKind.SETTING, _mirror_drawing,
        lambda _: "the motor's axis points the other way: angles, turns and torques count clockwise",
        usual=tuple((about,) for about in dict.fromkeys((2.0 * start, 0.0))),
        cure=lambda p: _mirror_cure(float(p[0]), "rotary")(p) if from_column else {},
    )  # fmt: skip
    yield from _zero_angle_faults(start, from_column=from_column)
    yield _clock_fault(motion, from_column=from_column)
    yield _motion_fault(
        "no acceleration", lambda m, _: ChangedMotion(m, order=1),
        lambda _: "the crank's acceleration is left out: torque and forces are those of a constant speed",
    )  # fmt: skip
    if not from_column:
        yield from _regime_faults(motion, start)


def _unit_faults(column: CrankColumn, start: float) -> Iterator[Fault]:
    """Faults of the crank's column: another unit than its header states."""
    for unit, value in CRANK_UNITS.get(column.name, {}).items():
        k = value / column.value
        if not math.isclose(k, 1.0, rel_tol=SAME_UNIT):
            words = f"the column '{column.header}' is in {unit}{f', not in {column.unit}' if column.unit else ''}"
            offset = start * (1.0 - k) if column.name == "omega" else 0.0
            cure = {column.name: Correction(factor=k)}
            yield Fault(
                f"unit:{column.name}", FaultKind.COLUMN,
                lambda simulation, _, k=k, by=offset: simulation.with_motion(ChangedMotion(simulation.motion, k, by)),  # type: ignore[misc]
                lambda _, words=words: words, cure=lambda _, cure=cure: cure,  # type: ignore[misc]
            )  # fmt: skip


def _mirror_cure(offset: float, *others: str) -> Callable[[Array], dict[str, Correction]]:
    """The cure of a crank that counts the other way from an offset, rad, and of ``others`` with the other sign."""
    also = dict.fromkeys(others, Correction(sign=-1))
    zero = 0.0 if abs(wrap_angle(offset)) < ZERO_ANGLE else wrap_angle(offset)
    return lambda _: {"phi": Correction(sign=-1, offset=zero), "omega": Correction(sign=-1), **also}


def wrap_angle(angle: float) -> float:
    """An angle, rad, within −π to π: whole turns taken away."""
    return (float(angle) + math.pi) % (2.0 * math.pi) - math.pi


def _motion_fault(
    name: str,
    change: Callable[[Motion, Array], Motion],
    words: Callable[[Array], str],
    *numbers: Any,  # noqa: ANN401 - fields of Fault
    **rest: Any,  # noqa: ANN401
) -> Fault:
    """A setting as a fault: ``change(motion, numbers)`` is the motion with it."""

    def apply(simulation: Simulation, p: Array) -> Simulation:
        return simulation.with_motion(change(simulation.motion, p))

    return Fault(name, FaultKind.SETTING, apply, words, *numbers, **rest)


def _mirror_drawing(simulation: Simulation, p: Array) -> Simulation:
    """A simulation seen from behind: all that turns has the other sign, the crank angle from p[0], rad."""
    moved = simulation.with_motion(ChangedMotion(simulation.motion, -1.0, float(p[0])))
    return moved.with_change(lambda predict, name, time: (-1.0 if is_rotary(name) else 1.0) * predict(name, time))


def _zero_angle_faults(start: float, *, from_column: bool) -> Iterator[Fault]:
    """Faults of the crank angle's zero, counted the same way or the other."""

    def words(p: Array) -> str:
        degrees = math.degrees(wrap_angle(p[0]))
        if from_column:
            return f"the crank angle counts from another zero: {signed(degrees, '.4g')}° are to be added to the file's"
        return (
            f"the crank starts at {math.degrees(wrap_angle(start + p[0])):.4g}° in place of {math.degrees(start):.4g}°"
        )

    def mirrored(p: Array) -> str:
        if abs(wrap_angle(p[0])) < ZERO_ANGLE:
            return "the crank angle is mirrored"
        return f"the crank angle counts the other way, from {math.degrees(wrap_angle(p[0])):.4g}°"

    common: dict[str, Any] = {
        "guesses": tuple((2.0 * math.pi * n / START_ANGLES,) for n in range(START_ANGLES)),
        "usual": tuple((math.radians(a),) for a in QUARTER_TURNS),
        "unit": math.radians(1.0),
    }
    yield _motion_fault("start angle", lambda m, p: ChangedMotion(m, offset=float(p[0])), words, (0.0,), (1.0,),
                        cure=lambda p: {"phi": Correction(offset=wrap_angle(p[0]))}, **common)  # fmt: skip
    yield _motion_fault("mirrored angle", lambda m, p: ChangedMotion(m, -1.0, float(p[0])), mirrored, (0.0,), (1.0,),
                        cure=lambda p: _mirror_cure(float(p[0]))(p),
                        **{**common, "usual": ((0.0,), *common["usual"])})  # fmt: skip


def _clock_fault(motion: Motion, *, from_column: bool) -> Fault:
    """The fault that the file's clock is ahead or behind, by a time in s."""
    length = min(2.0 * math.pi / motion.peak_speed if motion.peak_speed else motion.duration, motion.duration)
    of = "*" if from_column else "time"  # all that is not the crank's motion, or the clock itself
    return _motion_fault(
        "time shift", lambda m, p: ChangedMotion(m, shift=float(p[0])),
        lambda p: f"the file's clock is {abs(p[0]):.4g} s {'behind' if p[0] > 0.0 else 'ahead'}", (0.0,), (length,),
        guesses=tuple((k * length / 8.0,) for k in (0, 1, -1, 2, -2, 3, -3)),
        cure=lambda p: {of: Correction(time_shift=float(p[0]))}, unit=1.0,
    )  # fmt: skip


def _regime_faults(motion: Motion, start: float) -> Iterator[Fault]:
    """Faults of a stated regime: another speed, another ramp, another time of the ramp."""
    rpm, turned_by = motion.peak_speed / RPM, abs(float(motion.angle(motion.duration)) - start)
    paces = np.linspace(0.5, 1.5, int(min(max(turned_by / PHASE_CAPTURE, 9.0), MOST_PACES)))
    yield _motion_fault(
        "speed", lambda m, p: ChangedMotion(m, float(p[0]), start * (1.0 - float(p[0]))),
        lambda p: f"the crank's speed is {p[0] * rpm:.4g} rpm in place of {rpm:.4g} rpm", (1.0,), (1.0,),
        guesses=((1.0,), *((float(pace),) for pace in paces)), unit=1.0 / rpm if rpm else 0.0,
    )  # fmt: skip
    if not isinstance(motion, CrankMotion) or motion.regime not in (*RAMPS, "constant-speed"):
        return
    speed = float(motion.speed(motion.duration))
    ramp = motion.segments[0].end if motion.regime in RAMPS else 0.6 * motion.duration
    for name in (*RAMPS, "constant-speed"):
        if name != motion.regime:
            yield _motion_fault(
                f"ramp:{name}",
                lambda *_, name=name: _similar_motion(name, speed, ramp, motion),
                lambda _, name=name: f"the crank follows '{name}' in place of '{motion.regime}'",  # type: ignore[misc]
            )
    if motion.regime in RAMPS:
        yield _motion_fault(
            "ramp time", lambda _, p: _similar_motion(motion.regime, speed, float(abs(p[0])), motion),
            lambda p: f"the crank runs up in {p[0]:.4g} s in place of {ramp:.4g} s", (ramp,), (ramp,),
            guesses=((ramp,), *((float(part) * motion.duration,) for part in np.linspace(0.02, 1.0, 50))), unit=1.0,
        )  # fmt: skip


def _similar_motion(name: str, speed: float, ramp: float, like: CrankMotion) -> CrankMotion:
    """The motion of a regime that starts where ``like`` does and lasts as long; ``speed`` in rad/s, ``ramp`` in s."""
    ramp = min(max(ramp, SHORTEST_RAMP), like.duration)
    return crank_motion(
        name, speed=abs(speed), ramp_time=ramp, hold_time=like.duration - ramp, clockwise=speed < 0.0,
        start_angle=float(like.angle(0.0)),
    )  # fmt: skip
