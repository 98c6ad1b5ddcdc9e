"""Faults drawn at random: in a linkage's file, in the crank's motion, in the columns of a result file."""

from __future__ import annotations

import copy
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from tests.nightly.judging.multibody import AssemblyError

RPM, DEGREE = np.pi / 30.0, np.pi / 180.0
LAWS = ("run-up", "run-up-cubic", "run-up-quintic")


@dataclass(frozen=True)
class Turning:
    """The crank from a start angle to a speed in a ramp's time, or at once: rad, s."""

    law: str
    speed: float
    start: float
    ramp: float
    duration: float

    def __call__(self, time):
        """Angle, speed and acceleration (n,), rad, s."""
        if self.law == "constant-speed":
            return self.start + self.speed * time, np.full(len(time), self.speed), np.zeros(len(time))
        x, late = np.clip(time / self.ramp, 0.0, 1.0), np.maximum(time - self.ramp, 0.0)
        angle, speed, acceleration = {
            "run-up": (x**2 / 2, x, np.where((x < 1.0) & (time >= 0.0), 1.0, 0.0)),
            "run-up-cubic": (x**3 - x**4 / 2, 3 * x**2 - 2 * x**3, 6 * x - 6 * x**2),
            "run-up-quintic": (2.5 * x**4 - 3 * x**5 + x**6, 10 * x**3 - 15 * x**4 + 6 * x**5, 30 * (x - x**2) ** 2),
        }[self.law]
        turned = self.start + self.speed * (self.ramp * angle + late)
        return turned, self.speed * speed, self.speed * acceleration / self.ramp


UNITS = {  # SI values of the units that a column of a kind may be in, whatever its header says
    "angle": (1.0, DEGREE), "omega": (1.0, DEGREE, RPM, 2.0 * np.pi), "Mkr": (1.0, 1e-3, 0.1129848290276),
    "force": (1.0, 1e3, 1e-3, 9.80665, 4.4482216153), "length": (1.0, 1e-3, 0.0254),
}  # fmt: skip
INERTIA = {"kg*m^2": 1.0, "kg*mm^2": 1e-6, "g*mm^2": 1e-9, "kg": 1.0, "g": 1e-3, "m": 1.0, "mm": 1e-3}


@dataclass(frozen=True)
class Plan:
    """The simulated linkage, its assembly, and the changes of its curves.

    ``names`` are those of the faults that are right; without them it is the one that makes the same linkage. Each of
    ``alter`` makes curves, the ``time`` among them, of curves and of what the simulation has at other times.
    """

    file: Mapping[str, Any]
    motion: Turning
    kind: str = ""
    names: tuple[str, ...] = ()
    branch: int = 0
    alter: tuple[Any, ...] = ()


def pick(random, values):
    values = list(values)
    if not values:
        raise AssemblyError("nothing of the kind")
    return values[int(random.integers(len(values)))]


def size(random, low=0.02, high=0.5):
    """A relative change, of either sign."""
    return float(np.exp(random.uniform(np.log(low), np.log(high))) * random.choice([-1.0, 1.0]))


def planted(random, plan, signals, by, unit):
    """One more fault: of the model, of the motion where a user states it, or of columns.

    ``by`` is the column that gives the crank's motion, or ""; ``unit`` the SI value of a header's unit by signal.
    """
    place = random.random()
    if place < 0.55:
        kind = str(pick(random, (*MODEL, "assembly")))
        if kind == "assembly":
            return replace(plan, kind=kind, names=("mode:",), branch=1)
        file = model_fault(random, plan.file, kind)
        moved = [
            (a["point"], b["point"]) for a, b in zip(plan.file.get("forces", ()), file.get("forces", ()), strict=False)
        ]
        names = tuple(f"forces.{old} at {new}" for old, new in moved if old != new)
        return replace(plan, kind=kind, names=names, file=file)
    if place < 0.65 and not by:
        return replace(plan, **motion_fault(random, plan.motion))
    kinds = curve_faults(random, signals, by, unit)
    kind = str(pick(random, kinds))
    names, change = kinds[kind]
    return replace(plan, kind=kind, names=names, alter=(*plan.alter, change))


