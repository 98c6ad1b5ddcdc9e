"""Figures of many designs by the kernels: peaks, means and single values of signals, without their curves."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from typing import Any, Final, Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

from analytic.compiled.choice import kernels
from analytic.compiled.evaluation import in_threads, writable
from analytic.compiled.flat_linkage import CRANK_BODY, FlatLinkage, bodies, has_kernels, levels
from analytic.description.linkage import Linkage
from analytic.dynamics.derivative_orders import needs
from analytic.errors import UnknownNameError
from analytic.kinematics.structure import Prismatic, Revolute, Structure
from analytic.kinematics.sweep import Sweep

Array = NDArray[np.float64]
Integers = NDArray[np.int64]

Signal = tuple[tuple[int, int, int, int], float]  # kind and entries, and the factor

CHUNK: Final = 512  # designs a thread takes at a time: about a millisecond
ORDERS: Final = ("x", "y", "vx", "vy", "ax", "ay")
PARTS: Final = ("x", "y", "moment", "magnitude")
SUMMED: Final = frozenset({"Mkr", "Peq", "Teq", "Jeq", "S", "v", "a"})


class FigureLike(Protocol):
    """A signal's name, how it becomes one number (a name of ``kernels.reductions.REDUCTIONS``), and an angle, rad."""

    @property
    def signal(self) -> str: ...  # noqa: D102
    @property
    def reduction(self) -> str: ...  # noqa: D102
    @property
    def angle(self) -> float: ...  # noqa: D102


def can_figure(structure: Structure, signals: Iterable[str]) -> bool:
    """Whether the kernels can work out signals of a linkage; NumPy can all.

    They know no groups of class III, change points and pushed drivers, and no unwrapped angles of links but the crank.
    """
    pivot = structure.pivot
    own = "" if pivot is None else f"link:{pivot.far}:angle"
    unwrapped = (name for name in signals if name.startswith("link:") and name.endswith(":angle"))
    return has_kernels(structure) and all(name == own for name in unwrapped)


def compiled_figures(
    flat: FlatLinkage,
    figures: Sequence[FigureLike],
    angle: ArrayLike,
    *,
    largest: Linkage,
    count: int,
    designs: Callable[[int, int], Array],
    speed: float,
    cores: int | None,
) -> tuple[Array, NDArray[np.bool_]]:
    """Figures of ``count`` designs, (figures, count), SI, and whether each is to be looked at again, (count,).

    Figures are as ``analytic.designs.results.design_figures`` defines them, for designs that
    move from one angle to the next: one that may not is told besides (``kernels.figures.reduced``).

    ``largest`` and ``designs`` are as for ``analytic.compiled.evaluation.compute``; the crank turns at a constant
    ``speed``, rad/s. A signal is sampled at the crank angles ``angle`` (angles,), rad, and its means are theirs.
    The figures of a design that cannot move at any of the angles are nan. Raises LinkproofError if numba is not
    installed, UnknownNameError for signals that the linkage does not have.
    """
    linkage, code = kernels("linkage"), kernels("figures")
    wanted, chosen = _Signals(flat, largest, figures, speed).wanted(code, len(np.asarray(angle)))
    angles = writable(np.concatenate([np.asarray(angle, dtype=float), chosen]))
    share = np.full(len(np.asarray(angle)), 1.0 / len(np.asarray(angle)))
    values, steep = np.zeros((len(figures), count)), np.zeros(count)
    books = (len(flat.tables.references) + 3 * len(flat.structure.dyads) + 2) * kernels("statics").WRENCH

    def part(first: int) -> None:
        rows = designs(first, min(first + CHUNK, count))
        own = np.zeros((len(rows), linkage.design_size(flat)))
        own[:, : rows.shape[1]] = rows
        tally = np.empty((len(rows), len(wanted.signals) + 1, kernels("reductions").TALLY))
        work = np.concatenate([linkage.scratch(flat), np.zeros(books)])
        code.reduced(flat.tables, own, first, angles, share, wanted, values, steep, tally, work)

    in_threads(part, list(range(0, count, CHUNK)), cores)
    return values, steep > 0.0


