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

from analytic.description.changes import EMPTY_PARTS, named_numbers
from analytic.description.crank_motion import RAMPS, RPM, CrankMotion, crank_motion
from analytic.description.law import FULL_TURN
from analytic.description.linkage import GROUND, LOADS, JointFriction, Linkage, RotaryDamper, rotate
from analytic.description.units import Kind, factor
from analytic.description.walk import Number
from analytic.description.written import fixed, kind_unit, signed
from analytic.signals import unit as si_unit
from comparisons.filejudge.columns import Evidence, ImportedSignal
from comparisons.filejudge.headers import MISTAKEN_UNITS
from comparisons.filejudge.simulation import CRANK, INCOMPLETE, LINKAGE, MODES, MOTION, Simulation, Values, is_rotary

Numbers = tuple[float, ...]

RADIAN: Final = 180.0 / math.pi
OF_NO_UNIT: Final = {"its unit": 1.0, "a thousandth of it": 1e-3}
SAME_UNIT: Final = 1e-6  # relative
EARTH: Final = 9.80665
ALIKE: Final = 0.05  # of the peak, within which a column is another quantity
FEW_SAMPLES: Final = 0.03  # of the samples: single ones
MOST_RATIO_ERROR: Final = 0.2  # of a unit's ratio, by which the file's may differ where it has other faults
MOST_TIMES: Final = 4  # of single samples that are named
MOST_MODES: Final = 8  # of a linkage whose other assembly modes are tried
MOST_PACES: Final = 150
MOST_LOAD_NUMBERS: Final = 8  # of one load: of a longer table no number is a fault of its own
MOST_POINTS: Final = 60  # of a linkage whose distances are tried one by one
NO_FRICTION: Final = 1e-2  # of what counts as a change: what is smaller is not named
PHASE_CAPTURE: Final = 0.7  # rad, from which a fit finds the phase
QUARTER_TURNS: Final = (0.5 * math.pi, -0.5 * math.pi, math.pi)
SHORTEST_RAMP: Final = 1e-9  # s, of a ramp
START_ANGLES: Final = tuple(np.linspace(0.0, FULL_TURN, 12, endpoint=False).tolist())  # from which fits of one begin
ZERO_ANGLE: Final = 1e-6  # rad: the rounding of a start angle
# What is written in place of a number, as its multiples.
USUAL_FACTORS: Final[Mapping[Kind, Numbers]] = {
    Kind.MASS: (0.0, 1e3, 1e-3),
    Kind.INERTIA: (0.0, 1e3, 1e-3, 1e6, 1e-6),
    Kind.LENGTH: (-1.0,),
    Kind.ACCELERATION: (0.0, -1.0),
}
NUMBER_WORDS: Final = {  # of a number, by the first of its path and the field of a link
    ("links", "mass"): "the mass of '{1}'",
    ("links", "inertia"): "the moment of inertia of '{1}'",
    ("links", "centre"): "{axis} of the mass centre of '{1}'",
    ("links", "points"): "{axis} of '{3}' on '{1}'",
    ("ground", ""): "{axis} of '{1}' on the ground",
    ("sliders", ""): "{axis} of the guide of '{guide}'",
    ("slots", ""): "{axis} of the guide of '{guide}'",
    ("gravity", ""): "{axis} of gravity",
    ("friction", ""): "the coefficient of friction of '{1}'",
}
LOAD_FACTORS: Final = (0.0, -1.0, 1e3, 1e-3)  # multiples of a load that are written in its place
PACE, OFFSET, SHIFT, ORDER = ((CRANK, knob) for knob in ("pace", "offset", "shift", "order"))


class FaultKind(IntEnum):
    """Where a fault lies, in the order in which an engineer looks: of causes that fit alike the first is named."""

    COLUMN = 0  # sign, unit or meaning of a column of the file
    SETTING = 1  # one setting of the tool: gravity, direction, start, units, what is left out
    NUMBER = 2  # one number of the description
    SEVERAL = 3  # several numbers at once
    FREE = 4  # a factor of a column that no unit explains, friction of all joints


COLUMN, SETTING, NUMBER, SEVERAL, FREE = FaultKind


