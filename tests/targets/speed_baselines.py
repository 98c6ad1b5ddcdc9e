"""What the reference's speed is measured against: other people's code, and code written for one linkage only.

Nothing but ``tests.targets.speed`` imports this. pylinkage's own compiled path, ``step_fast_with_kinematics``
of its ``simulation.Linkage``, covers positions, velocities and accelerations of all joints, so like is compared with
like; it turns the crank by equal steps.
"""

from __future__ import annotations

import importlib.util
import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Any, Final

import numba
import numpy as np
from numpy.typing import NDArray

from analytic.description.linkage import Linkage
from analytic.dynamics.equation_of_motion import equation_of_motion
from analytic.evaluation import evaluate
from analytic.kinematics.mechanism import Mechanism
from analytic.signals import ORDERS

Array = NDArray[np.float64]

POINTS: Final = ("A", "B", "C", "D")
# The loosest of a grid (relative 1e-9 … 1e-11, absolute 1e-6 … 1e-12) that keeps φ within 1e-6 rad over 10 s of the
# driven slotted take-up: 9.8e-7 rad with 79 000 evaluations. Three times the relative tolerance gives 2.8e-6 rad.
RELATIVE, ABSOLUTE = 1e-10, 1e-8


@dataclass(frozen=True)
class SixBar:
    """Measures of the Rimoldi's shape: crank O1A, rod AB, rocker CBO2, link CD, D on a vertical line.

    A rocker's C is a multiple of its B, both seen from O2.
    """

    crank: float
    rod: float
    rocker: float
    pivot: tuple[float, float]
    opposite: float
    link: float
    line: float


def six_bar(linkage: Linkage) -> SixBar:
    """The measures of a linkage of that shape, m."""
    bodies = linkage.links
    b, c = bodies["rocker"].points["B"], bodies["rocker"].points["C"]
    (slider,) = linkage.sliders
    return SixBar(
        crank=math.hypot(*bodies["crank"].points["A"]),
        rod=math.hypot(*bodies["rod"].points["B"]),
        rocker=math.hypot(*b),
        pivot=linkage.ground["O2"],
        opposite=c[0] / b[0],
        link=math.hypot(*bodies["link"].points["D"]),
        line=slider.guide.through[0],
    )


def has_pylinkage() -> bool:
    """Whether pylinkage is installed."""
    return importlib.util.find_spec("pylinkage") is not None


def pylinkage_motion(measures: SixBar, step: float, count: int) -> Callable[[], tuple[Array, ...]]:
    """The compiled run of pylinkage over ``count`` steps of the crank, ready to be called again and again.

    A call gives positions, velocities and accelerations at a crank speed of 1 rad/s, each (count, joints, 2), the last
    four joints A to D; the first run starts one step after φ = 0, the next one where it ended.
    """
    from pylinkage.actuators import Crank  # noqa: PLC0415 - wanted for the benchmark only
    from pylinkage.components import Ground  # noqa: PLC0415
    from pylinkage.dyads import FixedDyad, RRPDyad, RRRDyad  # noqa: PLC0415
    from pylinkage.simulation import Linkage as Theirs  # noqa: PLC0415

    (x, y), r, line = measures.pivot, measures.rocker, measures.line
    o1, o2 = Ground(0.0, 0.0, name="O1"), Ground(x, y, name="O2")
    low, high = Ground(line, 0.0, name="low"), Ground(line, 1.0, name="high")
    a = Crank(anchor=o1, radius=measures.crank, angular_velocity=step, initial_angle=0.0, name="A")
    b = RRRDyad(a.output, o2, measures.rod, r, x=x - r, y=y, name="B")
    turned = 0.0 if measures.opposite > 0.0 else math.pi
    c = FixedDyad(o2, b, abs(measures.opposite) * r, turned, name="C")
    d = RRPDyad(c, low, high, measures.link, x=line, y=y - measures.link, name="D")
    theirs: Any = Theirs((o1, o2, low, high, a, b, c, d))
    theirs.set_input_velocity(a, omega=1.0)

    def run() -> tuple[Array, ...]:
        return tuple(theirs.step_fast_with_kinematics(iterations=count))

    return run


