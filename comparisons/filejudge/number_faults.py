"""Every number of a linkage's description as a fault: another mass, length, direction, load; and several at once."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import partial
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from analytic.description.changes import changed, multiplied, named_numbers
from analytic.description.law import Law
from analytic.description.linkage import GROUND, LOADS, Link, Linkage
from analytic.description.units import Kind, factor
from analytic.description.walk import Number
from analytic.description.written import kind_unit
from analytic.errors import LinkproofError
from comparisons.filejudge import fault
from comparisons.filejudge.fault import Fault, Numbers, Simulation

Array = NDArray[np.float64]

UNITS: Final = (1e3, 1e-3)  # a unit taken for another
# What is written in place of a number, as its multiples.
USUAL_FACTORS: Final[dict[Kind, tuple[float, ...]]] = {
    Kind.MASS: (0.0, *UNITS),
    Kind.INERTIA: (0.0, *UNITS, 1e6, 1e-6),
    Kind.LENGTH: (-1.0,),
    Kind.ACCELERATION: (0.0, -1.0),
}
LOAD_FACTORS: Final = (0.0, -1.0, *UNITS)  # multiples of a load
MOST_LOAD_NUMBERS: Final = 8  # of one load: of a longer table no number is a fault of its own
MOST_POINTS: Final = 60  # of a linkage whose distances are tried one by one


def number_faults(linkage: Linkage) -> Iterator[Fault]:
    """Faults of one number each: that number alone is wrong in the linkage; numbers without effect are left out."""
    every = named_numbers(linkage)
    for name, number in every.items():
        if number.path[0] == "sketch" or (not number.value and number.kind not in ("length", "acceleration")):
            continue
        if number.kind == "direction":
            if name.endswith(".x"):
                yield _direction_fault(linkage, name.removesuffix(".x"))
        elif number.path[0] not in LOADS[:2] or _count_of_load(every, number) <= MOST_LOAD_NUMBERS:
            yield _number_fault(linkage, name, number)


def _count_of_load(every: dict[str, Number], number: Number) -> int:
    """How many numbers the load of a number has."""
    return sum(other.path[:2] == number.path[:2] for other in every.values())


def number_change(name: str) -> Callable[[Simulation, Array], Simulation]:
    """The change that gives a number of the description another value."""

    def apply(simulation: Simulation, value: Array) -> Simulation:
        if named_numbers(simulation.linkage)[name].kind in ("mass", "inertia"):
            check_positive(value)
        return _replace_numbers(simulation, {name: float(value[0])})

    return apply


def _replace_numbers(simulation: Simulation, values: dict[str, float]) -> Simulation:
    """A simulation with other numbers by name, and nothing that goes with them.

    Raises LinkproofError for two points of a link in one place.
    """
    linkage = changed(simulation.linkage, lambda name, _, value: values.get(name, value))
    for name, link in linkage.links.items():
        if len({*link.points.values()}) < len({*simulation.linkage.links[name].points.values()}):
            raise LinkproofError(f"points of '{name}': expected different places, got one twice")
    return simulation.with_linkage(linkage)


def check_positive(k: Array) -> float:
    """The single number k[0], a factor or a mass; raises LinkproofError for a negative one."""
    if k[0] < 0.0:
        raise LinkproofError(f"factor: expected no negative number, got {k[0]:g}")
    return float(k[0])


def in_file_unit(linkage: Linkage, kind: Kind, value: float) -> str:
    """A number for a reader, in the unit of the linkage's file."""
    unit = linkage.units.get(kind, kind.si)
    scale = factor(kind, unit) if kind in linkage.units else 1.0
    return f"{value / scale:z.4g} {unit}"


def _number_fault(linkage: Linkage, name: str, number: Number) -> Fault:
    """The fault that one number of the description has another value."""
    kind, value = number.kind, number.value
    size = {"length": linkage.shortest_length(), "acceleration": 9.81}.get(kind, abs(value))
    usual = [value * k for k in USUAL_FACTORS.get(kind, LOAD_FACTORS)]
    about = _inertias_about_points(linkage.links[str(number.path[1])]) if kind == "inertia" else {}
    what = _number_words(name, number)

    def words(new: Array) -> str:
        if not new[0] and kind not in ("length", "acceleration"):
            return f"{what} is left out"
        is_unit = value and any(math.isclose(new[0], value * k) for k in (*UNITS, 1e6, 1e-6))
        point = next((point for place, point in about.items() if math.isclose(place, new[0], rel_tol=1e-9)), "")
        end = f": that about '{point}', not about the mass centre" if point else ""
        end = " (a unit taken for another)" if is_unit else end
        return f"{what} is {in_file_unit(linkage, kind, new[0])} in place of {in_file_unit(linkage, kind, value)}{end}"

    return Fault(
        name, fault.FaultKind.NUMBER, number_change(name), words, (value,), (size or 1.0,),
        usual=tuple((new,) for new in dict.fromkeys([*about, *usual]) if new != value),
        unit=kind_unit(kind, linkage.units).size,
        reshapes=kind == "length" and "centre" not in number.path and number.path[0] not in LOADS,
    )  # fmt: skip


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


