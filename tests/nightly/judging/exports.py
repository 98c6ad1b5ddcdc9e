"""Files as tools would export them, drawn by number: a linkage, a motion, faults planted, and one of ten layouts."""

from __future__ import annotations

import tomllib
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path

import numpy as np

from tests.comparisons.filejudge.layouts import (
    Channel,
    adams_results,
    adams_table,
    csv,
    modelica,
    robotran,
    solidworks,
    trajectory,
)
from tests.nightly.judging.multibody import AssemblyError, Multibody
from tests.nightly.judging.planting import DEGREE, RPM, Plan, Turning, pick, planted, planted_in_two, unit_kind

ROOT, OWN = Path(__file__).parents[3], Path(__file__).parent
CATALOGUE, FOREIGN = ROOT / "analytic/catalogue", ROOT / "tests/comparisons/filejudge/foreign"
LINKAGES = (
    *(CATALOGUE / f"{name}.toml" for name in (
        "juki-mf7923d", "rimoldi-164", "slotted-takeup", "two-crank-takeup", "fork-takeup",
        "literature/whitworth-quick-return",
    )),
    FOREIGN / "four-bar.toml", FOREIGN / "slider-crank.toml", OWN / "loaded.toml", OWN / "slot.toml",
)  # fmt: skip
PARTS = ("title", "units", "crank", "gravity", "output", "forces", "torques", "springs", "dampers", "slots", "ground",
         "links", "sketch")  # fmt: skip
VISIBLE = 0.02  # of a signal's peak: what a planted fault changes at least
ATTEMPTS = 200
LAYOUTS = ("csv", "german", "solidworks", "tab", "res", "modelica", "robotran", "tsv", "mat", "blanks")
ENDINGS = {"tab": "tab", "res": "res", "robotran": "res", "mat": "mat", "tsv": "txt", "blanks": "txt"}  # else csv
IN_SI = ("modelica", "robotran", "mat")  # layouts without units
PRINTED = {  # of a signal's kind: header's unit and its SI value, in either style
    "angle": (("deg", DEGREE), ("rad", 1.0)), "omega": (("deg/s", DEGREE), ("rad/s", 1.0)),
    "Mkr": (("N*m", 1.0), ("N*mm", 1e-3)), "force": (("N", 1.0), ("N", 1.0)), "length": (("mm", 1e-3), ("m", 1.0)),
    "v": (("mm/s", 1e-3), ("m/s", 1.0)), "a": (("mm/s^2", 1e-3), ("m/s^2", 1.0)), "time": (("s", 1.0), ("s", 1.0)),
}  # fmt: skip
WORDS = {"N*m": "newton-meter", "N*mm": "newton-mm", "N": "newton", "deg/s": "deg/sec", "rad/s": "rad/sec",
         "mm/s": "mm/sec", "mm/s^2": "mm/sec**2", "m/s": "meter/sec", "m/s^2": "meter/sec**2", "s": "sec"}  # fmt: skip
TITLES = {
    "german": {"phi": "Kurbelwinkel", "omega": "Kurbeldrehzahl", "Mkr": "Antriebsmoment", "time": "Zeit"},
    **{layout: {"phi": "motor.phi", "omega": "motor.w", "Mkr": "motor.tau"} for layout in IN_SI},
}
NAMES = {"phi": "Crank angle", "omega": "Motor speed", "Mkr": "Motor torque", "time": "Time"}


@dataclass(frozen=True)
class Exported:
    """A file as a tool would write it, and what a user would say of it.

    ``linkage`` is the true linkage's file, ``faulty`` that of the simulation. ``stated`` is the motion where no column
    gives it; ``back`` has the linkage's own names by those it was renamed to.
    """

    linkage: str
    faulty: str
    plans: tuple[Plan, ...]
    stated: Turning | None
    text: str | bytes
    mapping: tuple[str, ...]
    layout: str
    back: Mapping[str, str]


@cache
def linkage(number):
    """A linkage's file as plain data, without what is no part of it."""
    raw = tomllib.loads(LINKAGES[number].read_text())
    return {part: raw[part] for part in PARTS if part in raw}


@cache
def simulation(number):
    return Multibody(linkage(number))


def dumped(data):
    """The file of plain data."""
    return "\n".join(f"{key} = {_inline(value)}" for key, value in data.items()) + "\n"