def _six_bar_motion(measures: tuple[float, ...], angle: Array, places: Array) -> None:
    """A to D and their derivatives over φ into ``places`` (points, orders, 2, angles)."""
    r, l, k, px, py, f, m, line = measures  # noqa: E741
    for i in range(len(angle)):
        ax, ay = r * math.cos(angle[i]), r * math.sin(angle[i])
        dx, dy = px - ax, py - ay
        square = 1.0 / (dx * dx + dy * dy)
        along = 0.5 + 0.5 * (l * l - k * k) * square
        across = math.sqrt(l * l * square - along * along)
        rx, ry = along * dx - across * dy, along * dy + across * dx
        bx, by = ax + rx, ay + ry
        qx, qy = bx - px, by - py
        scale = 1.0 / (rx * qy - ry * qx)
        w1, w2 = (ay * qx - ax * qy) * scale, (ay * rx - ax * ry) * scale
        vx, vy = -w2 * qy, w2 * qx
        gx, gy = w2 * w2 * qx - w1 * w1 * rx - ax, w2 * w2 * qy - w1 * w1 * ry - ay
        turn = -(gx * rx + gy * ry) * scale
        ux, uy = -turn * qy - w2 * w2 * qx, turn * qx - w2 * w2 * qy
        ex = line - px - f * qx
        ey = -math.sqrt(m * m - ex * ex)
        w = f * vx / ey
        slew = (f * ux - w * w * ex) / ey
        places[0, 0, 0, i], places[0, 0, 1, i] = ax, ay
        places[0, 1, 0, i], places[0, 1, 1, i] = -ay, ax
        places[0, 2, 0, i], places[0, 2, 1, i] = -ax, -ay
        places[1, 0, 0, i], places[1, 0, 1, i] = bx, by
        places[1, 1, 0, i], places[1, 1, 1, i] = vx, vy
        places[1, 2, 0, i], places[1, 2, 1, i] = ux, uy
        places[2, 0, 0, i], places[2, 0, 1, i] = px + f * qx, py + f * qy
        places[2, 1, 0, i], places[2, 1, 1, i] = f * vx, f * vy
        places[2, 2, 0, i], places[2, 2, 1, i] = f * ux, f * uy
        places[3, 0, 0, i], places[3, 0, 1, i] = line, py + f * qy + ey
        places[3, 1, 0, i], places[3, 1, 1, i] = 0.0, f * vy + w * ex
        places[3, 2, 0, i], places[3, 2, 1, i] = 0.0, f * uy + slew * ex - w * w * ey


_six_bar_kernel: Callable[[tuple[float, ...], Array, Array], None] = numba.njit(
    cache=True, error_model="numpy", fastmath=True
)(_six_bar_motion)


def hand_written_motion(measures: SixBar, angle: Array) -> Callable[[], Array]:
    """The kernel that knows no other linkage, at crank angles, rad; a call gives (points, orders, 2, angles)."""
    m = measures
    numbers = (m.crank, m.rod, m.rocker, *m.pivot, m.opposite, m.link, m.line)

    def run() -> Array:
        places = np.empty((len(POINTS), 3, 2, len(angle)))
        _six_bar_kernel(numbers, angle, places)
        return places

    return run


def our_motion(mechanism: Mechanism, angle: Array) -> Callable[[], dict[str, Array]]:
    """The machine code of any linkage, at crank angles, rad; a call gives points, orders and x, y by their names."""
    names = [f"point:{name}:{component}" for name in POINTS for component in ORDERS]
    return partial(evaluate, mechanism, angle, names, speed=1.0, cores=1, path="compiled")


def dop853(
    mechanism: Mechanism, torque: float, start: tuple[float, float], duration: float
) -> Callable[[], tuple[Array, Array]]:
    """SciPy's DOP853 with the NumPy closed form as right-hand side; a call gives its instants, s, and φ there, rad."""
    from scipy.integrate import solve_ivp  # noqa: PLC0415 - slow to import

    equation = equation_of_motion(mechanism, torque)

    def rate(_time: float, state: Array) -> tuple[float, float]:
        moment, damping, slope = equation.closed_form(state[0])
        speed = float(state[1])
        return speed, float(moment) - speed * (float(damping) + float(slope) * speed)

    def run() -> tuple[Array, Array]:
        found = solve_ivp(rate, (0.0, duration), start, "DOP853", rtol=RELATIVE, atol=ABSOLUTE)
        return found.t, found.y[0]

    return run
