"""What may be wrong with the model in the tool: gravity, a mass, a mass centre, an inertia, a length, a load."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from analytic.description.changes import Kind, changed, multiplied, numbers, without
from analytic.description.linkage import Link, Linkage, RotaryDamper, Vector
from analytic.errors import LinkproofError
from analytic.written import fixed
from comparisons.imported.causes.fitting import FaultModel, said
from comparisons.imported.judging.judgement import SignalVerdict
from comparisons.imported.judging.samples import JudgedModel, depends_on_masses

Array = NDArray[np.float64]
Change = Callable[[Linkage, Array], Linkage]

EARTH: Final = 9.80665
UNITS: Final = ((1e3,), (1e-3,))  # a unit taken for another
LOADS: Final = ("forces", "torques", "springs", "dampers")


def model_changes(model: JudgedModel) -> Iterator[FaultModel]:
    """Every cause that lies in masses and loads: what torques, forces and energies show."""
    yield from _gravity(model)
    everything: dict[str, tuple[tuple[Kind, ...], tuple[tuple[float, ...], ...]]] = {
        "mass": (("mass",), UNITS),
        "moment of inertia": (("inertia",), ((0.0,), *UNITS, (1e6,), (1e-6,))),
        "mass and moment of inertia": (("mass", "inertia"), UNITS),
    }
    for what, (kinds, special) in everything.items():
        yield scaling(model, f"every {what}", _all(*kinds), f"every {what}", special=special)
    for name, link in model.linkage.links.items():
        yield from _link(model, name, link)
    yield from _loads(model)
    yield from _damping(model)


def of_masses(model: JudgedModel, kind: str, change: Change, words: Callable[[Array], str], **rest: Any) -> FaultModel:  # noqa: ANN401
    """A cause that changes masses and loads of the linkage; ``rest`` are fields of ``FaultModel``."""

    def predict(numbers: Array, verdicts: Sequence[SignalVerdict]) -> list[Array]:
        other = model.loaded(change(model.linkage, numbers))
        changing = [verdict.samples for verdict in verdicts if depends_on_masses(verdict.name)]
        values = iter(other.predicted(changing))
        return [next(values) if depends_on_masses(verdict.name) else verdict.truth for verdict in verdicts]

    return FaultModel(kind, predict, words, **rest)


def scaling(model: JudgedModel, kind: str, change: Change, what: str, **rest: Any) -> FaultModel:  # noqa: ANN401
    """A cause that multiplies masses or loads, ``what`` in words, by a factor."""
    return of_masses(model, kind, change, times(what), start=(1.0,), sizes=(1.0,), **rest)


def times(what: str) -> Callable[[Array], str]:
    """The words of a factor."""

    def words(k: Array) -> str:
        if abs(k[0]) < 1e-9:
            return f"{what} is left out"
        is_unit = k[0] > 0.0 and math.isclose(math.log10(k[0]) % 3.0, 0.0)
        return f"{what} is {k[0]:.4g} times that of the linkage file{' (a unit taken for another)' if is_unit else ''}"

    return words


def _all(*kinds: Kind) -> Change:
    return lambda linkage, k: multiplied(linkage, positive(k), *kinds)


def positive(k: Array) -> float:
    """A factor of masses and lengths; raises LinkproofError for a negative one."""
    if k[0] < 0.0:
        raise LinkproofError(f"factor: expected no negative number, got {k[0]:g}")
    return float(k[0])


def _gravity(model: JudgedModel) -> Iterator[FaultModel]:
    """Its size along the file's direction, and any vector."""
    (x, y), size = model.linkage.gravity, math.hypot(*model.linkage.gravity)
    if not any(link.mass for link in model.linkage.links.values()):
        return

    def along(linkage: Linkage, k: Array) -> Linkage:
        return replace(linkage, gravity=(x * float(k[0]), y * float(k[0])))

    def words(k: Array) -> str:
        if abs(k[0]) < 1e-9:
            return "gravity is off"
        if math.isclose(k[0], -1.0):
            return "gravity points the other way"
        return f"gravity is {k[0] * size:.4g} m/s² in place of {size:.4g} m/s²"

    def any_words(g: Array) -> str:
        return f"gravity is ({fixed(g[0], 3)}, {fixed(g[1], 3)}) m/s² in place of ({x:zg}, {y:zg}) m/s²"

    if size:
        sizes = tuple((g / size,) for g in (EARTH, 9.81, 9.8) if g != size)
        special = ((0.0,), (-1.0,), *sizes, *UNITS)
        yield of_masses(model, "gravity", along, words, start=(1.0,), sizes=(1.0,), special=special)
    axes = ((0.0, -EARTH), (0.0, -9.81), (0.0, EARTH), (-EARTH, 0.0), (EARTH, 0.0))
    yield of_masses(
        model,
        "gravity's direction",
        lambda linkage, g: replace(linkage, gravity=(float(g[0]), float(g[1]))),
        any_words,
        start=(x, y),
        sizes=(EARTH, EARTH),
        special=() if size else axes,
        handicap=1,
        contains=("gravity",),
    )


def _with_link(linkage: Linkage, name: str, **changes: Any) -> Linkage:  # noqa: ANN401
    return replace(linkage, links={**linkage.links, name: replace(linkage.links[name], **changes)})