def _inertias_about_points(link: Link) -> dict[float, str]:
    """The points of a link by its inertia about each, kg m²."""
    distances = {point: math.dist(at, link.centre) for point, at in link.points.items()}
    return {(link.inertia or 0.0) + link.mass * d**2: point for point, d in distances.items() if d and link.mass}


def _direction_fault(linkage: Linkage, name: str) -> Fault:
    """The fault of a direction that is turned by an angle, rad."""

    def apply(simulation: Simulation, angle: Array) -> Simulation:
        if abs(angle[0]) > math.pi:
            raise LinkproofError(f"expected an angle of half a turn at most, got {angle[0]:g} rad")
        known = named_numbers(simulation.linkage)
        x, y, c, s = known[f"{name}.x"].value, known[f"{name}.y"].value, math.cos(angle[0]), math.sin(angle[0])
        return _replace_numbers(simulation, {f"{name}.x": c * x - s * y, f"{name}.y": s * x + c * y})

    of = name.removesuffix(".along")
    what = "the direction of the output" if of == "output" else f"the guide of '{of}'"
    return Fault(
        name, fault.FaultKind.NUMBER, apply, lambda p: f"{what} is turned by {math.degrees(p[0]):.3g}°", (0.0,), (1.0,),
        unit=math.radians(1.0), reshapes=of != "output",
    )  # fmt: skip


def several_numbers(linkage: Linkage) -> Iterator[Fault]:
    """Faults of several numbers: all of a kind, a distance, a mass centre, mass and inertia of a link, a load."""
    everything: dict[str, tuple[tuple[Kind, ...], tuple[float, ...]]] = {
        "mass": ((Kind.MASS,), UNITS),
        "moment of inertia": ((Kind.INERTIA,), (0.0, *UNITS, 1e6, 1e-6)),
        "mass and moment of inertia": ((Kind.MASS, Kind.INERTIA), (*UNITS, 0.45359237)),
        "length": ((Kind.LENGTH,), (*UNITS, 0.1, 10.0, 0.0254, 25.4)),
    }
    for what, (kinds, usual) in everything.items():
        yield scaling_fault(f"every {what}", f"every {what}", usual, *kinds)
    for name, link in linkage.links.items():
        if link.mass:
            yield _centre_fault(linkage, name, link)
        if link.mass and link.inertia:
            both = f"mass and inertia of '{name}' together"
            yield scaling_fault(f"{name}.density", both, (0.0,), Kind.MASS, Kind.INERTIA, under=f"{name}.")
    if sum(len(link.points) for link in linkage.links.values()) <= MOST_POINTS:
        for name, link in linkage.links.items():
            for fixed, moved in itertools.permutations(link.points, 2):
                if all(a != b for a, b in zip(link.points[fixed], link.points[moved], strict=True)):
                    yield _distance_fault(linkage, name, fixed, moved)
    names = dict.fromkeys(name for name in named_numbers(linkage) if name.partition(".")[0] in LOADS)
    for load in dict.fromkeys(".".join(name.split(".")[:2]) for name in names if name.startswith(LOADS[:2])):
        yield scaling_fault(load, f"the load '{load}'", LOAD_FACTORS, Kind.FORCE, Kind.TORQUE, under=load)


def scaling_fault(name: str, subject: str, usual: tuple[float, ...], *kinds: Kind, under: str = "") -> Fault:
    """The fault that all numbers of some ``kinds``, with names that begin ``under``, are multiplied by a factor."""

    def words(k: Array) -> str:
        if abs(k[0]) < 1e-9:
            return f"{subject} is left out"
        is_unit = k[0] > 0.0 and math.isclose(math.log10(k[0]) % 3.0, 0.0)
        return (
            f"{subject} is {k[0]:.4g} times that of the linkage file{' (a unit taken for another)' if is_unit else ''}"
        )

    def apply(simulation: Simulation, k: Array) -> Simulation:
        scale = float(k[0]) if under.startswith(LOADS) else check_positive(k)
        return simulation.with_linkage(multiplied(simulation.linkage, scale, *kinds, under=under))

    return Fault(name, fault.FaultKind.SEVERAL, apply, words, (1.0,), (1.0,),
                 guesses=((1.0,),) if "length" in kinds else (),
                 usual=tuple((k,) for k in usual), unit=1.0, reshapes="length" in kinds)  # fmt: skip


def _distance_fault(linkage: Linkage, name: str, fixed: str, moved: str) -> Fault:
    """The fault that a point of a link has another distance, m, from a ``fixed`` point, in the same direction."""
    (x, y), (px, py) = linkage.links[name].points[fixed], linkage.links[name].points[moved]
    length = math.dist((x, y), (px, py))

    def apply(simulation: Simulation, d: Array) -> Simulation:
        k = check_positive(d) / length
        place = {f"{name}.{moved}.x": x + k * (px - x), f"{name}.{moved}.y": y + k * (py - y)}
        return _replace_numbers(simulation, place)

    def words(d: Array) -> str:
        lengths = f"{linkage.written(d[0])} in place of {linkage.written(length)}"
        return f"the distance of '{moved}' from '{fixed}' on '{name}' is {lengths}"

    return Fault(
        f"{name}.{fixed}-{moved}", fault.FaultKind.NUMBER, apply, words, (length,), (length,),
        unit=factor("length", linkage.units.get("length", "m")), reshapes=True,
    )  # fmt: skip


