"""Everything that may be wrong with a simulation or its file: a table of hypotheses, each a row with its words.

A new fault is a new row: the targets that it changes, the numbers with which nothing is wrong, and its sentence.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from enum import IntEnum
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from analytic.description.changes import EMPTY_PARTS, named_numbers
from analytic.description.crank_motion import RAMPS, RPM, CrankMotion, crank_motion
from analytic.description.law import FULL_TURN
from analytic.description.linkage import GROUND, LOADS, Linkage, RotaryDamper, rotate
from analytic.description.units import Kind, factor
from analytic.description.walk import Number
from analytic.description.written import fixed, kind_unit, signed
from comparisons.filejudge.simulation import (
    CRANK,
    INCOMPLETE,
    LINKAGE,
    MODES,
    MOTION,
    SignalTimes,
    Simulation,
    Values,
    is_rotary,
)

Array = NDArray[np.float64]
Numbers = tuple[float, ...]

RADIAN: Final = 180.0 / math.pi
# Units that are taken for one another, by the SI unit of what is measured, with their SI values.
UNITS: Final[Mapping[str, Mapping[str, float]]] = {
    "kg": {"kilograms": 1.0, "grams": 1e-3, "pounds": 0.45359237},
    "kg m²": {"kg·m²": 1.0, "g·m²": 1e-3, "kg·mm²": 1e-6, "g·mm²": 1e-9, "kg·cm²": 1e-4},
    "m": {"metres": 1.0, "millimetres": 1e-3, "centimetres": 1e-2, "inches": 0.0254},
    "m/s": {"m/s": 1.0, "mm/s": 1e-3, "in/s": 0.0254},
    "m/s²": {"m/s²": 1.0, "mm/s²": 1e-3, "g": 9.80665, "in/s²": 0.0254},
    "rad": {"rad": 1.0, "deg": 1.0 / RADIAN, "turns": FULL_TURN},
    "rad/s": {"rad/s": 1.0, "deg/s": 1.0 / RADIAN, "rpm": RPM, "turns per second": FULL_TURN},
    "rad/s²": {"rad/s²": 1.0, "deg/s²": 1.0 / RADIAN},
    "N": {"newtons": 1.0, "kilonewtons": 1e3, "millinewtons": 1e-3, "kgf": 9.80665, "lbf": 4.4482216152605},
    "N m": {
        "N·m": 1.0, "N·mm": 1e-3, "kN·m": 1e3, "N·cm": 1e-2, "kgf·m": 9.80665, "lbf·in": 0.1129848290276167,
        "lbf·ft": 1.3558179483314,
    },
    "W": {"watts": 1.0, "kilowatts": 1e3, "milliwatts": 1e-3, "hp": 745.69987158227},
}  # fmt: skip
OF_NO_UNIT: Final = {"its unit": 1.0, "a thousandth of it": 1e-3}
SAME_UNIT: Final = 1e-6  # relative
MOST_RATIO_ERROR: Final = 0.2  # of a unit's ratio, by which the file's may differ where it has other faults
FEW_SAMPLES: Final = 0.03  # of the samples: single ones
ALIKE: Final = 0.05  # of the peak, within which a column is another quantity
NEGLIGIBLE: Final = 1e-5  # of a signal's scale: what every solver's numerics may do, and no fault of a model
MOST_TIMES: Final = 4  # of single samples that are named
EARTH: Final = 9.80665
MOST_MODES: Final = 8  # of a linkage whose other assembly modes are tried
START_ANGLES: Final = 12  # start angles from which a fit of the start angle begins
PHASE_CAPTURE: Final = 0.7  # rad, from which a fit finds the phase
MOST_PACES: Final = 150
QUARTER_TURNS: Final = (0.5 * math.pi, -0.5 * math.pi, math.pi)
ZERO_ANGLE: Final = 1e-6  # rad: the rounding of a start angle
SHORTEST_RAMP: Final = 1e-9  # s, of a ramp
MOST_LOAD_NUMBERS: Final = 8  # of one load: of a longer table no number is a fault of its own
MOST_POINTS: Final = 60  # of a linkage whose distances are tried one by one
# What is written in place of a number, as its multiples.
USUAL_FACTORS: Final[Mapping[Kind, Numbers]] = {
    Kind.MASS: (0.0, 1e3, 1e-3),
    Kind.INERTIA: (0.0, 1e3, 1e-3, 1e6, 1e-6),
    Kind.LENGTH: (-1.0,),
    Kind.ACCELERATION: (0.0, -1.0),
}
LOAD_FACTORS: Final = (0.0, -1.0, 1e3, 1e-3)  # multiples of a load that are written in its place
ANY: Final = (-math.inf, math.inf)
POSITIVE: Final = (0.0, math.inf)
PACE, OFFSET, SHIFT, ORDER = ((CRANK, knob) for knob in ("pace", "offset", "shift", "order"))


class FaultKind(IntEnum):
    """Where a fault lies, in the order in which an engineer looks: of causes that fit alike the first is named."""

    COLUMN = 0  # sign, unit or meaning of a column of the file
    SETTING = 1  # one setting of the tool: gravity, direction, start, units, what is left out
    NUMBER = 2  # one number of the description
    SEVERAL = 3  # several numbers at once
    FREE = 4  # a factor of a column that no unit explains


@dataclass(frozen=True)
class Hypothesis:
    """One thing that may be wrong: ``targets(*numbers)`` have other values, ``words(*numbers)`` is its sentence.

    ``start`` (k,) are the numbers with which nothing is wrong, ``sizes`` what counts as a change of each; fits begin at
    the ``guesses`` and stay within the ``bounds``, and ``usual`` numbers are tried as they are. ``unit`` is that in
    which a single number is written, as SI value: round ones are likelier. One that ``reshapes`` the linkage makes it
    move otherwise. All curves are a linear function of one that ``is_linear``: if it takes nothing away where it is
    small, no larger number does.
    """

    name: str
    kind: FaultKind
    targets: Callable[..., Values]
    words: Callable[..., str]
    start: Numbers = ()
    sizes: Numbers = ()
    guesses: tuple[Numbers, ...] = ()
    usual: tuple[Numbers, ...] = ()
    unit: float = 0.0
    bounds: tuple[float, float] = ANY
    reshapes: bool = False
    is_linear: bool = False


def _certain(name: str, kind: FaultKind, values: Values, words: str, *, reshapes: bool = False) -> Hypothesis:
    """A hypothesis without numbers."""
    return Hypothesis(name, kind, lambda: values, lambda: words, reshapes=reshapes)


def unit_slips(si: str, header: float | None = None) -> Iterator[tuple[float, str]]:
    """Factors by which values are too large where one unit is read as another, with words: "grams read as kilograms".

    ``si`` is the SI unit of what is measured; with a ``header``, an SI value, only that unit is read.
    """
    units = UNITS.get(si, OF_NO_UNIT)
    read = dict(units)
    if header is not None:
        read = {unit: k for unit, k in units.items() if math.isclose(k, header)} or {"the header's unit": header}
    for (unit, value), (taken, k) in itertools.product(units.items(), read.items()):
        if not math.isclose(k, value, rel_tol=SAME_UNIT):
            yield k / value, f"{unit} read as {taken}"


def _slip_words(si: str, k: float) -> str:
    """The words of the units whose ratio a factor is, in brackets; "" for none."""
    slips = (words for ratio, words in unit_slips(si) if math.isclose(ratio, k, rel_tol=SAME_UNIT))
    return next((f" (factor {k:.6g}: {words})" for words in slips), "")


# The columns of a file: sign, unit, zero, clock, single samples, another quantity.


@dataclass(frozen=True)
class Evidence(SignalTimes):
    """A column of a file beside the closed form: ``values`` and ``truth`` (n,) at its times.

    The file leaves ``rounding`` (n,) open. A cause need not explain samples that are not ``counted``; ``over`` are
    those that are off even so. ``scale`` is the size over which errors are stated; words are in ``unit``, a signal of
    the kind is in the unit ``si``, and the column's header states a unit of the SI value ``header``.
    """

    values: Array
    truth: Array
    rounding: Array
    counted: NDArray[np.bool_]
    over: NDArray[np.bool_]
    scale: float
    unit: str
    unit_value: float = 1.0
    si: str = ""
    header: float = 1.0

    def thinned(self, most: int) -> Evidence:
        """The evidence at ``most`` samples or fewer, equally spread."""
        every = -(-len(self.time) // most)
        parts: dict[str, Any] = {k: v[::every] for k, v in vars(self).items() if isinstance(v, np.ndarray)}
        return replace(self, **parts)

    @property
    def tolerance(self) -> Array:
        """The difference that a cause need not explain, (n,)."""
        return np.asarray(self.rounding + NEGLIGIBLE * self.scale)

    @property
    def residual(self) -> Array:
        """Value less truth over the tolerance, (n,), nan where nothing is compared."""
        return np.where(self.counted, (self.values - self.truth) / self.tolerance, np.nan)


def of_column(evidence: Evidence, simulation: Simulation, names: Sequence[str]) -> Iterator[Hypothesis]:
    """Every fault that lies in one column; ``names`` are the signals that it may be taken for."""
    name, size, step = evidence.name, (evidence.scale,), float(np.median(np.diff(evidence.time)))
    scale, offset, shift, free = (name, "scale"), (name, "offset"), (name, "shift"), FaultKind.SEVERAL
    yield _certain(f"sign:{name}", FaultKind.COLUMN, {scale: -1.0}, f"{name} has the other sign")
    truth = evidence.truth[evidence.counted]
    share = float(evidence.values[evidence.counted] @ truth) / (float(truth @ truth) or math.inf)
    for (k, slip), sign in itertools.product(unit_slips(evidence.si, evidence.header), (1.0, -1.0)):
        if abs(share / (sign * k) - 1.0) < MOST_RATIO_ERROR or evidence.si == "rad":  # known but for whole turns
            sense = "" if sign > 0.0 else " and has the other sign"
            words = f"{name} is {k:.6g} times the closed form's{sense}: {slip}"
            yield _certain(f"unit:{name}", FaultKind.COLUMN, {scale: sign * k}, words)
    yield Hypothesis(f"factor:{name}", FaultKind.FREE, lambda k: {scale: k},
                     lambda k: f"{name} is {k:.5g} times the closed form's", (1.0,), (1.0,))  # fmt: skip

    def by(c: float) -> str:
        return f"{signed(c / evidence.unit_value, '.4g')} {evidence.unit}"

    zero = FaultKind.COLUMN if evidence.si in ("rad", "m") else free  # angles and lengths have a zero of choice
    yield Hypothesis(f"offset:{name}", zero, lambda c: {offset: c},
                     lambda c: f"{name} counts from another zero, {by(c)} from the linkage file's",
                     (0.0,), size)  # fmt: skip
    yield Hypothesis(f"counted back:{name}", zero, lambda c: {scale: -1.0, offset: c},
                     lambda c: f"{name} counts the other way, from {by(c)}, as from the other dead centre",
                     (0.0,), size, (size,))  # fmt: skip

    def late(t: float) -> str:
        halves = 2.0 * t / step
        whole = f", {abs(t / step):.2g} samples," if round(halves) and abs(halves - round(halves)) < 0.1 else ""
        return f"{name} is {abs(t):.4g} s{whole} too {'early' if t > 0.0 else 'late'}"

    yield Hypothesis(f"delay:{name}", free, lambda t: {shift: t}, late, (0.0,), (step,),
                     usual=tuple((k * step,) for k in (0.5, -0.5, 1.0, -1.0, 2.0, -2.0)))  # fmt: skip
    for incomplete in INCOMPLETE if name == "Mkr" else ():
        part = incomplete.removeprefix("Mkr without ")
        words = f"Mkr lacks {part}, a velocity-quadratic part that grows as ω²"
        yield _certain(f"no {part}:{name}", FaultKind.SETTING, {(name, "of"): incomplete}, words)
    yield from _single_samples(evidence)
    yield from _mistaken_quantities(evidence, simulation, names)


def _single_samples(evidence: Evidence) -> Iterator[Hypothesis]:
    """Single samples that are off, by their sign or in any way."""
    name, values = evidence.name, evidence.values
    apart = np.abs(values - evidence.truth)
    stray = (apart > 5.0 * evidence.tolerance + 1e-3 * evidence.scale) & evidence.counted | evidence.over
    if 0 < np.sum(stray) <= max(1.0, FEW_SAMPLES * len(stray)):
        mirrored = np.abs(values + evidence.truth) <= evidence.tolerance + 0.01 * np.abs(evidence.truth)
        times = evidence.time[stray]
        at, more = ", ".join(f"{time:.5g}" for time in times[:MOST_TIMES]), len(times) - MOST_TIMES
        words = f"{name} {'has the other sign' if np.all(mirrored[stray]) else 'is off'} in "
        words += f"{'a single sample' if len(times) == 1 else f'{len(times)} single samples'}, at {at} s"
        words += f" and {more} more" if more > 0 else ""
        yield _certain(f"stray samples:{name}", FaultKind.SEVERAL, {(name, "stray"): (times, values[stray])}, words)


def _mistaken_quantities(evidence: Evidence, simulation: Simulation, names: Sequence[str]) -> Iterator[Hypothesis]:
    """Another quantity of the linkage under this name, perhaps with the other sign."""
    name, thin = evidence.name, evidence.thinned(100)
    others = [other for other in names if other != name]
    scale = float(np.max(np.abs(thin.values)))
    for other, truth in zip(others, simulation.predict([replace(thin, name=o) for o in others]), strict=True):
        for sign, sense in ((1.0, ""), (-1.0, " with the other sign")):
            if float(np.max(np.abs(sign * truth - thin.values))) < ALIKE * scale:
                values: Values = {(name, "of"): other, (name, "scale"): sign}
                words = f"{name} contains {other}{sense}"
                yield _certain(f"is {other}{sense}:{name}", FaultKind.COLUMN, values, words)


def of_columns(evidence: Sequence[Evidence]) -> Iterator[Hypothesis]:
    """Faults of at least two columns at once: an axis the other way, a unit, a reaction for an action."""
    names = [signal.name for signal in evidence]
    component, owner = ({name: name.rpartition(":")[part] for name in names} for part in (2, 0))
    groups = {
        "rotary": (list(filter(is_rotary, names)), "angles, turns and torques count clockwise"),
        **{axis: ([name for name in names if component[name] in (axis, f"v{axis}", f"a{axis}")],
                  f"the {axis} axis points the other way") for axis in "xy"},
        "output": ([name for name in names if name in ("S", "v", "a")], "the output counts the other way"),
        "forces": ([name for name in names if name.startswith("joint_force")],
                   "joint forces are those on the other links"),
    }  # fmt: skip
    for joint in {owner[name] for name in groups["forces"][0]}:
        words = f"the force of '{joint.partition(':')[2]}' is that on the other link"
        groups[joint] = ([name for name in names if owner[name] == joint], words)
    for group, (members, words) in groups.items():
        if len(members) > 1:
            yield _certain(f"sign of {group}", FaultKind.COLUMN, _scaled(members, -1.0), words)
    for unit, si, header in sorted({(signal.unit, signal.si, signal.header) for signal in evidence}):
        members = [signal.name for signal in evidence if (signal.si, signal.header) == (si, header)]
        for k, slip in unit_slips(si, header) if len(members) > 1 else ():
            words = f"all that is in {unit or '1'} is {k:.6g} times too large: {slip}"
            yield _certain(f"unit {unit} {k:g}", FaultKind.COLUMN, _scaled(members, k), words)


def _scaled(names: Sequence[str], factor: float) -> Values:
    """Columns times a factor."""
    return {(name, "scale"): factor for name in names}


# The crank's motion: direction, zero, clock, speed, run-up.


@dataclass(frozen=True)
class CrankColumn:
    """The column that gives the crank's motion: the angle, phi, or the speed, omega; "" of what does not turn.

    ``unit`` is printed in its ``header``; ``value`` is its SI value.
    """

    name: str
    header: str
    unit: str
    value: float


def of_motion(simulation: Simulation, column: CrankColumn | None, names: Sequence[str]) -> Iterator[Hypothesis]:
    """Every fault of the crank's motion; speed and ramps only where a regime, not a column of the file, gives it.

    ``names`` are the file's columns.
    """
    motion, setting = simulation.motion, FaultKind.SETTING
    start, from_column = float(motion.angle(0.0)), column is not None
    if column is not None:
        for unit, value in UNITS.get({"phi": "rad", "omega": "rad/s"}.get(column.name, ""), {}).items():
            k = value / column.value
            if not math.isclose(k, 1.0, rel_tol=SAME_UNIT):
                words = f"the column '{column.header}' is in {unit}{f', not in {column.unit}' if column.unit else ''}"
                values: Values = {PACE: k, OFFSET: start * (1.0 - k) if column.name == "omega" else 0.0}
                yield _certain(f"unit:{column.name}", FaultKind.COLUMN, values, words)
    direction = "the crank angle is mirrored" if from_column else "the crank turns the other way"
    yield _certain("direction", setting, {PACE: -1.0, OFFSET: 2.0 * start}, direction)
    rotary = _scaled([name for name in names if is_rotary(name)], -1.0)
    yield Hypothesis("view from behind", setting, lambda about: {PACE: -1.0, OFFSET: about, **rotary},
                     lambda _: "the motor's axis points the other way: angles, turns and torques count clockwise",
                     usual=tuple((about,) for about in dict.fromkeys((2.0 * start, 0.0))))  # fmt: skip

    def zero(angle: float) -> str:
        if from_column:
            added = signed(math.degrees(wrap_angle(angle)), ".4g")
            return f"the crank angle counts from another zero: {added}° are to be added to the file's"
        at = math.degrees(wrap_angle(start + angle))
        return f"the crank starts at {at:.4g}° in place of {math.degrees(start):.4g}°"

    def mirrored(angle: float) -> str:
        if abs(wrap_angle(angle)) < ZERO_ANGLE:
            return "the crank angle is mirrored"
        return f"the crank angle counts the other way, from {math.degrees(wrap_angle(angle)):.4g}°"

    around = tuple((FULL_TURN * n / START_ANGLES,) for n in range(START_ANGLES))
    quarters = tuple((angle,) for angle in QUARTER_TURNS)
    yield Hypothesis("start angle", setting, lambda a: {OFFSET: a}, zero, (0.0,), (1.0,), around, quarters,
                     1.0 / RADIAN)  # fmt: skip
    yield Hypothesis("mirrored angle", setting, lambda a: {PACE: -1.0, OFFSET: a}, mirrored, (0.0,), (1.0,), around,
                     ((0.0,), *quarters), 1.0 / RADIAN)  # fmt: skip
    turn = min(FULL_TURN / motion.peak_speed if motion.peak_speed else motion.duration, motion.duration)
    yield Hypothesis("time shift", setting, lambda t: {SHIFT: t},
                     lambda t: f"the file's clock is {abs(t):.4g} s {'behind' if t > 0.0 else 'ahead'}",
                     (0.0,), (turn,), tuple((k * turn / 8.0,) for k in (0, 1, -1, 2, -2, 3, -3)), unit=1.0)  # fmt: skip
    yield _certain("no acceleration", setting, {ORDER: 1},
                   "the crank's acceleration is left out: torque and forces are those of a constant speed")  # fmt: skip
    if not from_column:
        yield from _of_regime(motion, start)


def wrap_angle(angle: float) -> float:
    """An angle, rad, within −π to π: whole turns taken away."""
    return (float(angle) + math.pi) % FULL_TURN - math.pi


def _of_regime(motion: Any, start: float) -> Iterator[Hypothesis]:  # noqa: ANN401 - a Motion, narrowed
    """Faults of a stated regime: another speed, another ramp, another time of the ramp."""
    setting, rpm = FaultKind.SETTING, motion.peak_speed / RPM
    turned_by = abs(float(motion.angle(motion.duration)) - start)
    paces = np.linspace(0.5, 1.5, int(min(max(turned_by / PHASE_CAPTURE, 9.0), MOST_PACES)))
    yield Hypothesis("speed", setting, lambda k: {PACE: k, OFFSET: start * (1.0 - k)},
                     lambda k: f"the crank's speed is {k * rpm:.4g} rpm in place of {rpm:.4g} rpm", (1.0,), (1.0,),
                     ((1.0,), *((float(pace),) for pace in paces)), unit=1.0 / rpm if rpm else 0.0)  # fmt: skip
    if not isinstance(motion, CrankMotion) or motion.regime not in (*RAMPS, "constant-speed"):
        return
    speed = float(motion.speed(motion.duration))
    ramp = motion.segments[0].end if motion.regime in RAMPS else 0.6 * motion.duration

    def similar(name: str, ramp: float) -> Values:
        ramp = min(max(abs(ramp), SHORTEST_RAMP), motion.duration)
        return {MOTION: crank_motion(name, speed=abs(speed), ramp_time=ramp, hold_time=motion.duration - ramp,
                                     clockwise=speed < 0.0, start_angle=start)}  # fmt: skip

    for name in (*RAMPS, "constant-speed"):
        if name != motion.regime:
            words = f"the crank follows '{name}' in place of '{motion.regime}'"
            yield _certain(f"ramp:{name}", setting, similar(name, ramp), words)
    if motion.regime in RAMPS:
        yield Hypothesis("ramp time", setting, lambda time: similar(motion.regime, time),
                         lambda time: f"the crank runs up in {time:.4g} s in place of {ramp:.4g} s", (ramp,), (ramp,),
                         ((ramp,), *((float(k) * motion.duration,) for k in np.linspace(0.02, 1.0, 50))),
                         unit=1.0)  # fmt: skip


# The model: gravity, assembly modes, dampers and loads, then every number of the linkage's file.


def of_model(simulation: Simulation) -> Iterator[Hypothesis]:
    """Every fault of a model but those of its motion: settings, then numbers."""
    linkage = simulation.linkage
    yield from _of_gravity(linkage)
    yield from _of_modes(simulation)
    yield from _of_dampers(simulation)
    yield from _of_loads(linkage)
    for name, number in named_numbers(linkage).items():
        yield from _of_number(linkage, name, number)
    yield from _of_several_numbers(linkage)


def _of_gravity(linkage: Linkage) -> Iterator[Hypothesis]:
    """Another gravity along the file's direction, and any vector."""
    (x, y), size = linkage.gravity, math.hypot(*linkage.gravity)
    if not any(link.mass for link in linkage.links.values()):
        return

    def gravity(gx: float, gy: float) -> Values:
        return {"gravity.x": gx, "gravity.y": gy}

    def words(k: float) -> str:
        if abs(k) < 1e-9:
            return "gravity is off"
        if math.isclose(k, -1.0):
            return "gravity points the other way"
        return f"gravity is {k * size:.4g} m/s² in place of {size:.4g} m/s²"

    def pointing(gx: float, gy: float) -> str:
        return f"gravity is ({fixed(gx, 3)}, {fixed(gy, 3)}) m/s² in place of ({x:zg}, {y:zg}) m/s²"

    if size:
        usual = (0.0, -1.0, *(g / size for g in (EARTH, 9.81, 9.8) if g != size), 2.0, 1e3, 1e-3)
        yield Hypothesis("gravity", FaultKind.SETTING, lambda k: gravity(k * x, k * y), words, (1.0,), (1.0,),
                         usual=tuple((k,) for k in usual), is_linear=True)  # fmt: skip
    quarter_turns = tuple(rotate((x, y), turn) for turn in ((0.0, 1.0), (0.0, -1.0)))
    axes = ((0.0, -EARTH), (0.0, -9.81), (0.0, EARTH), (0.0, 9.81), (-EARTH, 0.0), (EARTH, 0.0))
    yield Hypothesis("gravity's direction", FaultKind.SEVERAL, gravity, pointing,
                     (x, y), (EARTH, EARTH), usual=quarter_turns if size else axes)  # fmt: skip