@dataclass(frozen=True)
class Hypothesis:
    """One thing that may be wrong: ``targets(*numbers)`` have other values, ``words(*numbers)`` is its sentence.

    ``targets`` returns what ``Simulation.with_values`` takes; numbers are SI or factors. ``start`` (k,) are the numbers
    with which nothing is wrong, ``sizes`` what counts as a change of each; fits begin at the ``guesses`` for a single
    number, and ``usual`` numbers, single or (k,), are tried as they are. No number is less than ``least``. ``unit`` is
    that in which a single number is written, as SI value: round ones are likelier; 0 for none. One that ``is_slow``
    makes the linkage move otherwise: its positions are computed anew. All curves are a linear function of one that
    ``is_linear``, but for friction and the sizes of forces.
    """

    name: str
    kind: FaultKind
    targets: Callable[..., Values]
    words: Callable[..., str]
    start: Numbers = ()
    sizes: Numbers = (1.0,)
    guesses: Sequence[float] = ()
    usual: Sequence[float | Numbers] = ()
    unit: float = 0.0
    least: float = -math.inf
    is_slow: bool = False
    is_linear: bool = False


def _certain(name: str, kind: FaultKind, values: Values, words: str, *, is_slow: bool = False) -> Hypothesis:
    """A hypothesis that has no number to fit: its targets have these values, and ``words`` is its sentence."""
    return Hypothesis(name, kind, lambda: values, lambda: words, is_slow=is_slow)


def unit_slips(si: str, header: float | None = None) -> Iterator[tuple[float, str]]:
    """Yield factors by which values are wrong if one unit is read as another, with words: "grams read as kilograms".

    ``si`` is the SI unit of the values; with a ``header``, the SI size of a unit, only that unit is what is read.
    """
    units = MISTAKEN_UNITS.get(si, OF_NO_UNIT)
    read = dict(units)
    if header is not None:
        read = {unit: k for unit, k in units.items() if math.isclose(k, header)} or {"the header's unit": header}
    for (unit, value), (taken, k) in itertools.product(units.items(), read.items()):
        if not math.isclose(k, value, rel_tol=SAME_UNIT):
            yield k / value, f"{unit} read as {taken}"


def _slip_words(si: str, k: float) -> str:
    """The units mistaken for each other if a factor ``k`` is their ratio: " (factor 1000: grams read as kilograms)".

    "" for any other factor. ``si`` is the SI unit of the values.
    """
    slips = (words for ratio, words in unit_slips(si) if math.isclose(ratio, k, rel_tol=SAME_UNIT))
    return next((f" (factor {k:.6g}: {words})" for words in slips), "")


# The columns of a file: sign, unit, zero, clock, single samples, another quantity.


def of_column(evidence: Evidence, simulation: Simulation, names: Sequence[str]) -> Iterator[Hypothesis]:
    """Yield every fault that may lie in one column; ``names`` are the signals that it may be taken for.

    Of mistaken units only those are tried whose ratio comes near to the column's.
    """
    name, size, step = evidence.name, evidence.scale, float(np.median(np.diff(evidence.time)))
    scale, offset, shift = ((name, knob) for knob in ("scale", "offset", "shift"))

    def by(c: float) -> str:
        """An offset ``c``, SI, in words, with its sign and the column's unit: "+5 mm"."""
        return f"{signed(c / evidence.unit_value, '.4g')} {evidence.unit}"

    def late(t: float) -> str:
        """The sentence that a column is ``t`` seconds too early, or too late if negative.

        It has the samples, too, if these are halves or whole ones.
        """
        halves = 2.0 * t / step
        whole = f", {abs(t / step):.2g} samples," if round(halves) and abs(halves - round(halves)) < 0.1 else ""
        return f"{name} is {abs(t):.4g} s{whole} too {'early' if t > 0.0 else 'late'}"

    yield _certain(f"sign:{name}", COLUMN, {scale: -1.0}, f"{name} has the other sign")
    truth = evidence.truth[evidence.counted]
    share = float(evidence.values[evidence.counted] @ truth) / (float(truth @ truth) or math.inf)
    for (k, slip), sign in itertools.product(unit_slips(evidence.si, evidence.header), (1.0, -1.0)):
        if abs(share / (sign * k) - 1.0) < MOST_RATIO_ERROR or evidence.si == "rad":  # known but for whole turns
            sense = "" if sign > 0.0 else " and has the other sign"
            words = f"{name} is {k:.6g} times the closed form's{sense}: {slip}"
            yield _certain(f"unit:{name}", COLUMN, {scale: sign * k}, words)
    zero = COLUMN if evidence.si in ("rad", "m") else SEVERAL  # angles and lengths have a zero of choice
    yield from (
        Hypothesis(f"factor:{name}", FREE, lambda k: {scale: k},
                   lambda k: f"{name} is {k:.5g} times the closed form's", (1.0,)),
        Hypothesis(f"offset:{name}", zero, lambda c: {offset: c},
                   lambda c: f"{name} counts from another zero, {by(c)} from the linkage file's", (0.0,), (size,)),
        Hypothesis(f"counted back:{name}", zero, lambda c: {scale: -1.0, offset: c},
                   lambda c: f"{name} counts the other way, from {by(c)}, as from the other dead centre",
                   (0.0,), (size,), (size,)),
        Hypothesis(f"delay:{name}", SEVERAL, lambda t: {shift: t}, late, (0.0,), (step,),
                   usual=[k * step for k in (0.5, -0.5, 1.0, -1.0, 2.0, -2.0)]),
    )  # fmt: skip
    for incomplete in INCOMPLETE if name == "Mkr" else ():
        part = incomplete.removeprefix("Mkr without ")
        words = f"Mkr lacks {part}, a velocity-quadratic part that grows as ω²"
        yield _certain(f"no {part}:{name}", SETTING, {(name, "of"): incomplete}, words)
    yield from _single_samples(evidence)
    yield from _mistaken_quantities(evidence, simulation, names)