def _inline(value):
    if isinstance(value, Mapping):
        return "{ " + ", ".join(f'"{k}" = {_inline(v)}' for k, v in value.items()) + " }"
    if isinstance(value, list | tuple):
        return "[" + ", ".join(map(_inline, value)) + "]"
    return f'"{value}"' if isinstance(value, str) else repr(float(value))


def renamed(random, data):
    """The same linkage with other names of points and links, and in another order."""
    links = data["links"].values()
    names = [*data["links"], *data["ground"], *(p for k in links for p in k.get("points", ()))]
    names = dict.fromkeys([*names, *(k["slides"]["point"] for k in links if "slides" in k)])
    letters = random.permutation([*"BCDFGHJKLMNPRSTVWZbcdfghjklmnprstvwz"])
    new = {old: f"{letters[n]}a{letters[-n - 1]}q{n}" for n, old in enumerate(names)}

    def walk(value, under=""):
        if isinstance(value, Mapping):
            items = [(new[k] if under in ("ground", "links", "points") else k, walk(v, k)) for k, v in value.items()]
            return dict(items[place] for place in random.permutation(len(items)))
        if isinstance(value, list):
            return [walk(one) for one in value]
        return new.get(value, value) if isinstance(value, str) else value

    return {k: data[k] for k in ("title", "units")} | walk(
        {k: data[k] for k in data if k not in ("title", "units")}
    ), new


def _as_renamed(signal, new, bodies):
    """A signal's name, and -1 where a moving pin's force is then that on the other link, the first by name."""
    kind, *parts = signal.split(":")
    side = 1.0
    for name, joint, body, host, _ in bodies.joints:
        if kind == "joint_force" and parts[0] == name and joint == "pin" and host != "ground":
            side = 1.0 if new[host] < new[body] else -1.0
    return ":".join([kind, *(new.get(part, part) for part in parts)]), side


def title(name, layout):
    """What a tool would call a signal."""
    kind, *part = name.split(":")
    is_dotted = layout in ("modelica", "mat", "res")
    if kind == "joint_force":
        dotted = f"{part[0]}.{'F' if layout == 'res' else 'reaction_force_'}{part[1].upper()}"
        return dotted if is_dotted else f"Reaction Force {part[0]} {part[1].upper()}"
    if kind == "link" and layout in ("modelica", "mat"):
        return f"{part[0]}.{'phi' if part[1] == 'angle' else 'w'}"
    if kind == "link":
        return f"Angular {'Displacement' if part[1] == 'angle' else 'Velocity'} {part[0]}"
    return {**NAMES, **TITLES.get(layout, {})}.get(name, name)


def written(layout, digits, curves, style):
    """The file's text, and what its columns are where the layout says no names."""
    rounded = curves["time"] if layout == "mat" else np.array([float(f"{t:.10g}") for t in curves["time"]])
    units = {n: (("", 1.0) if layout in IN_SI else PRINTED[unit_kind(n)][style]) for n in curves}
    found = [
        Channel(title(n, layout), units[n][0], (rounded if n == "time" else y) / units[n][1]) for n, y in curves.items()
    ]
    mapped, wordy = {}, [replace(c, unit=WORDS.get(c.unit, c.unit)) for c in found]
    match layout:
        case "csv":
            text = csv(found, digits=digits, quotes=bool(style))
        case "german":
            text = csv(found, digits=digits, delimiter=";", decimal=",")
        case "tsv":
            text = csv(found, digits=digits, delimiter="\t", unit_row=True)
        case "blanks":
            text = csv([replace(c, header=c.header.replace(" ", "_")) for c in found], digits=digits, delimiter="  ")
        case "solidworks":
            text = solidworks([(c.header, [wordy[0], c]) for c in wordy[1:]], digits=digits)
        case "modelica":
            text = modelica([replace(found[0], header="time"), *found[1:]], digits=digits)
        case "mat":
            named = [replace(found[0], header="time"), *found[1:]]
            text = trajectory(named, transposed=bool(style), kind=np.float32 if style else np.float64)
        case "res":
            wordy = [replace(c, header=c.header if "." in c.header else f"{c.header}.Q") for c in wordy]
            text = adams_results([replace(wordy[0], header="TIME"), *wordy[1:]], digits=digits)
            mapped = dict(zip([c.header for c in wordy[1:]], list(curves)[1:], strict=True))
        case "tab":
            text, mapped = (
                adams_table(found, decimals=digits),
                {c.header: n for c, n in zip(found, curves, strict=True)},
            )
        case _:
            text, mapped = robotran(found, digits=digits - 1), {f"column {k}": n for k, n in enumerate(curves, start=1)}
    unit_names = {
        n: PRINTED[unit_kind(n)][0 if n == "Mkr" else 1][0] if layout in IN_SI else units[n][0] for n in curves
    }
    return text, tuple(f"{h}={n}" + (f" [{unit_names[n]}]" if layout != "res" else "") for h, n in mapped.items())