def _of_modes(simulation: Simulation) -> Iterator[Hypothesis]:
    """One group each that is assembled in its other mode."""
    dyads = simulation.mechanism.structure.dyads
    for number, dyad in [(n, dyad) for n, dyad in enumerate(dyads) if dyad.has_two_modes][:MOST_MODES]:
        signs = tuple(-other.sign if n == number else other.sign for n, other in enumerate(dyads))
        words = f"{dyad.words} are assembled in their other mode"
        yield _certain(f"mode:{dyad.first}", FaultKind.SETTING, {MODES: signs}, words, reshapes=True)


def _of_dampers(simulation: Simulation) -> Iterator[Hypothesis]:
    """Friction that grows with the speed, in a pin that has none in the file."""
    linkage = simulation.linkage
    inertia = sum((k.inertia or 0.0) + k.mass * linkage.extent() ** 2 for k in linkage.links.values())
    size = (inertia or 1.0) * (simulation.motion.peak_speed or 1.0)
    present = {frozenset(damper.links) for damper in linkage.dampers}
    pairs = {frozenset((pin.hub, k)): (pin.point, pin.hub, k) for pin in linkage.pins for k in pin.joints.values()}
    for at, hub, link in (place for pair, place in pairs.items() if pair not in present):
        yield _of_damper(linkage, at, (hub, link), size)