def _single_samples(evidence: Evidence) -> Iterator[Hypothesis]:
    """Yield the fault that a few single samples have the other sign or are off; nothing if they are none or many.

    A few is one, or FEW_SAMPLES of all.
    """
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
        yield _certain(f"stray samples:{name}", SEVERAL, {(name, "stray"): (times, values[stray])}, words)


def _mistaken_quantities(evidence: Evidence, simulation: Simulation, names: Sequence[str]) -> Iterator[Hypothesis]:
    """Yield hypotheses that the column is another quantity among ``names``, perhaps with the other sign.

    Only quantities within ALIKE of the column's peak count.
    """
    name, thin = evidence.name, evidence.thinned(100)
    others = [other for other in names if other != name]
    scale = float(np.max(np.abs(thin.values)))
    for other, truth in zip(others, simulation.predict([replace(thin, name=o) for o in others]), strict=True):
        for sign, sense in ((1.0, ""), (-1.0, " with the other sign")):
            if float(np.max(np.abs(sign * truth - thin.values))) < ALIKE * scale:
                values: Values = {(name, "of"): other, (name, "scale"): sign}
                yield _certain(f"is {other}{sense}:{name}", COLUMN, values, f"{name} contains {other}{sense}")


def of_columns(evidence: Sequence[Evidence]) -> Iterator[Hypothesis]:
    """Yield faults of at least two columns at once: a sign of a group of them, or one unit read as another.

    Groups are turns and torques, components along an axis, the output's signals, all joint forces, and those of a
    joint.
    """
    names = [signal.name for signal in evidence]
    component, owner = ({name: name.rpartition(":")[part] for name in names} for part in (2, 0))
    forces = [name for name in names if name.startswith("joint_force")]
    groups = {
        "rotary": (filter(is_rotary, names), "angles, turns and torques count clockwise"),
        **{axis: ((name for name in names if component[name] in (axis, f"v{axis}", f"a{axis}")),
                  f"the {axis} axis points the other way") for axis in "xy"},
        "output": ((name for name in names if name in ("S", "v", "a")), "the output counts the other way"),
        "forces": (forces, "joint forces are those on the other links"),
        **{joint: ((name for name in names if owner[name] == joint),
                   f"the force of '{joint.partition(':')[2]}' is that on the other link")
           for joint in {owner[name] for name in forces}},
    }  # fmt: skip
    rows: list[tuple[str, Sequence[str], float, str]] = [
        (f"sign of {group}", [*members], -1.0, words) for group, (members, words) in groups.items()
    ]
    for unit, si, header in sorted({(signal.unit, signal.si, signal.header) for signal in evidence}):
        members = [signal.name for signal in evidence if (signal.si, signal.header) == (si, header)]
        for k, slip in unit_slips(si, header):
            rows += [
                (f"unit {unit} {k:g}", members, k, f"all that is in {unit or '1'} is {k:.6g} times too large: {slip}")
            ]
    for name, columns, k, words in rows:
        if len(columns) > 1:
            yield _certain(name, COLUMN, {(column, "scale"): k for column in columns}, words)


# The crank's motion: direction, zero, clock, speed, run-up.


