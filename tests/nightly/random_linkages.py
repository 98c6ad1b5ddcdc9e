"""Random valid linkages in every engine: how often tuned fails, and whether a wrong motion ever passes unseen.

Four-bars, offset slider-cranks, quick returns and six-bars; sizes and masses over four decades, each with a
transmission angle that a designer would accept.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field

import numpy as np

from analytic.description.crank_motion import crank_motion
from analytic.description.loading import parse
from analytic.errors import LinkproofError
from analytic.kinematics.mechanism import Mechanism
from comparisons.motion.case import Case
from comparisons.trials.runs.run_engine import Bounds, Lost, run_engine
from comparisons.trials.runs.workers import LocalPool
from comparisons.trials.stress.cells import Cell, StressVerdict, judged
from engines.contract import Setting
from engines.registry import engine
from engines.scene import Channel

KINDS = ("four-bar", "slider-crank", "quick return", "six-bar")
SEED = 9
MODERATE = 30.0  # mass ratio within a linkage up to which every engine is to hold
STEEPEST = math.radians(25.0)  # least transmission angle
HEAD = 'title = "{kind}"\nsource = "drawn"\ncrank = "crank"\ngravity = [0.7, -9.7]\n'
HEAD += 'units = {{ length = "m", mass = "kg", inertia = "kg*m^2", angle = "rad" }}\n'
SECONDS = 60.0  # that a run may take


@dataclass(frozen=True)
class Drawn:
    """One linkage, its kind and the ratio of its largest to its least mass."""

    kind: str
    ratio: float
    text: str


def draw(number: int, largest_ratio: float = MODERATE) -> Drawn:
    """The linkage of a number: the same on every machine."""
    for attempt in range(1000):
        rng = np.random.default_rng([SEED, number, attempt])
        kind = KINDS[number % len(KINDS)]
        text, ratio = _text(kind, rng, largest_ratio)
        try:
            mechanism = Mechanism(parse(text, f"drawn-{number}", "drawn"))
            mechanism.check_full_turn()
        except LinkproofError:
            continue
        if _steep(mechanism) >= STEEPEST:
            return Drawn(kind, ratio, text)
    raise RuntimeError(f"no valid linkage of number {number}")


def _steep(mechanism: Mechanism) -> float:
    """Least transmission angle of any dyad over a turn, rad, from how its determinant compares with its largest."""
    sweep = mechanism.turn
    angles = [np.abs(np.sin(np.asarray(angle))) for angle in _between(sweep, mechanism)]
    return float(math.asin(min((float(np.min(each)) for each in angles), default=1.0)))


def _between(sweep: object, mechanism: Mechanism) -> Iterator[np.ndarray]:
    """Angles between the two lines along which a dyad's members hold its inner joint."""
    linkage = mechanism.linkage
    turn = {name: sweep.angles(name) for name in linkage.links}  # type: ignore[attr-defined]
    slides = {slider.link: math.atan2(slider.guide.along[1], slider.guide.along[0]) for slider in linkage.sliders}
    if "rocker" in turn and "coupler" in turn:
        yield turn["coupler"] - turn["rocker"]
    if "rod" in turn and "piston" in slides:
        yield turn["rod"] - slides["piston"] - math.pi / 2.0


SLOT = 'point = "A", on = "rocker", through = [0, 0], along = [1, 0]'