def _of_damper(linkage: Linkage, at: str, pair: tuple[str, str], size: float) -> Hypothesis:
    def dampers(b: float) -> Values:
        return {(LINKAGE, "dampers"): (*linkage.dampers, RotaryDamper(pair, float(b)))}

    def words(b: float) -> str:
        return f"a rotary damper of {b:.3g} N m s acts in the pin '{at}'"

    return Hypothesis(f"damping:{at}", FaultKind.SEVERAL, dampers, words, (0.0,), (size,), is_linear=True)


def _of_loads(linkage: Linkage) -> Iterator[Hypothesis]:
    """All loads of a kind left out; a load at another point or on another link."""

    def misplaced(name: str, part: str, number: int, words: str, **changes: object) -> Hypothesis:
        loads = list(getattr(linkage, part))
        loads[number] = replace(loads[number], **changes)
        return _certain(name, FaultKind.SETTING, {(LINKAGE, part): tuple(loads)}, words)

    for part in LOADS:
        if getattr(linkage, part):
            words = f"the {part} of the linkage file are left out"
            yield _certain(f"no {part}", FaultKind.SETTING, {(LINKAGE, part): EMPTY_PARTS[part]}, words)
    for number, force in enumerate(linkage.forces):
        at, name = force.point, f"forces.{force.point}"
        for point in linkage.links[force.link].points if force.link in linkage.links else ():
            if point != at:
                yield misplaced(f"{name} at {point}", "forces", number, f"the force at '{at}' acts at '{point}'",
                                point=point)  # fmt: skip
    for number, torque in enumerate(linkage.torques):
        for link in linkage.links:
            if link != torque.link:
                yield misplaced(f"torques.{torque.link} on {link}", "torques", number,
                                f"the torque on '{torque.link}' acts on '{link}'", link=link)  # fmt: skip
    for number, damper in enumerate(linkage.dampers):
        key, other = damper.links
        if GROUND not in damper.links:
            words = f"the damper of '{key}' and '{other}' acts on the ground"
            name = f"dampers.{key}.{other} against the ground"
            yield misplaced(name, "dampers", number, words, links=(key, GROUND))