def of_motion(simulation: Simulation, column: ImportedSignal | None, names: Sequence[str]) -> Iterator[Hypothesis]:
    """Yield every fault of the crank's motion; speed and ramps only where no ``column`` of the file gives it.

    ``names`` are the signals of the file's columns.
    """
    motion, start = simulation.motion, float(simulation.motion.angle(0.0))
    if column is not None:
        for printed, value in MISTAKEN_UNITS.get(si_unit(column.name, simulation.linkage), {}).items():
            k = value / column.unit_value
            if not math.isclose(k, 1.0, rel_tol=SAME_UNIT):
                stated = f", not in {column.column.unit}" if column.column.unit else ""
                words = f"the column '{column.column.header}' is in {printed}{stated}"
                values: Values = {PACE: k, OFFSET: start * (1.0 - k) if column.name == "omega" else 0.0}
                yield _certain(f"unit:{column.name}", COLUMN, values, words)

    def zero(angle: float) -> str:
        """The sentence that the crank angle counts from another zero, off by an angle, rad.

        Without a column, that the crank starts elsewhere. It is in degrees.
        """
        if column is not None:
            added = signed(math.degrees(wrap_angle(angle)), ".4g")
            return f"the crank angle counts from another zero: {added}° are to be added to the file's"
        at = math.degrees(wrap_angle(start + angle))
        return f"the crank starts at {at:.4g}° in place of {math.degrees(start):.4g}°"

    def mirrored(angle: float) -> str:
        """The sentence that the crank angle counts the other way, from an angle, rad, which it has in degrees."""
        if abs(wrap_angle(angle)) < ZERO_ANGLE:
            return "the crank angle is mirrored"
        return f"the crank angle counts the other way, from {math.degrees(wrap_angle(angle)):.4g}°"

    turn = min(FULL_TURN / motion.peak_speed if motion.peak_speed else motion.duration, motion.duration)
    behind: Values = {(name, "scale"): -1.0 for name in names if is_rotary(name)}
    yield from (
        _certain("direction", SETTING, {PACE: -1.0, OFFSET: 2.0 * start},
                 "the crank turns the other way" if column is None else "the crank angle is mirrored"),
        Hypothesis("view from behind", SETTING, lambda about: {PACE: -1.0, OFFSET: about, **behind},
                   lambda _: "the motor's axis points the other way: angles, turns and torques count clockwise",
                   usual=[*dict.fromkeys((2.0 * start, 0.0))]),
        Hypothesis("start angle", SETTING, lambda a: {OFFSET: a}, zero, (0.0,), guesses=START_ANGLES,
                   usual=QUARTER_TURNS, unit=1.0 / RADIAN),
        Hypothesis("mirrored angle", SETTING, lambda a: {PACE: -1.0, OFFSET: a}, mirrored, (0.0,),
                   guesses=START_ANGLES, usual=(0.0, *QUARTER_TURNS), unit=1.0 / RADIAN),
        Hypothesis("time shift", SETTING, lambda t: {SHIFT: t},
                   lambda t: f"the file's clock is {abs(t):.4g} s {'behind' if t > 0.0 else 'ahead'}",
                   (0.0,), (turn,), [k * turn / 8.0 for k in (0, 1, -1, 2, -2, 3, -3)], unit=1.0),
        _certain("no acceleration", SETTING, {ORDER: 1},
                 "the crank's acceleration is left out: torque and forces are those of a constant speed"),
    )  # fmt: skip
    if column is None:
        yield from _of_regime(motion, start)


def wrap_angle(angle: float) -> float:
    """An angle, rad, within [−π, π): whole turns taken away."""
    return (float(angle) + math.pi) % FULL_TURN - math.pi


def _of_regime(motion: Any, start: float) -> Iterator[Hypothesis]:  # noqa: ANN401 - a DriverMotion, narrowed
    """Yield faults of a stated regime: another speed, another ramp, another time of the ramp.

    ``motion`` is a DriverMotion, ``start`` its angle at t = 0, rad. Ramps only of a run-up and of a constant speed.
    """
    rpm, turned_by = motion.peak_speed / RPM, abs(float(motion.angle(motion.duration)) - start)
    paces = np.linspace(0.5, 1.5, int(min(max(turned_by / PHASE_CAPTURE, 9.0), MOST_PACES)))
    yield Hypothesis("speed", SETTING, lambda k: {PACE: k, OFFSET: start * (1.0 - k)},
                     lambda k: f"the crank's speed is {k * rpm:.4g} rpm in place of {rpm:.4g} rpm", (1.0,),
                     guesses=[1.0, *paces.tolist()], unit=1.0 / rpm if rpm else 0.0)  # fmt: skip
    if not isinstance(motion, CrankMotion) or motion.regime not in (*RAMPS, "constant-speed"):
        return
    speed = float(motion.speed(motion.duration))
    ramp = motion.segments[0].end if motion.regime in RAMPS else 0.6 * motion.duration

    def similar(name: str, ramp: float) -> Values:
        """The changed motion: the regime of this name, with the old one's length and end speed and this ramp time, s.

        The time is limited to SHORTEST_RAMP and the motion's duration.
        """
        ramp = min(max(abs(ramp), SHORTEST_RAMP), motion.duration)
        return {MOTION: crank_motion(name, speed=abs(speed), ramp_time=ramp, hold_time=motion.duration - ramp,
                                     clockwise=speed < 0.0, start_angle=start)}  # fmt: skip

    for name in (*RAMPS, "constant-speed"):
        if name != motion.regime:
            words = f"the crank follows '{name}' in place of '{motion.regime}'"
            yield _certain(f"ramp:{name}", SETTING, similar(name, ramp), words)
    if motion.regime in RAMPS:
        yield Hypothesis("ramp time", SETTING, lambda time: similar(motion.regime, time),
                         lambda time: f"the crank runs up in {time:.4g} s in place of {ramp:.4g} s", (ramp,), (ramp,),
                         [ramp, *(motion.duration * np.linspace(0.02, 1.0, 50)).tolist()], unit=1.0)  # fmt: skip