def case(seed, number, faults, *, rename=False):
    """The export of a number: clean, with one fault that changes a signal visibly, or with faults of two columns."""
    for attempt in range(ATTEMPTS):
        random = np.random.default_rng([seed, number, faults, attempt])
        try:
            return _case(random, number, faults, rename=rename)
        except AssemblyError:
            continue
    raise RuntimeError(f"no visible fault of number {number}")


def _motion(random):
    law = str(pick(random, ("constant-speed", "constant-speed", "run-up", "run-up-quintic")))
    speed = float(pick(random, (60, 120, 200, 300, 480, 600, 750))) * RPM
    ramp = float(f"{2.0 * np.pi / speed:.2g}")
    duration = random.uniform(1.1, 2.5) * 2.0 * np.pi / speed + (0.5 * ramp if law != "constant-speed" else 0.0)
    way = pick(random, (1.0, 1.0, 1.0, -1.0))
    return Turning(law, way * speed, round(random.uniform(0, 360)) * DEGREE, ramp, float(f"{duration:.2g}"))


def _case(random, number, faults, *, rename):
    """Raises AssemblyError where the faults drawn cannot be or are not seen."""
    which = number % len(LINKAGES)
    file, bodies = linkage(which), simulation(which)
    layout, digits = LAYOUTS[(number // len(LINKAGES)) % len(LAYOUTS)], int(random.integers(4, 8))
    style, motion, by = int(random.integers(2)), _motion(random), str(pick(random, ("phi", "phi", "omega", "")))
    motion = replace(motion, start=0.0) if by == "omega" else motion
    pins = [name for name, kind, *_ in bodies.joints if kind == "pin" and ":" not in name]
    link = pick(random, [n for n in file["links"] if n != file["crank"] and "slides" not in file["links"][n]])
    pool = ["S", "v", "a", f"link:{link}:angle", f"link:{link}:omega"]
    pool += [f"joint_force:{pick(random, pins)}:{axis}" for axis in "xy"]
    others = map(str, random.permutation(pool)[: int(random.integers(1, 4))])
    signals = [*([by] if by else []), "Mkr", *others]
    plans = [Plan(file, motion)]
    unit = {n: 1.0 if layout in IN_SI else PRINTED[unit_kind(n)][style][1] for n in signals}.__getitem__
    if faults == 1:
        plans.append(planted(random, plans[-1], signals, by, unit))
    if faults == 2:
        plans += planted_in_two(random, plans[-1], signals, by, unit)
    plan, time = plans[-1], np.linspace(0.0, motion.duration, int(pick(random, (181, 241, 361, 501))))
    is_same = plan.file is file and not plan.branch
    simulated = bodies if is_same else Multibody(plan.file, plan.branch)
    right, wrong = bodies.curves(time, motion), simulated.curves(time, plan.motion)
    curves = {"time": time, **{n: wrong[n] for n in signals}}
    for alter in plan.alter:
        curves = alter(curves, lambda times: simulated.curves(times, plan.motion))
    seen = any(np.max(np.abs(curves[n] - right[n])) > VISIBLE * np.max(np.abs(right[n])) for n in signals)
    if faults and not seen and np.array_equal(curves["time"], time):
        raise AssemblyError("not seen")
    new = {}
    if rename:
        file, new = renamed(random, file)
        names = {n: _as_renamed(n, new, bodies) for n in curves}
        curves = {names[n][0]: names[n][1] * y for n, y in curves.items()}
    text, mapping = written(layout, digits, curves, style)
    back = {name: old for old, name in new.items()}
    return Exported(
        dumped(file), dumped(plan.file), tuple(plans[1:]), None if by else motion, text, mapping, layout, back
    )