def _of_number(linkage: Linkage, name: str, number: Number) -> Iterator[Hypothesis]:
    """That number of the description alone has another value; a direction is turned. Without effect, nothing."""
    kind, value, path = number.kind, number.value, number.path
    is_place, is_load = kind in (Kind.LENGTH, Kind.ACCELERATION), path[0] in LOADS
    if kind is Kind.DIRECTION:
        if name.endswith(".x"):
            yield _turned(linkage, name.removesuffix(".x"))
        return
    of_load = sum(other.path[:2] == path[:2] for other in named_numbers(linkage).values())
    if path[0] == "sketch" or not (value or is_place) or (path[0] in LOADS[:2] and of_load > MOST_LOAD_NUMBERS):
        return
    size = {Kind.LENGTH: linkage.shortest_length(), Kind.ACCELERATION: 9.81}.get(kind, abs(value))
    own = kind in (Kind.MASS, Kind.INERTIA)
    factors = USUAL_FACTORS.get(kind, LOAD_FACTORS)
    about = _inertias_about_points(linkage, str(path[1])) if kind is Kind.INERTIA else {}
    what, unit = _number_words(name, number), kind_unit(kind, linkage.units)

    def words(new: float) -> str:
        if not new and not is_place:
            return f"{what} is left out"
        at = next((point for place, point in about.items() if math.isclose(place, new, rel_tol=1e-9)), "")
        end = f": that about '{at}', not about the mass centre" if at else _slip_words(kind.si, value and new / value)
        old = f"{value / unit.size:z.4g} {unit.name}"
        return f"{what} is {new / unit.size:z.4g} {unit.name} in place of {old}{end}"

    usual = dict.fromkeys([*about, *(value * k for k in factors)])
    yield Hypothesis(name, FaultKind.NUMBER, lambda new: {name: new}, words, (value,), (size or 1.0,),
                     usual=tuple((new,) for new in usual if new != value), unit=unit.size,
                     bounds=POSITIVE if own else ANY,
                     reshapes=kind is Kind.LENGTH and "centre" not in path and not is_load,
                     is_linear=kind is not Kind.LENGTH)  # fmt: skip