# The model: gravity, assembly modes, joints and loads, then every number of the linkage's file.


def of_model(simulation: Simulation) -> Iterator[Hypothesis]:
    """Yield every fault of the model except those of its motion: settings first, then numbers."""
    linkage = simulation.linkage
    yield from _of_gravity(linkage)
    yield from _of_modes(simulation)
    yield from _of_joints(simulation)
    yield from _of_friction(linkage)
    yield from _of_loads(linkage)
    for name, number in named_numbers(linkage).items():
        yield from _of_number(linkage, name, number)
    yield from _of_several_numbers(linkage)


def _of_gravity(linkage: Linkage) -> Iterator[Hypothesis]:
    """Yield gravity of another size along the file's direction, if it has one, and gravity of any direction.

    Nothing without masses.
    """
    (x, y), size = linkage.gravity, math.hypot(*linkage.gravity)
    if not any(link.mass for link in linkage.links.values()):
        return

    def gravity(gx: float, gy: float) -> Values:
        """The changed values for this gravity, its components in m/s²."""
        return {"gravity.x": gx, "gravity.y": gy}

    def words(k: float) -> str:
        """The sentence that gravity is ``k`` times that of the file."""
        if abs(k) < 1e-9:
            return "gravity is off"
        if math.isclose(k, -1.0):
            return "gravity points the other way"
        return f"gravity is {k * size:.4g} m/s² in place of {size:.4g} m/s²"

    def pointing(gx: float, gy: float) -> str:
        """The sentence that gravity is another vector, m/s²."""
        return f"gravity is ({fixed(gx, 3)}, {fixed(gy, 3)}) m/s² in place of ({x:zg}, {y:zg}) m/s²"

    if size:
        usual = (0.0, -1.0, *(g / size for g in (EARTH, 9.81, 9.8) if g != size), 2.0, 1e3, 1e-3)
        yield Hypothesis("gravity", SETTING, lambda k: gravity(k * x, k * y), words, (1.0,), usual=usual,
                         is_linear=True)  # fmt: skip
    quarter_turns = [rotate((x, y), turn) for turn in ((0.0, 1.0), (0.0, -1.0))]
    axes = [(0.0, -EARTH), (0.0, -9.81), (0.0, EARTH), (0.0, 9.81), (-EARTH, 0.0), (EARTH, 0.0)]
    yield Hypothesis("gravity's direction", SEVERAL, gravity, pointing, (x, y), (EARTH, EARTH),
                     usual=quarter_turns if size else axes, is_linear=True)  # fmt: skip


def _of_modes(simulation: Simulation) -> Iterator[Hypothesis]:
    """Yield for each group that has two modes, up to MOST_MODES, the fault that it is assembled in its other mode."""
    dyads = simulation.mechanism.structure.dyads
    for number, dyad in [(n, dyad) for n, dyad in enumerate(dyads) if dyad.has_two_modes][:MOST_MODES]:
        signs = tuple(-other.sign if n == number else other.sign for n, other in enumerate(dyads))
        words = f"{dyad.words} are assembled in their other mode"
        yield _certain(f"mode:{dyad.first}", SETTING, {MODES: signs}, words, is_slow=simulation.mechanism.is_numerical)


def _of_joints(simulation: Simulation) -> Iterator[Hypothesis]:
    """Yield for each link in a pin, but the pin's hub, that a rotary damper acts between both, where none does yet."""
    linkage = simulation.linkage
    inertia = sum((k.inertia or 0.0) + k.mass * linkage.extent() ** 2 for k in linkage.links.values())
    size = (inertia or 1.0) * (simulation.motion.peak_speed or 1.0)
    present = {frozenset(damper.links) for damper in linkage.dampers}
    pins = {frozenset((pin.hub, k)): (joint, pin.hub, k) for pin in linkage.pins for joint, k in pin.joints.items()}
    for at, *pair in (place for links, place in pins.items() if links not in present):

        def dampers(b: float, pair: Sequence[str] = pair) -> Values:
            """The changed dampers: those of the file and one of ``b``, N m s, between this pair."""
            return {(LINKAGE, "dampers"): (*linkage.dampers, RotaryDamper((pair[0], pair[1]), float(b)))}

        def words(b: float, at: str = at) -> str:
            """The sentence that a damper of ``b``, N m s, acts in the pin ``at``."""
            return f"a rotary damper of {b:.3g} N m s acts in the pin '{at}'"

        yield Hypothesis(f"damping:{at}", SEVERAL, dampers, words, (0.0,), (size,), is_linear=True)