def _centre_fault(linkage: Linkage, name: str, link: Link) -> Fault:
    """The fault that a link's mass centre is elsewhere: at a usual wrong place, or anywhere."""
    (x, y), places = link.centre, list(link.points.values())
    size = linkage.shortest_length()
    middle = (float(np.mean([p[0] for p in places])), float(np.mean([p[1] for p in places])))
    usual: list[Numbers] = [*places, middle, (-x, -y), (y, x), (0.0, 0.0), (1e3 * x, 1e3 * y), (1e-3 * x, 1e-3 * y)]
    if len(places) == 2:  # measured from the other end
        usual.append((places[0][0] + places[1][0] - x, places[0][1] + places[1][1] - y))

    def apply(simulation: Simulation, c: Array) -> Simulation:
        place = {f"{name}.centre.x": float(c[0]), f"{name}.centre.y": float(c[1])}
        return _replace_numbers(simulation, place)

    def words(c: Array) -> str:
        unit = linkage.units.get("length", "m")
        new, old = (", ".join(linkage.written(v).rpartition(" ")[0] for v in place) for place in (c, link.centre))
        return f"the mass centre of '{name}' is at ({new}) {unit} in place of ({old}), in the link's frame"

    return Fault(f"{name}.centre", fault.FaultKind.SEVERAL, apply, words, link.centre, (size, size),
                 guesses=(link.centre,), usual=tuple(dict.fromkeys(p for p in usual if p != link.centre)))  # fmt: skip


def misplaced_loads(linkage: Linkage) -> Iterator[Fault]:
    """Faults of loads: all of a kind left out; a load at another point, on another link, late, or by its mean."""
    for part in LOADS:
        if getattr(linkage, part):
            nothing: dict[str, Any] = {part: ()}
            yield _load_fault(f"no {part}", f"the {part} of the linkage file are left out", partial(replace, **nothing))
    for number, force in enumerate(linkage.forces):
        name = f"forces.{force.point}"
        for point in linkage.links[force.link].points if force.link in linkage.links else ():
            if point != force.point:
                words = f"the force at '{force.point}' acts at '{point}'"
                yield _load_fault(f"{name} at {point}", words, partial(_change_load, "forces", number, point=point))
        if force.force.angles is not None:
            mean = Law(force.force.values.mean(axis=0))
            words = f"the force at '{force.point}' is its mean over the crank angle"
            yield _load_fault(f"{name} by its mean", words, partial(_change_load, "forces", number, force=mean))
            yield _late_force_fault(name, number)
    for number, torque in enumerate(linkage.torques):
        for link in linkage.links:
            if link != torque.link:
                words = f"the torque on '{torque.link}' acts on '{link}'"
                change = partial(_change_load, "torques", number, link=link)
                yield _load_fault(f"torques.{torque.link} on {link}", words, change)
    for number, damper in enumerate(linkage.dampers):
        key, other = damper.links
        if GROUND not in damper.links:
            name, words = f"dampers.{key}.{other}", f"the damper of '{key}' and '{other}' acts on the ground"
            change = partial(_change_load, "dampers", number, links=(key, GROUND))
            yield _load_fault(f"{name} against the ground", words, change)


def _load_fault(name: str, words: str, change: Callable[[Linkage], Linkage]) -> Fault:
    """The fault, without numbers, that loads of the linkage are changed."""

    def apply(simulation: Simulation, _: Array) -> Simulation:
        return simulation.with_linkage(change(simulation.linkage))

    return Fault(name, fault.FaultKind.SETTING, apply, lambda _: words)


def _change_load(part: str, number: int, linkage: Linkage, **changes: Any) -> Linkage:  # noqa: ANN401 - fields of a load
    loads = list(getattr(linkage, part))
    loads[number] = replace(loads[number], **changes)
    everything: dict[str, Any] = {part: tuple(loads)}
    return replace(linkage, **everything)


def _late_force_fault(name: str, number: int) -> Fault:
    """The fault that a force over the crank angle is late by an angle, rad."""

    def apply(simulation: Simulation, angle: Array) -> Simulation:
        law = simulation.linkage.forces[number].force
        assert law.angles is not None
        late = replace(law, angles=law.angles + float(angle[0]))
        return simulation.with_linkage(_change_load("forces", number, simulation.linkage, force=late))

    def words(angle: Array) -> str:
        return f"the load '{name}' is late by {math.degrees(angle[0]):.3g}°"

    return Fault(f"{name} late", fault.FaultKind.NUMBER, apply, words, (0.0,), (1.0,), unit=math.radians(1.0))