class _Signals:
    """The signals of some figures, each once, as the kernels take them, and what they need of the linkage."""

    def __init__(self, flat: FlatLinkage, largest: Linkage, figures: Sequence[FigureLike], speed: float) -> None:
        self.flat, self.figures, self.speed = flat, figures, speed
        self.layout, self.code = kernels("layout"), kernels("figures")
        self.bodies = bodies(flat.structure)
        self.numbers = {name: number for number, name in enumerate(dict.fromkeys(one.signal for one in figures))}
        self.terms: list[tuple[int, int]] = []
        self.forces = 0
        self.needed = needs(largest, SUMMED.intersection(self.numbers), turns=speed != 0.0, accelerates=False)
        self.orders = dict(self.needed.orders)
        self.rows = [self._signal(name) for name in self.numbers]
        if self.forces:
            for name, link in largest.links.items():
                self._ask(name, 2 if link.mass or link.inertia else 1)

    def wanted(self, code: Any, samples: int) -> tuple[Any, Array]:  # noqa: ANN401 - of the kernels
        """The kernels' ``Wanted``, and the crank angles of single values, which follow the samples."""
        reductions = kernels("reductions")
        chosen = list(dict.fromkeys(one.angle for one in self.figures if one.reduction == "at"))
        statistics = np.zeros(len(self.numbers), dtype=np.int64)
        counted = np.array([name == "S" for name in self.numbers], dtype=np.int64)
        found = []
        for one in self.figures:
            number, reduction = self.numbers[one.signal], reductions.REDUCTIONS.index(str(one.reduction))
            statistics[number] |= reductions.STATISTICS[reduction] | reductions.EXTREMES * counted[number]
            found.append((number, reduction, samples + chosen.index(one.angle) if one.reduction == "at" else -1))
        signals = np.array([(*entries, flags) for (entries, _), flags in zip(self.rows, statistics, strict=True)])
        needed = self.needed
        sums = [needed.inertia, needed.half_derivative, needed.forces, needed.output]
        return code.Wanted(
            levels=np.maximum(levels(self.flat.structure, self.orders), 1),  # all dyads have to be able to move
            sums=np.array(sums, dtype=np.int64),
            has_torque=not {"Mkr", "Peq"}.isdisjoint(self.numbers),
            forces=self.forces,
            signals=signals.astype(np.int64).reshape(-1, 5),
            factors=np.array([factor for _, factor in self.rows]),
            counted=counted,
            terms=np.array(self.terms, dtype=np.int64).reshape(-1, 2),
            figures=np.array(found, dtype=np.int64).reshape(-1, 3),
            speed=float(self.speed),
            samples=samples,
        ), np.array(chosen, dtype=float)

    def _ask(self, body: str, order: int) -> None:
        if body in self.bodies:
            self.orders[body] = max(order, self.orders.get(body, order))

    def _signal(self, name: str) -> Signal:
        """Kind and entries of a signal, and its factor."""
        kind, _, rest = name.partition(":")
        part, _, component = rest.rpartition(":")
        if kind == "transmission_angle":
            names = [dyad.name for dyad in self.flat.structure.dyads]
            if rest not in names:
                raise UnknownNameError("group", rest, names)
            return (self.code.TRANSMISSION, names.index(rest), 0, 0), 1.0
        if kind == "point":
            return self._point(part, component)
        if kind == "link":
            return self._link(part, component)
        if kind == "joint_force":
            self.forces |= self.code.OF_JOINTS
            return self._wrenches(self._joint(part), component)
        if kind in {"shaking_force", "shaking_moment"}:
            self.forces |= self.code.ON_FRAME
            frame = len(self.bodies) + 3 * len(self.flat.structure.dyads)
            return self._wrenches([(frame, 1)], rest or "moment")
        return self._row(name)

    def _row(self, name: str) -> Signal:
        """A signal that is a factor times a row of the scratch memory."""
        at, speed = self.layout, self.speed
        rows = {
            "phi": (at.ANGLE, 1.0),
            "omega": (self._body(CRANK_BODY) + at.DW, speed),
            "epsilon": (at.ANGLE, 0.0),
            "Mkr": (at.SUMS + at.FORCE, 1.0),
            "Peq": (at.SUMS + at.FORCE, speed),
            "Teq": (at.SUMS + at.JEQ, 0.5 * speed**2),
            "Jeq": (at.SUMS + at.JEQ, 1.0),
            "S": (at.SUMS + at.OUTPUT, -1.0),
            "v": (at.SUMS + at.OUTPUT_RATE, -speed),
            "a": (at.SUMS + at.OUTPUT_SECOND, -(speed**2)),
        }
        if name not in rows:
            raise UnknownNameError("signal", name, rows)
        row, factor = rows[name]
        return (self.code.ROWS, row, 0, 0), factor

    def _body(self, number: int) -> int:
        """Where a body's rows start in the scratch memory."""
        start: int = self.layout.LAWS + self.layout.LAW * len(self.flat.tables.laws) + self.layout.BODY * number
        return start

    def _point(self, point: str, component: str) -> Signal:
        body = Sweep(self.flat.linkage, self.flat.structure, np.zeros(1)).carrier(point)
        order, axis = divmod(ORDERS.index(component), 2)
        self._ask(body, order)
        place = self.flat.places[f"{body}.{point}.x"]
        return (self.code.POINT, self.bodies[body], place, 2 * order + axis), self.speed**order

    def _link(self, link: str, component: str) -> Signal:
        order = ("angle", "omega", "alpha").index(component)
        self._ask(link, order)
        row = (self.layout.C, self.layout.DW, self.layout.DDW)[order]
        at = self._body(self.bodies[link]) + row if order else self.layout.ANGLE  # of the crank, see can_figure
        return (self.code.ROWS, at, 0, 0), self.speed**order

    def _wrenches(self, sum_of: list[tuple[int, int]], part: str) -> Signal:
        first, size = len(self.terms), kernels("statics").WRENCH
        self.terms += [(size * block, sign) for block, sign in sum_of]
        return (self.code.WRENCHES, first, len(self.terms), PARTS.index(part)), 1.0

    def _joint(self, name: str) -> list[tuple[int, int]]:
        """The wrenches whose sum a joint's force is, by number in the books, and whether each counts as it is or not.

        Names, and the body that the force acts on, are those of ``analytic.dynamics.joint_forces``.
        """
        linkage, structure = self.flat.linkage, self.flat.structure
        joints = list(enumerate((joint for dyad in structure.dyads for joint in dyad.joints), len(self.bodies)))
        assert isinstance(structure.pivot, Revolute)
        joints.append((CRANK_BODY, structure.pivot))  # bears what the crank needs in the end
        pins = {own: (Revolute, pin.point, link) for pin in linkage.pins for own, link in pin.joints.items()}
        slides = {slider.name: (Prismatic, slider.link, slider.link) for slider in linkage.sliders}
        slides |= {slot.name: (Prismatic, slot.name, slot.name) for slot in linkage.slots}
        if name not in {*pins, *slides}:
            raise UnknownNameError("joint", name, linkage.joint_names)
        kind, place, body = (pins | slides)[name]
        kin = [(n, on) for n, on in joints if isinstance(on, kind) and body in (on.near, on.far)]
        here = [(n, on) for n, on in kin if (on.point if isinstance(on, Revolute) else on.slider) == place]
        return [(n, 1 if on.far == body else -1) for n, on in here]