class _Drawing:
    """A linkage drawn at random: its sizes and masses, and the parts of its file so far."""

    def __init__(self, rng: np.random.Generator, largest_ratio: float) -> None:
        self.rng = rng
        self.size, base = 10.0 ** rng.uniform(-3.0, 1.0), 10.0 ** rng.uniform(-3.0, 1.0)
        self.masses = base * 10.0 ** rng.uniform(0.0, math.log10(largest_ratio), 6)
        self.links: list[str] = []
        self.ground, self.sketch, self.slots = {"O": (0.0, 0.0)}, dict[str, tuple[float, float]](), ""
        self.crank = self.size * rng.uniform(0.6, 1.0)
        self.link("crank", {"O": 0.0, "A": self.crank})
        self.frame = self.crank * rng.uniform(1.8, 4.0)

    def link(self, name: str, points: dict[str, float], slides: str = "") -> None:
        """Add a link with points on its x axis, or one that slides."""
        rng, mass = self.rng, float(self.masses[len(self.links)])
        length = max([*points.values(), 0.3 * self.size])
        centre = (0.0, 0.0) if rng.random() < 0.15 else (rng.uniform(-0.2, 1.0), rng.uniform(-0.2, 0.2))
        inertia = mass * length**2 * 10.0 ** rng.uniform(-2.7, -0.7)  # from 0.2 % of m l²
        places = ", ".join(f"{point} = [{x!r}, 0]" for point, x in points.items())
        rest = f"centre = [{centre[0] * length!r}, {centre[1] * length!r}]\ninertia = {inertia!r}"
        if slides:
            rest = f"slides = {{ {slides} }}" + (f"\ninertia = {inertia!r}" if name == "block" else "")
        shape = f"points = {{ {places} }}\n" if points else ""
        self.links.append(f"[links.{name}]\n{shape}mass = {mass!r}\n{rest}\n")

    def four_bar(self, rocker_points: Callable[[float], dict[str, float]] = lambda _: {}) -> float:
        """Add coupler and rocker, which has points by its length; returns that length."""
        coupler, rocker = (self.crank * self.rng.uniform(2.0, 4.0) for _ in range(2))
        self.ground["C"] = (self.frame, 0.0)
        self.link("coupler", {"A": 0.0, "B": coupler})
        self.link("rocker", {"C": 0.0, "B": rocker} | rocker_points(rocker))
        along = ((self.frame - self.crank) ** 2 + coupler**2 - rocker**2) / (2.0 * (self.frame - self.crank))
        self.sketch["B"] = (self.crank + along, math.sqrt(max(coupler**2 - along**2, 0.0)))
        return rocker

    def six_bar(self) -> None:
        """Add a four-bar whose rocker pushes a piston."""
        rocker = self.four_bar(lambda length: {"E": 0.8 * length})
        (x, y), share = self.sketch["B"], 0.8
        x, y = self.frame + share * (x - self.frame), share * y
        rod, height = rocker * self.rng.uniform(2.5, 5.0), rocker * self.rng.uniform(0.2, 0.6)
        self.sketch["D"] = (x + math.sqrt(rod**2 - (height - y) ** 2), height)
        self.piston({"E": 0.0, "D": rod}, height)

    def slider_crank(self) -> None:
        """Add a rod on the crank and an offset piston."""
        rod, height = self.crank * self.rng.uniform(2.5, 6.0), self.crank * self.rng.uniform(-0.8, 0.8)
        self.sketch["D"] = (self.crank + math.sqrt(rod**2 - height**2), height)
        self.piston({"A": 0.0, "D": rod}, height)

    def piston(self, rod: dict[str, float], height: float) -> None:
        """Add a rod and a piston at its point D."""
        self.link("rod", rod)
        self.link("piston", {}, f'point = "D", through = [0, {height!r}], along = [1, 0]')

    def quick_return(self) -> None:
        """Add a slotted rocker, its pin with or without a block."""
        self.ground["C"], self.sketch["E"] = (-self.frame, 0.0), (1.2 * self.crank + 0.2 * self.frame, 0.0)
        self.link("rocker", {"C": 0.0, "E": 1.2 * (self.crank + self.frame)})
        if self.rng.random() < 0.5:
            self.link("block", {}, SLOT)
        else:
            self.slots = f"slots = [{{ {SLOT} }}]\n"

    def text(self, kind: str) -> str:
        """The linkage's file."""
        ground = "".join(f"{name} = [{x!r}, {y!r}]\n" for name, (x, y) in self.ground.items())
        places = ", ".join(f"{name} = [{x!r}, {y!r}]" for name, (x, y) in self.sketch.items())
        links = "".join(self.links)
        head = HEAD.format(kind=kind) + self.slots
        return f"{head}[ground]\n{ground}{links}[sketch]\nangle = 0\npoints = {{ {places} }}\n"


def _text(kind: str, rng: np.random.Generator, largest_ratio: float) -> tuple[str, float]:
    """A linkage file and its mass ratio."""
    drawing = _Drawing(rng, largest_ratio)
    getattr(drawing, kind.replace(" ", "_").replace("-", "_"))()
    return drawing.text(kind), float(math.exp(np.ptp(np.log(drawing.masses[: len(drawing.links)]))))


@dataclass
class Tally:
    """Numbers of the runs of one engine by verdict."""

    verdicts: Counter[StressVerdict] = field(default_factory=Counter)

    def __str__(self) -> str:
        return ", ".join(f"{number} {verdict}" for verdict, number in self.verdicts.most_common())

    @property
    def failing(self) -> float:
        """Share of the runs that the engine takes which failed or are over a limit."""
        taken = sum(self.verdicts.values()) - self.verdicts[StressVerdict.UNSUPPORTED]
        return 1.0 - self.verdicts[StressVerdict.WITHIN] / taken if taken else math.nan


def run(number: int, name: str, largest_ratio: float) -> str:
    """Verdict on one linkage in one engine."""
    drawn = draw(number, largest_ratio)
    motion = crank_motion("run-up-quintic", ramp_time=0.15, hold_time=0.06, start_angle=0.1)
    case = Case(Mechanism(parse(drawn.text, f"drawn-{number}", "drawn")), motion)
    model = case.scene(frozenset(Channel))
    names = (case.mechanism.linkage.name, "", "", "", name, "", Setting.TUNED)
    cell, adapter = Cell(*names, axis=drawn.kind, row="", value=number), engine(name)
    return judged(cell, case, model, run_engine(adapter, model, Setting.TUNED), adapter).verdict.value


def tallies(count: int, engines: Sequence[str], largest_ratio: float = MODERATE) -> dict[str, Tally]:
    """The runs of linkages 0 … count − 1 in these engines."""
    jobs = [(number, name, largest_ratio) for number in range(count) for name in engines]
    found = {name: Tally() for name in engines}
    for job, result in LocalPool().run(run, jobs, bounds=Bounds(seconds=SECONDS)):
        verdict = result.outcome.value if isinstance(result, Lost) else result
        found[jobs[job][1]].verdicts[StressVerdict(verdict)] += 1
    return found