def _of_friction(linkage: Linkage) -> Iterator[Hypothesis]:
    """Yield friction by a joint's own force: left out, or in joints that have none in the file, in one or in all."""
    if linkage.friction:
        words = "the friction of the linkage file is left out"
        yield _certain("no friction", SETTING, {(LINKAGE, "friction"): {}}, words)
    unit = factor("length", linkage.units.get("length", "m"))
    joints = {pin.point: unit for pin in linkage.pins}  # what its number is written in
    joints |= dict.fromkeys((*(slider.link for slider in linkage.sliders), *(slot.name for slot in linkage.slots)), 0.0)
    joints = {joint: unit for joint, unit in joints.items() if joint not in linkage.friction}

    def of(*names: str) -> dict[str, Any]:
        """The arguments of a Hypothesis, by name, for friction in the joints of these names, a number for each."""
        sizes = tuple(0.1 * linkage.shortest_length() if joints[name] else 0.1 for name in names)

        def friction(*numbers: float) -> Values:
            """The changed friction of the joints, by a number each: μ r, m, of a pin, else μ."""
            own = {
                name: JointFriction(float(x), float(joints[name] > 0.0)) for name, x in zip(names, numbers, strict=True)
            }
            return {(LINKAGE, "friction"): {**linkage.friction, **own}}

        def words(*numbers: float) -> str:
            """The sentence that names the joints with friction and its sizes; negligible numbers are left out."""
            found = [
                f"'{name}', μ r = {linkage.written(x)}" if joints[name] else f"'{name}', μ = {x:.3g}"
                for name, x, size in zip(names, numbers, sizes, strict=True)
                if x > NO_FRICTION * size
            ]
            return f"joint friction acts in {'; in '.join(found)}"

        return {"targets": friction, "words": words, "start": (0.0,) * len(names), "sizes": sizes}

    for name, size in joints.items():
        yield Hypothesis(f"friction:{name}", SEVERAL, **of(name), unit=size or 1.0, least=0.0)
    if len(joints) > 1:
        yield Hypothesis("friction", FREE, **of(*joints))


def _of_loads(linkage: Linkage) -> Iterator[Hypothesis]:
    """Yield faults of loads: all of a kind left out, or one at another point or on another link.

    A damper between two links may act on the ground.
    """
    for part in LOADS:
        if getattr(linkage, part):
            words = f"the {part} of the linkage file are left out"
            yield _certain(f"no {part}", SETTING, {(LINKAGE, part): EMPTY_PARTS[part]}, words)
    elsewhere: list[tuple[str, int, dict[str, Any], str, str]] = [
        *(("forces", n, {"point": p}, f"{force.point} at {p}", f"the force at '{force.point}' acts at '{p}'")
          for n, force in enumerate(linkage.forces) if force.link in linkage.links
          for p in linkage.links[force.link].points if p != force.point),
        *(("torques", n, {"link": link}, f"{torque.link} on {link}", f"the torque on '{torque.link}' acts on '{link}'")
          for n, torque in enumerate(linkage.torques) for link in linkage.links if link != torque.link),
        *(("dampers", n, {"links": (a, GROUND)}, f"{a}.{b} against the ground",
           f"the damper of '{a}' and '{b}' acts on the ground")
          for n, damper in enumerate(linkage.dampers) for a, b in [damper.links] if GROUND not in damper.links),
    ]  # fmt: skip
    for part, number, changes, name, words in elsewhere:
        loads = list(getattr(linkage, part))
        loads[number] = replace(loads[number], **changes)
        yield _certain(f"{part}.{name}", SETTING, {(LINKAGE, part): tuple(loads)}, words)