def _number_words(name: str, number: Number) -> str:
    """What a number of the description is, in words."""
    match number.path:
        case ("links", link, "mass"):
            what = f"the mass of '{link}'"
        case ("links", link, "inertia"):
            what = f"the moment of inertia of '{link}'"
        case ("links", link, "centre", int(axis)):
            what = f"{'xy'[axis]} of the mass centre of '{link}'"
        case ("links", link, "points", point, int(axis)):
            what = f"{'xy'[axis]} of '{point}' on '{link}'"
        case ("ground", point, int(axis)):
            what = f"{'xy'[axis]} of '{point}' on the ground"
        case ("sliders" | "slots", _, _, "through", int(axis)):
            what = f"{'xy'[axis]} of the guide of '{name.partition('.through')[0]}'"
        case ("gravity", int(axis)):
            what = f"{'xy'[axis]} of gravity"
        case _:
            what = f"'{name}'"
    return what


def _inertias_about_points(linkage: Linkage, name: str) -> dict[float, str]:
    """The points of a link by its inertia about each, kg m²."""
    link = linkage.links[name]
    distances = {point: math.dist(at, link.centre) for point, at in link.points.items()}
    return {(link.inertia or 0.0) + link.mass * d**2: point for point, d in distances.items() if d and link.mass}