def planted_in_two(random, plan, signals, by, unit):
    """Faults of two columns, of different kinds: the plan with the first, and with both."""
    plans, kinds = [plan], random.permutation(["sign", "unit", "flipped samples", "late column"])
    for name, kind in zip(random.permutation([n for n in signals if n != by])[:2], kinds, strict=False):
        if kind == "unit" and unit_kind(name) not in UNITS:
            raise AssemblyError("no other unit")
        names, change = torque_faults(random, unit, one=str(name), torque=str(name))[kind]
        plans.append(replace(plan, kind=str(kind), names=names, alter=(*plans[-1].alter, change)))
    return plans[1:]


# Of a number's old value, a random factor and the linkage's smallest length.
CHANGES = {
    "factor": lambda random, x: _times(x, 1.0 + size(random)),
    "round": lambda random, x: _times(x, pick(random, (0.5, 0.8, 0.9, 1.1, 1.2, 1.5, 2.0))),
    "unit": lambda random, x: _times(x, pick(random, (1e3, 1e-3))),
    "mm²": lambda random, x: _times(x, pick(random, (1e3, 1e6))),
    "none": lambda _, x: _times(x, 0.0),
    "twice": lambda _, x: _times(x, 2.0),
    "other way": lambda _, x: _times(x, -1.0),
    "turned": lambda random, x: pick(random, ([x[1], x[0]], [-x[1], x[0]])),
    "longer": lambda random, x: [float(f"{(1.0 + 0.2 * k) * c:.3g}") for k in [size(random)] for c in x],
    "tenth": lambda _, x: 0.9 * x,
}
# By its kind, which numbers a fault of the model changes, and how: one of them, or every one alike.
MODEL = {
    "a mass": ("mass", "factor"), "a round mass": ("mass", "round"), "no mass": ("mass", "none"),
    "g for kg": ("mass", "unit"), "an inertia": ("inertia", "factor"), "a round inertia": ("inertia", "round"),
    "inertia's unit": ("inertia", "mm²"), "inertia about a pin": ("inertia", "about a pin"),
    "centre": ("centre", "shifted"), "centre other way": ("centre", "other way"), "a length": ("points", "longer"),
    "a point": ("points", "shifted"), "ground": ("ground", "shifted"), "guide": ("through", "shifted"),
    "every mass": ("every mass", "unit"), "every inertia": ("every inertia", "mm²"),
    "no inertia": ("every inertia", "none"), "every length": ("lengths", ""), "gravity off": ("gravity", "none"),
    "gravity up": ("gravity", "other way"), "gravity doubled": ("gravity", "twice"),
    "gravity turned": ("gravity", "turned"), "a load": ("load", "factor"), "load's sign": ("push", "other way"),
    "load's unit": ("load", "unit"), "free length": ("spring", "tenth"), "no loads": ("part", "dropped"),
    "wrong point": ("forces", "elsewhere"),
}  # fmt: skip


def model_fault(random, file, kind):
    """The linkage's file with a fault; raises AssemblyError where it has nothing of the kind."""
    what, how = MODEL[kind]
    if what == "lengths":
        k, parts = pick(random, (25.4, 10.0, 1e3)), ("ground", "links", "sketch", "slots", "springs")
        return {part: _longer(value, k) if part in parts else value for part, value in file.items()}
    if what == "part":
        part = pick(random, [part for part in LOADS if file.get(part)])
        return {key: value for key, value in file.items() if key != part}
    places = _places(file, what.removeprefix("every "))
    new, chosen = copy.deepcopy(dict(file)), places if what.startswith("every") else [pick(random, places)]
    seed = int(random.integers(2**31))  # of every number the same
    for *path, key in chosen:
        at = new
        for step in path:
            at = at[step]
        again = np.random.default_rng(seed)
        if how == "shifted":
            at[key] = _shifted(again, at.get(key, (0.0, 0.0)), file)
        elif how == "about a pin":
            squared = float(np.hypot(*pick(again, [at["centre"]] if _is_place(at.get("centre")) else [])) ** 2)
            scale = INERTIA[file["units"]["mass"]] * INERTIA[file["units"]["length"]] ** 2
            at[key] += pick(again, [at["mass"]]) * squared * scale / INERTIA[file["units"]["inertia"]]
        elif how == "elsewhere":
            points = file["links"][at[key]["link"]].get("points", {})
            at[key]["point"] = pick(again, [point for point in points if point != at[key]["point"]])
        else:
            at[key] = CHANGES[how](again, at[key])
    if new == file:
        raise AssemblyError("no change")
    return new


