"""A slider of the ground or a cylinder as the driver, which exudyn has no item for: a constraint by Python functions.

exudyn calls them with the coordinates of the two bodies and its own time, at position or at velocity level, and tells
the multiplier: minus the force along the driver.
"""

from __future__ import annotations

import cmath
from collections.abc import Callable, Sequence
from operator import mul
from typing import TYPE_CHECKING

import numpy as np

from analytic.description.linkage import GROUND
from engines.scene import Drive, Free, Prescribed

if TYPE_CHECKING:
    from engines.exudyn_adapter.model import Foreign, Model


class LinearDrive:
    """The span of the driver's two points from the coordinates of their bodies' nodes, reference values included.

    ``travel`` gives φ and its rate at exudyn's time by order 0 and 1; it is set anew for each part of the motion.
    """

    def __init__(self, model: Model) -> None:
        self.model, scene = model, model.scene
        self.bodies, anchors = scene.driver_ends[:2], scene.driver_ends[2:]
        self.anchors = [complex(*anchor) for anchor in anchors]
        self.along = None if scene.cylinder else complex(*scene.driven_slider.along)
        self.travel: Callable[[float, int], float] = lambda _time, _order: scene.crank_angle

    def span(self, coordinates: Sequence[float]) -> tuple[float, list[float]]:
        """φ, m, and its gradient over the coordinates of the first body's node and then of the second's."""
        between, arms, first = 0j, list[complex](), 0
        for body, anchor, sign in zip(self.bodies, self.anchors, (1.0, -1.0), strict=True):
            turns, moves = body in self.model.turning, body != GROUND
            angle = coordinates[first + 2] if turns else self.model.angles[body]
            arms.append(anchor * cmath.rect(1.0, angle))
            between += sign * (arms[-1] + (complex(coordinates[first], coordinates[first + 1]) if moves else 0j))
            first += 3 if turns else 2 if moves else 0
        length = abs(between) if self.along is None else (self.along.conjugate() * between).real
        along = between / length if self.along is None else self.along
        gradient = []
        for body, arm, sign in zip(self.bodies, arms, (1.0, -1.0), strict=True):
            whole = [sign * along.real, sign * along.imag, sign * (along.conjugate() * 1j * arm).real]
            gradient += whole[: 0 if body == GROUND else 3 if body in self.model.turning else 2]
        return length, gradient

    def reached(self, mbs: Foreign) -> float:
        """φ at the present instant, m."""
        model, variable = self.model, self.model.exudyn.OutputVariableType.Coordinates
        coordinates = list[float]()
        for body in self.bodies:
            if body != GROUND:
                node = model.nodes[body]
                place = np.atleast_1d(mbs.GetNodeOutput(node, variable))
                coordinates += (place + mbs.GetNode(node)["referenceCoordinates"]).tolist()
        return self.span(coordinates)[0]

    def add(self, drive: Drive) -> Foreign | None:
        """Add the drive; returns the item that holds a prescribed one."""
        if isinstance(drive, Prescribed):
            return self._prescribe(drive)
        self._push(drive)
        return None

    def _prescribe(self, drive: Prescribed) -> Foreign:
        model = self.model

        def of_motion(t: float, order: int) -> float:
            segments = drive.motion.segments
            return float(next((s for s in segments if t <= s.end), segments[-1]).value(t, order))

        self.travel = of_motion  # until it is set for a part

        def gap(_mbs: Foreign, t: float, _item: int, q: Foreign, q_t: Foreign, at_velocity: bool) -> list[float]:
            length, gradient = self.span(q)
            return [sum(map(mul, gradient, q_t)) - self.travel(t, 1) if at_velocity else length - self.travel(t, 0)]

        def jacobian(_mbs: Foreign, _t: float, _item: int, q: Foreign, _q_t: Foreign, _at_velocity: bool) -> Foreign:
            return np.array([self.span(q)[1]])

        ends = [model.ground if body == GROUND else model.nodes[body] for body in self.bodies]
        return model._object(
            "ConnectorCoordinateVector",
            markerNumbers=[model._marker("NodeCoordinates", nodeNumber=node) for node in ends],
            scalingMarker0=np.zeros((1, 1)),  # one equation
            constraintUserFunction=gap,
            jacobianUserFunction=jacobian,
        )

    def _push(self, drive: Free) -> None:
        model = self.model
        ends = [
            model._point(body, anchor)
            for body, anchor in zip(self.bodies, self.model.scene.driver_ends[2:], strict=True)
        ]
        if self.along is None:

            def pull(_mbs: Foreign, t: float, *_: object) -> float:
                return -float(drive.torque_at(model.begin + t))

            model._object("ConnectorSpringDamper", markerNumbers=ends, springForceUserFunction=pull)
            return
        x, y = self.along.real, self.along.imag

        def force(_mbs: Foreign, t: float, _load: Foreign) -> list[float]:
            size = float(drive.torque_at(model.begin + t))
            return [size * x, size * y, 0.0]

        model._load("ForceVector", ends[0], loadVectorUserFunction=force)