def _turned(linkage: Linkage, name: str) -> Hypothesis:
    """A direction that is turned by an angle, rad."""
    known, of = named_numbers(linkage), name.removesuffix(".along")
    x, y = (known[f"{name}.{axis}"].value for axis in "xy")
    what = "the direction of the output" if of == "output" else f"the guide of '{of}'"

    def turned(angle: float) -> Values:
        c, s = math.cos(angle), math.sin(angle)
        return {f"{name}.x": c * x - s * y, f"{name}.y": s * x + c * y}

    return Hypothesis(
        name, FaultKind.NUMBER, turned, lambda a: f"{what} is turned by {math.degrees(a):.3g}°", (0.0,), (1.0,),
        unit=1.0 / RADIAN, bounds=(-math.pi, math.pi), reshapes=of != "output",
    )  # fmt: skip


def _of_several_numbers(linkage: Linkage) -> Iterator[Hypothesis]:
    """All numbers of a kind, a distance, a mass centre, mass and inertia of a link, a load."""
    for kinds, usual in (
        ((Kind.MASS,), (1e3, 1e-3)),
        ((Kind.INERTIA,), USUAL_FACTORS[Kind.INERTIA]),
        ((Kind.MASS, Kind.INERTIA), (1e3, 1e-3, 0.45359237)),
        ((Kind.LENGTH,), (1e3, 1e-3, 0.1, 10.0, 0.0254, 25.4)),
    ):
        every = f"every {' and '.join({'inertia': 'moment of inertia'}.get(kind, str(kind)) for kind in kinds)}"
        yield _multiplied(linkage, every, every, usual, *kinds)
    for name, link in linkage.links.items():
        if link.mass:
            yield _other_centre(linkage, name)
        if link.mass and link.inertia:
            both = f"mass and inertia of '{name}' together"
            yield _multiplied(linkage, f"{name}.density", both, (0.0,), Kind.MASS, Kind.INERTIA, under=f"{name}.")
    if sum(len(link.points) for link in linkage.links.values()) <= MOST_POINTS:
        for name, link in linkage.links.items():
            for fixed_point, moved in itertools.permutations(link.points, 2):
                if all(a != b for a, b in zip(link.points[fixed_point], link.points[moved], strict=True)):
                    yield _other_distance(linkage, name, fixed_point, moved)
    loads = (name.split(".") for name in named_numbers(linkage) if name.partition(".")[0] in LOADS[:2])
    for load in dict.fromkeys(".".join(parts[:2]) for parts in loads):
        yield _multiplied(linkage, load, f"the load '{load}'", LOAD_FACTORS, Kind.FORCE, Kind.TORQUE, under=load)