def _of_number(linkage: Linkage, name: str, number: Number) -> Iterator[Hypothesis]:
    """Yield another value of one number of the description, or a direction turned; nothing if it has no effect.

    Nothing for the sketch, for zeros that are no place, for numbers of long tables of loads and for the radius of
    friction. A direction is yielded with its x component alone.
    """
    kind, value, path = number.kind, number.value, number.path
    is_place, is_load = kind in (Kind.LENGTH, Kind.ACCELERATION), path[0] in LOADS
    if kind is Kind.DIRECTION:
        if name.endswith(".x"):
            yield _turned(linkage, name.removesuffix(".x"))
        return
    of_load = sum(other.path[:2] == path[:2] for other in named_numbers(linkage).values())
    if path[0] == "sketch" or not (value or is_place) or (path[0] in LOADS[:2] and of_load > MOST_LOAD_NUMBERS):
        return
    if path[0] == "friction" and kind is Kind.LENGTH:  # the radius: of its product the coefficient is the one in doubt
        return
    size = {Kind.LENGTH: linkage.shortest_length(), Kind.ACCELERATION: 9.81}.get(kind, abs(value))
    about = _inertias_about_points(linkage, str(path[1])) if kind is Kind.INERTIA else {}
    what, unit = _number_words(name, number), kind_unit(kind, linkage.units)

    def words(new: float) -> str:
        """The sentence that the number has a new value, SI, in place of the file's."""
        if not new and not is_place:
            return f"{what} is left out"
        at = next((point for place, point in about.items() if math.isclose(place, new, rel_tol=1e-9)), "")
        end = f": that about '{at}', not about the mass centre" if at else _slip_words(kind.si, value and new / value)
        now, old = (f"{x / unit.size:z.4g} {unit.name}".rstrip() for x in (new, value))
        return f"{what} is {now} in place of {old}{end}"

    usual = dict.fromkeys([*about, *(value * k for k in USUAL_FACTORS.get(kind, LOAD_FACTORS))])
    yield Hypothesis(name, NUMBER, lambda new: {name: new}, words, (value,), (size or 1.0,),
                     usual=[new for new in usual if new != value], unit=unit.size,
                     least=0.0 if kind in (Kind.MASS, Kind.INERTIA) else -math.inf,
                     is_slow=kind is Kind.LENGTH and "centre" not in path and not is_load,
                     is_linear=kind is not Kind.LENGTH)  # fmt: skip


def _number_words(name: str, number: Number) -> str:
    """The words for a number of the description: "the mass of 'rod'"; its ``name`` in quotes where there are none.

    A component's axis goes before: "x of 'B' on 'rod'".
    """
    part, *_, last = number.path
    form = NUMBER_WORDS.get((str(part), str(number.path[2]) if part == "links" else ""), "'{name}'")
    axis = "xy"[last] if isinstance(last, int) else ""
    return form.format(*number.path, name=name, axis=axis, guide=name.partition(".through")[0])


def _inertias_about_points(linkage: Linkage, name: str) -> dict[float, str]:
    """The names of a link's points, each by the link's moment of inertia about it, kg m².

    ``name`` is the link's. The mass centre's own is left out, and a massless link has none.
    """
    link = linkage.links[name]
    distances = {point: math.dist(at, link.centre) for point, at in link.points.items()}
    return {(link.inertia or 0.0) + link.mass * d**2: point for point, d in distances.items() if d and link.mass}


def _turned(linkage: Linkage, name: str) -> Hypothesis:
    """The hypothesis that the direction of this name, ``output.along``, is turned by an angle, rad."""
    known, of = named_numbers(linkage), name.removesuffix(".along")
    x, y = (known[f"{name}.{axis}"].value for axis in "xy")
    what = "the direction of the output" if of == "output" else f"the guide of '{of}'"

    def turned(angle: float) -> Values:
        """The changed components of the direction, turned by an angle, rad."""
        c, s = math.cos(angle), math.sin(angle)
        return {f"{name}.x": c * x - s * y, f"{name}.y": s * x + c * y}

    return Hypothesis(name, NUMBER, turned, lambda a: f"{what} is turned by {math.degrees(wrap_angle(a)):.3g}°", (0.0,),
                      unit=1.0 / RADIAN, is_slow=of != "output")  # fmt: skip