def _link(model: JudgedModel, name: str, link: Link) -> Iterator[FaultModel]:
    """Mass, both together, mass centre and inertia of a link."""
    mass, inertia = link.mass, link.inertia

    def with_mass(linkage: Linkage, k: Array) -> Linkage:
        return _with_link(linkage, name, mass=mass * positive(k))

    def with_inertia(linkage: Linkage, k: Array) -> Linkage:
        return _with_link(linkage, name, inertia=(inertia or 0.0) * positive(k))

    def with_both(linkage: Linkage, k: Array) -> Linkage:
        return with_inertia(with_mass(linkage, k), k)

    def mass_words(k: Array) -> str:
        return f"the mass of '{name}' is {k[0] * mass:.4g} kg in place of {mass:g} kg"

    of_one: dict[str, Any] = {"start": (1.0,), "sizes": (1.0,)}
    if mass:
        yield of_masses(model, f"mass:{name}", with_mass, mass_words, special=((0.0,), *UNITS), **of_one)
        yield _centre(model, name, link)
    if inertia:
        special = tuple((k,) for k in (0.0, *_about_points(link), 1e3, 1e-3, 1e6, 1e-6))
        yield of_masses(model, f"inertia:{name}", with_inertia, _inertia_words(name, link), special=special, **of_one)
    if mass and inertia:
        what = f"mass and inertia of '{name}' together"
        yield scaling(model, f"density:{name}", with_both, what, special=((0.0,),), handicap=1)


def _about_points(link: Link) -> dict[float, str]:
    """The inertia about each of a link's points, as a factor of that about its mass centre."""
    factors: dict[float, str] = {}
    for point, at in link.points.items():
        distance = math.dist(at, link.centre)
        if distance and link.inertia:
            factors[1.0 + link.mass * distance**2 / link.inertia] = point
    return factors


def _inertia_words(name: str, link: Link) -> Callable[[Array], str]:
    inertia = link.inertia or 0.0

    def words(k: Array) -> str:
        if abs(k[0]) < 1e-9:
            return f"the moment of inertia of '{name}' is left out"
        about = _about_points(link).get(float(k[0]))
        value = f"the moment of inertia of '{name}' is {k[0] * inertia:.4g} kg m² in place of {inertia:g} kg m²"
        return f"{value}: that about '{about}', not about the mass centre" if about else value

    return words


def _centre(model: JudgedModel, name: str, link: Link) -> FaultModel:
    linkage, (x, y), places = model.linkage, link.centre, list(link.points.values())
    size = linkage.shortest_length()
    middle = (float(np.mean([p[0] for p in places])), float(np.mean([p[1] for p in places])))
    special = [
        *places,
        middle,
        (-x, y),
        (x, -y),
        (-x, -y),
        (y, x),
        (0.0, 0.0),
        (1e3 * x, 1e3 * y),
        (1e-3 * x, 1e-3 * y),
    ]
    if len(places) == 2:  # measured from the other end
        special.append((places[0][0] + places[1][0] - x, places[0][1] + places[1][1] - y))

    def written(place: Vector | Array) -> str:
        values = [linkage.written(float(v) if abs(v) > 1e-5 * size else 0.0) for v in place]
        return ", ".join(value.rpartition(" ")[0] for value in values)

    def words(c: Array) -> str:
        at = f"({written(c)}) {linkage.units.get('length', 'm')} in place of ({written(link.centre)})"
        return f"the mass centre of '{name}' is at {at}, in the link's frame"

    return of_masses(
        model,
        f"centre:{name}",
        lambda found, c: _with_link(found, name, centre=(float(c[0]), float(c[1]))),
        words,
        start=link.centre,
        sizes=(size, size),
        special=tuple(dict.fromkeys(place for place in special if place != link.centre)),
    )


def _loads(model: JudgedModel) -> Iterator[FaultModel]:
    """A force, a torque, a spring or a damper of the file with another size, or left out."""
    for name, value in numbers(model.linkage).items():
        if value and name.startswith(tuple(f"{part}." for part in LOADS)) and not name.endswith(".length"):
            special = ((0.0,), (-1.0,), *UNITS)
            yield scaling(model, name, _one_number(name), f"'{name}'", special=special)
    for part in LOADS:
        if getattr(model.linkage, part):
            words = said(f"the {part} of the linkage file are left out")
            yield of_masses(model, f"no {part}", _without(part), words)


def _one_number(name: str) -> Change:
    return lambda linkage, k: changed(linkage, lambda n, _, value: value * float(k[0]) if n == name else value)


def _without(part: str) -> Change:
    return lambda linkage, _: without(linkage, part)


def _damping(model: JudgedModel) -> Iterator[FaultModel]:
    """Friction that grows with the speed, in a pin that has none in the file."""
    linkage = model.linkage
    inertia = sum((k.inertia or 0.0) + k.mass * linkage.extent() ** 2 for k in linkage.links.values())
    size = (inertia or 1.0) * (model.motion.peak_speed or 1.0)
    present = {frozenset(damper.links) for damper in linkage.dampers}
    for pin in linkage.pins:
        for link in pin.joints.values():
            pair = (pin.hub, link)
            if frozenset(pair) not in present:
                present.add(frozenset(pair))
                words = _damping_words(pin.point)
                of_one: dict[str, Any] = {"start": (0.0,), "sizes": (size,), "handicap": 1}
                yield of_masses(model, f"damping:{pin.point}", _damped(pair), words, **of_one)


def _damped(pair: tuple[str, str]) -> Change:
    return lambda linkage, b: replace(linkage, dampers=(*linkage.dampers, RotaryDamper(pair, float(b[0]))))


def _damping_words(point: str) -> Callable[[Array], str]:
    return lambda b: f"a rotary damper of {b[0]:.3g} N m s acts in the pin '{point}'"