def _multiplied(
    linkage: Linkage, name: str, subject: str, usual: Sequence[float], *kinds: Kind, under: str = ""
) -> Hypothesis:
    """All numbers of some ``kinds``, with names that begin ``under``, are multiplied by a factor."""
    numbers = {
        label: number.value
        for label, number in named_numbers(linkage).items()
        if number.kind in kinds and label.startswith(under)
    }

    def words(k: float) -> str:
        if abs(k) < 1e-9:
            return f"{subject} is left out"
        return f"{subject} is {k:.4g} times that of the linkage file{_slip_words(kinds[0].si, k)}"

    return Hypothesis(name, FaultKind.SEVERAL, lambda k: {label: k * value for label, value in numbers.items()}, words,
                      (1.0,), (1.0,), usual=tuple((k,) for k in usual), unit=1.0,
                      bounds=ANY if under.startswith(LOADS) else POSITIVE, reshapes=Kind.LENGTH in kinds,
                      is_linear=Kind.LENGTH not in kinds)  # fmt: skip


def _other_distance(linkage: Linkage, name: str, fixed_point: str, moved: str) -> Hypothesis:
    """A point of a link at another distance, m, from a ``fixed_point``, in the same direction."""
    (x, y), (px, py) = linkage.links[name].points[fixed_point], linkage.links[name].points[moved]
    length = math.dist((x, y), (px, py))

    def place(d: float) -> Values:
        return {f"{name}.{moved}.x": x + d / length * (px - x), f"{name}.{moved}.y": y + d / length * (py - y)}

    def words(d: float) -> str:
        lengths = f"{linkage.written(d)} in place of {linkage.written(length)}"
        return f"the distance of '{moved}' from '{fixed_point}' on '{name}' is {lengths}"

    unit = factor("length", linkage.units.get("length", "m"))
    label = f"{name}.{fixed_point}-{moved}"
    return Hypothesis(label, FaultKind.NUMBER, place, words, (length,), (length,), unit=unit, bounds=POSITIVE,
                      reshapes=True)  # fmt: skip