def _of_several_numbers(linkage: Linkage) -> Iterator[Hypothesis]:
    """Yield faults of several numbers: all of a kind, a distance, a mass centre, mass and inertia of a link, a load."""
    mass, inertia, length = Kind.MASS, Kind.INERTIA, Kind.LENGTH
    yield _multiplied(linkage, "every mass", "", (1e3, 1e-3), mass)
    yield _multiplied(linkage, "every moment of inertia", "", USUAL_FACTORS[inertia], inertia)
    yield _multiplied(linkage, "every mass and moment of inertia", "", (1e3, 1e-3, 0.45359237), mass, inertia)
    yield _multiplied(linkage, "every length", "", (1e3, 1e-3, 0.1, 10.0, 0.0254, 25.4), length)
    few = sum(len(link.points) for link in linkage.links.values()) <= MOST_POINTS
    for name, link in linkage.links.items():
        if link.mass:
            yield _other_centre(linkage, name)
        if link.mass and link.inertia:
            yield _multiplied(linkage, f"mass and inertia of '{name}' together", f"{name}.", (0.0,), mass, inertia)
        for fixed_point, moved in itertools.permutations(link.points, 2) if few else ():
            if all(a != b for a, b in zip(link.points[fixed_point], link.points[moved], strict=True)):
                yield _other_distance(linkage, name, fixed_point, moved)
    loads = (name.split(".") for name in named_numbers(linkage) if name.partition(".")[0] in LOADS[:2])
    for load in dict.fromkeys(".".join(parts[:2]) for parts in loads):
        yield _multiplied(linkage, f"the load '{load}'", load, LOAD_FACTORS, Kind.FORCE, Kind.TORQUE)


def _multiplied(linkage: Linkage, what: str, under: str, usual: Sequence[float], *kinds: Kind) -> Hypothesis:
    """The hypothesis that all numbers of some kinds, with names that begin with ``under``, have a common factor.

    ``what`` names them in words, and the hypothesis; ``usual`` are factors to try.
    """
    numbers = {
        label: number.value
        for label, number in named_numbers(linkage).items()
        if number.kind in kinds and label.startswith(under)
    }

    def words(k: float) -> str:
        """The sentence that the numbers are ``k`` times those of the file."""
        if abs(k) < 1e-9:
            return f"{what} is left out"
        return f"{what} is {k:.4g} times that of the linkage file{_slip_words(kinds[0].si, k)}"

    return Hypothesis(what, SEVERAL, lambda k: {label: k * value for label, value in numbers.items()}, words, (1.0,),
                      usual=usual, unit=1.0, least=-math.inf if under.startswith(LOADS) else 0.0,
                      is_slow=Kind.LENGTH in kinds, is_linear=Kind.LENGTH not in kinds)  # fmt: skip


def _other_distance(linkage: Linkage, name: str, fixed_point: str, moved: str) -> Hypothesis:
    """The hypothesis that a link's point ``moved`` is at another distance, m, from ``fixed_point``.

    Its direction from there stays. ``name`` is the link's.
    """
    (x, y), (px, py) = linkage.links[name].points[fixed_point], linkage.links[name].points[moved]
    length = math.dist((x, y), (px, py))

    def place(d: float) -> Values:
        """The changed coordinates of the moved point at a distance ``d``, m, from the fixed one."""
        return {f"{name}.{moved}.x": x + d / length * (px - x), f"{name}.{moved}.y": y + d / length * (py - y)}

    def words(d: float) -> str:
        """The sentence that the distance is ``d``, m, in place of the file's."""
        lengths = f"{linkage.written(d)} in place of {linkage.written(length)}"
        return f"the distance of '{moved}' from '{fixed_point}' on '{name}' is {lengths}"

    unit = factor("length", linkage.units.get("length", "m"))
    return Hypothesis(f"{name}.{fixed_point}-{moved}", NUMBER, place, words, (length,), (length,), unit=unit, least=0.0,
                      is_slow=True)  # fmt: skip


def _other_centre(linkage: Linkage, name: str) -> Hypothesis:
    """The hypothesis that a link's mass centre is elsewhere, x and y in m: at a usual wrong place, or anywhere."""
    link = linkage.links[name]
    (x, y), places, size = link.centre, list(link.points.values()), linkage.shortest_length()
    middle = (float(np.mean([p[0] for p in places])), float(np.mean([p[1] for p in places])))
    usual: list[Numbers] = [*places, middle, (-x, -y), (y, x), (0.0, 0.0), (1e3 * x, 1e3 * y), (1e-3 * x, 1e-3 * y)]
    if len(places) == 2:  # measured from the other end
        usual.append((places[0][0] + places[1][0] - x, places[0][1] + places[1][1] - y))

    def words(cx: float, cy: float) -> str:
        """The sentence that the mass centre is at (``cx``, ``cy``), m, in place of the file's."""
        new, old = (", ".join(linkage.written(v).rpartition(" ")[0] for v in at) for at in ((cx, cy), link.centre))
        unit = linkage.units.get("length", "m")
        return f"the mass centre of '{name}' is at ({new}) {unit} in place of ({old}), in the link's frame"

    return Hypothesis(f"{name}.centre", SEVERAL, lambda cx, cy: {f"{name}.centre.x": cx, f"{name}.centre.y": cy},
                      words, link.centre, (size, size),
                      usual=[*dict.fromkeys(p for p in usual if p != link.centre)])  # fmt: skip