LOADS = {"forces": "force", "torques": "torque", "springs": "stiffness", "dampers": "coefficient"}


def _is_place(value):
    return isinstance(value, list | tuple) and any(value)


def _places(file, what):
    """The paths of all numbers of a kind."""
    links = file["links"]
    of_links = {
        "mass": [("links", name, "mass") for name, link in links.items() if link.get("mass")],
        "inertia": [("links", name, "inertia") for name, link in links.items() if link.get("inertia")],
        "centre": [("links", n, "centre") for n, k in links.items() if k.get("mass") and _is_place(k.get("centre"))],
        "points": [("links", n, "points", p) for n, k in links.items() for p, at in k.get("points", {}).items()
                   if _is_place(at)],
        "through": [("links", name, "slides", "through") for name, link in links.items() if "slides" in link],
        "ground": [("ground", point) for point, at in file["ground"].items() if any(at)],
        "gravity": [("gravity",)] if any(file.get("gravity", ())) else [],
        "load": [(part, n, key) for part, key in LOADS.items() for n in range(len(file.get(part, ())))],
        "push": [(part, n, LOADS[part]) for part in ("forces", "torques") for n in range(len(file.get(part, ())))],
        "spring": [("springs", n, "length") for n in range(len(file.get("springs", ())))],
        "forces": [("forces", n) for n in range(len(file.get("forces", ())))],
    }  # fmt: skip
    return of_links[what]


def _times(value, k):
    return [float(k * x) for x in value] if isinstance(value, list | tuple) else k * value


def _shifted(random, at, file):
    """A place moved along x or y by a part of the linkage's smallest length."""
    sizes = [np.hypot(*p) for k in file["links"].values() for p in k.get("points", {}).values() if _is_place(p)]
    at, axis = list(map(float, at)), int(random.integers(2))
    at[axis] = float(f"{at[axis] + 0.2 * size(random) * min(sizes):.3g}")
    return at


NO_LENGTHS = ("along", "angle", "mass", "inertia", "stiffness", "damping")


def _longer(value, k):
    """A description with every length times a factor."""
    if isinstance(value, Mapping):
        return {name: v if name in NO_LENGTHS else _longer(v, k) for name, v in value.items()}
    if isinstance(value, list):
        return [_longer(one, k) for one in value]
    return value if isinstance(value, str) else k * value


def motion_fault(random, motion):
    """A wrong statement of a user about the motion."""
    change = size(random, 0.02, 0.2)
    start = motion.start + float(pick(random, (90.0, 180.0, 25.0, 8.0))) * DEGREE
    found = {
        "direction": ("direction", {"speed": -motion.speed}),
        "start": ("start angle", {"start": start}),
        "speed": ("speed", {"speed": round(motion.speed / RPM * (1.0 + change)) * RPM}),
    }
    if motion.law in LAWS:
        other = str(pick(random, [law for law in LAWS if law != motion.law]))
        found["ramp"] = (f"ramp:{other}", {"law": other})
        found["ramp time"] = ("ramp time", {"ramp": float(f"{motion.ramp * (1.0 + change):.2g}")})
    kind = str(pick(random, found))
    name, changes = found[kind]
    return {"kind": kind, "names": (name,), "motion": replace(motion, **changes)}