def _other_centre(linkage: Linkage, name: str) -> Hypothesis:
    """A link's mass centre elsewhere: at a usual wrong place, or anywhere."""
    link = linkage.links[name]
    (x, y), places, size = link.centre, list(link.points.values()), linkage.shortest_length()
    middle = (float(np.mean([p[0] for p in places])), float(np.mean([p[1] for p in places])))
    usual: list[Numbers] = [*places, middle, (-x, -y), (y, x), (0.0, 0.0), (1e3 * x, 1e3 * y), (1e-3 * x, 1e-3 * y)]
    if len(places) == 2:  # measured from the other end
        usual.append((places[0][0] + places[1][0] - x, places[0][1] + places[1][1] - y))

    def words(cx: float, cy: float) -> str:
        new, old = (", ".join(linkage.written(v).rpartition(" ")[0] for v in at) for at in ((cx, cy), link.centre))
        unit = linkage.units.get("length", "m")
        return f"the mass centre of '{name}' is at ({new}) {unit} in place of ({old}), in the link's frame"

    return Hypothesis(f"{name}.centre", FaultKind.SEVERAL,
                      lambda cx, cy: {f"{name}.centre.x": cx, f"{name}.centre.y": cy}, words, link.centre, (size, size),
                      usual=tuple(dict.fromkeys(p for p in usual if p != link.centre)))  # fmt: skip
