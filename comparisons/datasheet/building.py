"""Data sheets made: the closed form of a mechanism over its usual motion, as plain data."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass, field, replace
from functools import cached_property, partial
from itertools import pairwise
from typing import Final, TypeVar, cast

import numpy as np
from numpy.typing import NDArray

from analytic.description.crank_motion import RPM, CrankMotion, Segment, swing
from analytic.description.law import FULL_TURN
from analytic.description.linkage import Linkage, PrescribedRegime
from analytic.description.loading import parse
from analytic.description.thread_path import ThreadEye
from analytic.dynamics import reduced
from analytic.errors import LinkproofError
from analytic.kinematics.crank_range import CrankRange
from analytic.kinematics.mechanism import Mechanism
from analytic.motion.released import FreeMotion
from analytic.turn.thread_feed import contour, eye_travel, feed_diagram
from analytic.turn.unit_functions import unit_functions
from comparisons.datasheet.designer_results import DesignerResults
from comparisons.datasheet.instants import Instants
from comparisons.datasheet.mechanism_summary import described, portrait, thread_facts
from comparisons.datasheet.plain_data import figures, peaks
from comparisons.datasheet.positions import over_motion
from comparisons.datasheet.released import printed, released
from comparisons.datasheet.sheet import (
    Eye,
    Normalised,
    PublishedFigure,
    Released,
    Sheet,
    SheetFigures,
    ThreadSheet,
)
from comparisons.reference.case import Case, own_motion
from comparisons.reference.published import compare_published

Array = NDArray[np.float64]
T = TypeVar("T")

STEADY: Final = "constant-speed"
USUAL_SPEED: Final = 1000.0 * RPM
MARGIN: Final = 0.02  # share of a range left out at either end, where forces grow beyond all bounds
FEW, MOST = 361, 721  # instants of a sheet
SHOWN: Final = 180  # steps of the normalised motion, which is smooth
MOST_NUMBERS: Final = 40_000  # of all its signals
MISSED: Final = 1e-3  # of a signal's largest magnitude, by which a straight line between two instants may miss it
ROUNDS: Final = 6
NOT_SAVED: Final = ("point:", "link:")  # they follow from the positions


def usual_case(mechanism: Mechanism, prescribed: Sequence[CrankMotion] = (), regimes: Sequence[str] = ()) -> Case:
    """A turn at the speed at which the first motion ends, else at 1000 rpm; the motion or a swing where none is made.

    Motions of the linkage's own count by the names of their ``regimes``, after those ``prescribed``.
    """
    reach = mechanism.crank_range()
    own = {one.name: one.motion for one in mechanism.linkage.regimes if isinstance(one, PrescribedRegime)}
    asked = (*prescribed, *(motion for name, motion in own.items() if name in regimes))
    if not reach.is_full_turn:
        return Case(mechanism, next(iter((*asked, *own.values())), None) or range_motion(reach))
    speed = float(asked[0].speed(asked[0].duration)) or asked[0].peak_speed if asked else USUAL_SPEED
    start, duration = (mechanism.period if speed < 0.0 else 0.0), mechanism.period / abs(speed)
    return Case(mechanism, CrankMotion(STEADY, (Segment(0.0, duration, (start, speed)),)))


def range_motion(reach: CrankRange, speed: float = USUAL_SPEED, *, backwards: bool = False) -> CrankMotion:
    """A swing over a range, short of its limits, at ``speed``, rad/s; of a drive along a line, in a second."""
    first, last = within(reach, backwards=backwards)
    fastest = abs(last - first) if reach.is_linear else speed
    return replace(swing(STEADY, first, last, speed=fastest), regime=f"{STEADY} over its range")


def within(reach: CrankRange, *, backwards: bool = False) -> tuple[float, float]:
    """The ends of a range, short of its limits, in the order in which the drive passes them."""
    low, high = reach.limits
    margin = MARGIN * (high - low)
    return (high - margin, low + margin) if backwards else (low + margin, high - margin)


def usual_sheet(linkage: Linkage, prescribed: Sequence[CrankMotion] = (), regimes: Sequence[str] = ()) -> Sheet:
    """The sheet of a linkage under its usual motion, with what there is to say of those of these regimes it has."""
    try:
        return sheet(usual_case(Mechanism(linkage), prescribed, regimes), regimes)
    except LinkproofError as error:
        return bare_sheet(linkage, str(error))


def bare_sheet(linkage: Linkage, reason: str) -> Sheet:
    """The sheet of a linkage of which nothing can be derived, with the reason."""
    return Sheet(
        name=linkage.name,
        variant=linkage.variant,
        text=linkage.text,
        gravity=linkage.gravity,
        formula="",
        conditions="",
        axis="phi",
        units={},
        values={},
        peaks={},
        figures={"drive": [], "forces": [], "transmission": [], "output": []},
        facts=described(linkage),
        missing={"values": reason},
    )


def sheet(case: Case, regimes: Sequence[str] = ()) -> Sheet:
    """The sheet of a case, with what there is to say of those of these regimes in which its crank is released."""
    results = DesignerResults(case, Instants(case.motion, turns=not case.mechanism.linkage.is_linear))
    return _Building(results, regimes).sheet()


@dataclass(frozen=True)
class _Building:
    """A sheet in the making; ``missing`` says of each part that cannot be derived why."""

    results: DesignerResults
    regimes: Sequence[str]
    missing: dict[str, str] = field(default_factory=dict)

    @property
    def mechanism(self) -> Mechanism:
        """The closed form."""
        return self.results.case.mechanism

    @property
    def linkage(self) -> Linkage:
        """The linkage."""
        return self.mechanism.linkage

    def sheet(self) -> Sheet:
        """All of it."""
        names = [name for name in self.results.curves.names if not name.startswith(NOT_SAVED)]
        nothing: SheetFigures = {"drive": [], "forces": [], "transmission": [], "output": []}
        values: Mapping[str, Array] = self.part("values", lambda: self.values(names), {})
        return Sheet(
            name=self.linkage.name,
            variant=self.linkage.variant,
            text=self.linkage.text,
            gravity=self.linkage.gravity,
            formula=self.mechanism.structure.formula,
            conditions=self.part("conditions", lambda: self.results.conditions, ""),
            axis=self.results.axis,
            units={name: self.results.curves.unit(name) for name in self.results.curves.names},
            values=values,
            peaks=self.part("peaks", lambda: peaks(self.results, names), {}),
            figures=self.part("figures", lambda: figures(self.results), nothing),
            facts=self.part("facts", lambda: portrait(self.linkage), described(self.linkage)),
            moment_centre=self.results.moment_centre,
            positions=self.part("positions", lambda: over_motion(self.results.curves), None),
            shares=self.part("shares", lambda: self.shares(values["phi"]), {}) if values else {},
            normalised=self.part("normalised", self.normalised, None),
            thread=self.part("thread", self.thread, None),
            published=self.part("published", self.published, ()),
            released=self.released(),
            printed=self.part("printed", lambda: printed(self.linkage, self.motions), {}),
            missing=self.missing,
        )

    def part(self, name: str, make: Callable[[], T], instead: T) -> T:
        """A part of the sheet; of one that cannot be derived why, and what stands in its place."""
        try:
            return make()
        except LinkproofError as error:
            self.missing[name] = str(error)
            return instead

    def values(self, names: Sequence[str]) -> Mapping[str, Array]:
        """Signals over the axis, at as many instants as they need, those of their peaks among them."""
        self.results.case.check_motion()
        curves = self.results.curves
        peaks = [peak.time for peak in curves.peaks(names).values()]
        truth = curves.at(np.union1d(curves.grid, peaks))
        found = {name: curves.of(truth, name) for name in names}
        most = min(MOST, MOST_NUMBERS // len(found))
        kept = np.union1d(
            needed(truth.time, np.array(list(found.values())), min(FEW, most), most), np.searchsorted(truth.time, peaks)
        )
        if self.results.axis == "phi" and found["phi"][-1] < found["phi"][0]:
            kept = kept[::-1]
        return {name: values[kept] for name, values in found.items()}

    def shares(self, angle: Array) -> Mapping[str, Mapping[str, Array]]:
        """Jeq by group and by link at values of φ; nothing where nothing has mass."""
        if self.linkage.is_massless:
            return {}
        sweep = self.mechanism.sweep(angle)
        crank = [self.linkage.crank] if self.linkage.crank else []
        order = [*crank, *(name for group in self.mechanism.structure.groups for name in group.links)]
        links = {name: reduced.link_inertia(sweep, name) for name in order if name in self.linkage.links}
        return {"groups": reduced.group_inertia(sweep), "links": links}

    def normalised(self) -> Normalised | None:
        """Unit functions of an output."""
        if self.linkage.output is None:
            return None
        self._check_turn()
        motion = self.results.case.motion
        found = unit_functions(self.mechanism, clockwise=float(motion.speed(motion.duration)) < 0.0)
        every = len(found.phase) // SHOWN
        ours = (found.displacement, found.velocity, found.acceleration)

        def named(curves: tuple[Array, ...]) -> dict[str, Array]:
            return {name: np.append(c[::every], c[0]) for name, c in zip("Sva", curves, strict=True)}

        phase = np.append(found.phase[::every], FULL_TURN)
        means = dict(zip("Sva", found.deviations, strict=True))
        return Normalised(phase, named(ours), named(found.harmonics), means)

    def _check_turn(self) -> None:
        """Raise LinkproofError where the driver makes no full turn."""
        if self.linkage.is_linear or not self.mechanism.crank_range().is_full_turn:
            raise LinkproofError(
                f"The normalised motion needs a full turn, which the {self.linkage.driver} does not make"
            )

    def thread(self) -> ThreadSheet | None:
        """Contour and feed of a thread."""
        path = self.linkage.thread
        if path is None:
            return None
        found = feed_diagram(self.mechanism, path, FEW - 1)
        angle = np.append(found.angle, FULL_TURN)
        corners = contour(self.mechanism.sweep(angle), path)
        eyes: dict[str, Eye] = {}
        for stop, corner in zip(path.stops, corners, strict=True):
            if isinstance(stop, ThreadEye):
                eyes[stop.point] = {"path": corner, **self._ends(stop.point)}  # type: ignore[typeddict-item]
        return ThreadSheet(
            angle=angle,
            feed=np.append(found.feed, found.feed[0]),
            length=np.append(found.length, found.length[0]),
            contour=contour(self.mechanism.sweep(found.reference_angle), path),
            stops=tuple(stop.point if isinstance(stop, ThreadEye) else stop.name for stop in path.stops),
            eyes=eyes,
            reference_angle=found.reference_angle,
            figures=thread_facts(self.mechanism, path),
        )

    def _ends(self, eye: str) -> dict[str, float | None]:
        try:
            travel = eye_travel(self.mechanism, eye)
        except LinkproofError:
            return {"top_angle": None, "bottom_angle": None}
        return {"top_angle": travel.top_angle, "bottom_angle": travel.bottom_angle}

    @cached_property
    def motions(self) -> dict[str, FreeMotion]:
        """The motion of each regime in which the crank is released."""
        own = {name: regime for name, regime in self.linkage.released.items() if name in self.regimes}
        return self.each("released", {name: partial(own_motion, self.mechanism, one) for name, one in own.items()})

    def released(self) -> dict[str, Released]:
        """What there is to say of each of them."""
        own, motions = self.linkage.released, self.motions
        told = {name: partial(released, self.mechanism, own[name], motion) for name, motion in motions.items()}
        return self.each("released", told)

    def each(self, kind: str, made: Mapping[str, Callable[[], T]]) -> dict[str, T]:
        """Parts of a kind by name, without those that cannot be derived."""
        found = {name: self.part(f"{kind}.{name}", make, None) for name, make in made.items()}
        return {name: one for name, one in found.items() if one is not None}

    def published(self) -> tuple[PublishedFigure, ...]:
        """The printed figures in every variant of the file."""
        linkage = self.linkage
        if not linkage.published:
            return ()
        readings = [parse(linkage.text, linkage.name, linkage.name, variant) for variant in linkage.variants]
        return tuple(cast("PublishedFigure", asdict(record)) for record in compare_published(readings))


def needed(axis: Array, curves: Array, few: int, most: int) -> NDArray[np.intp]:
    """Which of the instants ``axis`` (n,) curves (k, n) need, so that straight lines between them show all they do.

    ``few`` are evenly spaced; of the others, up to ``most`` in all, those that the lines miss by most.
    """
    even = np.linspace(axis[0], axis[-1], min(few, len(axis)))
    kept = np.unique(np.append(np.abs(np.searchsorted(0.5 * (axis[1:] + axis[:-1]), even)), len(axis) - 1))
    shown = np.nan_to_num(curves, nan=0.0, posinf=0.0, neginf=0.0)
    shown = shown / np.maximum(np.max(np.abs(shown), axis=1, keepdims=True), np.finfo(float).tiny)
    for _ in range(ROUNDS):
        lines = np.array([np.interp(axis, axis[kept], curve[kept]) for curve in shown])
        missed = np.max(np.abs(lines - shown), axis=0)
        worst = np.array([low + int(np.argmax(missed[low : high + 1])) for low, high in pairwise(kept)])
        worst = worst[missed[worst] > MISSED]
        worst = worst[np.argsort(-missed[worst])][: most - len(kept)]
        if not len(worst):
            break
        kept = np.union1d(kept, worst)
    return kept