def is_rotary(name):
    return name in ("phi", "omega", "Mkr") or name.startswith("link:")


def unit_kind(name):
    """The kind of a signal's unit."""
    if name == "phi" or name.endswith(":angle"):
        return "angle"
    if name == "omega" or name.endswith(":omega"):
        return "omega"
    return "force" if name.startswith("joint_force") else {"S": "length"}.get(name, name)


def of(names, change):
    """A change of the values of some columns."""
    return lambda curves, _: {n: change(y) if n in names else y for n, y in curves.items()}


def single(places, factor):
    """Single samples, at these shares of the column, times a factor."""
    return lambda y: np.where(np.isin(np.arange(len(y)), (places * len(y)).astype(int)), factor * y, y)


def late(names, steps):
    """Columns so many samples behind the others."""

    def change(curves, simulated):
        time = curves["time"]
        return {**curves, **{n: simulated(time - steps * (time[1] - time[0]))[n] for n in names}}

    return change


def shifted_clock(steps):
    """The column of time so many samples ahead."""
    return lambda curves, _: {**curves, "time": curves["time"] + steps * (curves["time"][1] - curves["time"][0])}


def other_unit(random, name, unit):
    """A column in another unit than its header's."""
    true = pick(random, [k for k in UNITS[unit_kind(name)] if k != unit(name)])
    return of((name,), lambda y: y * unit(name) / true)


def curve_faults(random, signals, by, unit):
    """Faults of columns by kind: their names, and the change of the curves."""
    judged = [name for name in signals if name != by]
    one, torque = pick(random, judged), pick(random, [s for s in judged if s.startswith(("Mkr", "joint"))] or judged)
    faults = torque_faults(random, unit, one=one, torque=torque)
    if "S" in judged:
        faults["inch"] = (("unit:S",), other_unit(random, "S", unit))
        faults["other dead centre"] = (("counted back:S",), of(("S",), lambda y: np.max(y) - y))
        faults["zero of S"] = (("offset:S",), of(("S",), lambda y: y + 0.3 * np.max(y)))
    for link in [s for s in judged if s.startswith("link:")][:1]:
        faults["link's unit"] = ((f"unit:{link}",), other_unit(random, link, unit))
    rotary = [name for name in judged if is_rotary(name)]
    if by:
        return faults | crank_faults(random, judged, rotary, by, unit)
    faults["clock"] = (("time shift",), shifted_clock(7.0))
    if len(rotary) > 1:
        faults["rotary columns"] = (("sign of rotary",), of(rotary, np.negative))
    return faults


def torque_faults(random, unit, *, one, torque):
    """Faults of ``one`` column, and of a column of a torque or force."""
    few = random.uniform(0.02, 0.98, 3)
    has_units = unit_kind(torque) in UNITS
    return {
        "sign": ((f"sign:{one}", f"counted back:{one}"), of((one,), np.negative)),
        "unit": ((f"unit:{torque}",), other_unit(random, torque, unit) if has_units else of((), np.negative)),
        "flipped samples": ((f"stray samples:{torque}",), of((torque,), single(few, -1.0))),
        "zero samples": ((f"stray samples:{torque}",), of((torque,), single(few, 0.0))),
        "late column": ((f"delay:{one}",), late((one,), 1)),
    }  # fmt: skip


def crank_faults(random, judged, rotary, by, unit):
    """Faults of the column that gives the crank's motion."""
    zero = float(pick(random, (90.0, -90.0, 180.0, 30.0, 17.0, -40.0))) * DEGREE
    faults = {
        "clock": (("time shift",), late(judged, 3)),
        "mirrored": (("direction", "mirrored angle"), of((by,), np.negative)),
        "unit of the crank": ((f"unit:{by}",), other_unit(random, by, unit)),
    }
    if by == "phi":
        faults["zero of the crank"] = (("start angle",), of(("phi",), lambda y: y + zero))
        faults["axis mirrored"] = (("view from behind",), of([*rotary, "phi"], np.negative))
    return faults
