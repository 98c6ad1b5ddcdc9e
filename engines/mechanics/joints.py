"""The joints of a scene as equations in body coordinates: residual, Jacobian and acceleration terms.

Every body has the coordinates x, y of its mass centre and, where it can turn, its angle θ. A pin holds two points
together, a slot or slider keeps a point on a line of its host, a slider keeps its angle against the host as well, and
the drive sets the driver's coordinate φ, the crank's angle: as many equations Φ(q, φ) = 0 as coordinates q, so that
motion and forces follow from one square matrix G = ∂Φ/∂q per instant:

    G q' = e,    G q̈ = γ(q, q̇) + e ε,    Gᵀ λ = M q̈ − F

with e the crank's row and λ the joint forces and, in the crank's row, the drive torque. (E. J. Haug, Computer Aided
Kinematics and Dynamics of Mechanical Systems, 1989, chapters 3 and 7, gives the method.)

The check of a start state, the ``direct`` engine and the suite's invariants share these equations. None of them shares
a formula with the closed form: no dyad is solved here, no triangle.

Lengths are counted in ``unit``, which brings the entries of G near 1. Arrays are (instants, ...); the ground is the
last body. Nothing depends on the floating type, which is that of the pose.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from analytic.description.law import FULL_TURN, Law
from analytic.description.linkage import GROUND, DriverKind, Vector
from engines.mechanics.states import (
    Driver,
    Numbers,
    Pose,
    Reals,
    Span,
    across,
    body_masses,
    body_numbers,
    dot,
    point_velocity,
    pose_of,
    start_motion,
)
from engines.scene import AppliedForce, PointSpring, Scene, TurnSpring


@dataclass(frozen=True)
class Arms:
    """Vectors of the joints at n instants, (n, ·, 2): from mass centres to anchors, between anchors, along lines.

    ``driver`` has those of a linear driver.
    """

    body: Reals
    host: Reals
    gap: Reals
    along: Reals
    driver: Span | None = None


class JointEquations:
    """The joints' equations of a scene; rows are pins in x, pins in y, lines, angles, crank.

    ``unit`` is the length that lengths are counted in, m; by default a power of two near the scene's size, which rounds
    nothing. ``geared`` pairs the names of bodies and of those against which they keep their angle; by default the
    sliders and their hosts.
    """

    def __init__(
        self, scene: Scene, unit: float | None = None, geared: Sequence[tuple[str, str]] | None = None
    ) -> None:
        """Lengths count in ``unit``, m, by default near the scene's size; bodies ``geared`` keep their angle."""
        self.scene = scene
        self.geared = [(slider.body, slider.host) for slider in scene.sliders] if geared is None else geared
        self.index = body_numbers(scene)
        self.pins, self.lines = len(scene.pins), len(scene.guided)
        self.joints = tuple(joint.name for joint in scene.joints)
        ends = [[joint.ends[side] for joint in scene.joints] for side in (0, 1)]
        self.body, self.host = (self._numbers([body for body, _ in side]) for side in ends)
        self.unit = _power_of_two(scene_size(scene)) if unit is None else unit
        self.metres = np.array([self.unit, self.unit, 1.0])  # factors from units and rad to m and rad
        self.body_anchor, self.host_anchor = (_vector_array([place for _, place in side]) / self.unit for side in ends)
        self.along = _vector_array([line.along for line in scene.guided])
        self.driver = Driver(scene, self.unit)
        self._count_coordinates()
        self._count_rows()
        self._template = self._constant_entries()

    def _numbers(self, names: list[str]) -> Numbers:
        """Numbers of the bodies with these names, as an array; the ground's is the last."""
        return np.array([self.index[name] for name in names], dtype=np.intp)

    def _count_coordinates(self) -> None:
        """Set ``free``, the free coordinates' places in the flattened (bodies, 3), their number ``size``, and ``mass``.

        ``column``, (bodies, 3), is each coordinate's number among the free ones, ``size`` for one that is fixed.
        """
        can_turn = [body.inertia is not None for body in self.scene.bodies]
        free = np.array([(True, True, turns) for turns in can_turn] + [(False, False, False)])
        self.free = np.flatnonzero(free)
        self.size = len(self.free)
        self.column = np.full(free.shape, self.size, dtype=np.intp)  # a spare last column takes what is fixed
        self.column[free] = np.arange(self.size)
        self.mass = body_masses(self.scene)

    def _count_rows(self) -> None:
        """Set the row numbers of pins, lines, kept angles and driver, and ``rows``, their count.

        Of each pair that keeps its angle, if either turns, it sets the bodies' numbers and the angle's cosine and sine.
        """
        turning = [pair for pair in self.geared if any(map(self._can_turn, pair))]
        self.turn_body = self._numbers([body for body, _ in turning])
        self.turn_host = self._numbers([host for _, host in turning])
        angle = {**{body.name: body.angle for body in self.scene.bodies}, GROUND: 0.0}
        turned = np.array([angle[body] - angle[host] for body, host in turning])
        self.turn_cosine, self.turn_sine = np.cos(turned), np.sin(turned)
        starts = np.cumsum([0, self.pins, self.pins, self.lines, len(turning)])
        self.x_rows, self.y_rows, self.line_rows, self.turn_rows = (
            np.arange(start, end) for start, end in itertools.pairwise(starts)
        )
        self.crank_row = int(starts[-1])
        self.rows = self.crank_row + 1

    def _can_turn(self, name: str) -> bool:
        """Whether a body, by its name, has an angle among the free coordinates."""
        return bool(self.column[self.index[name], 2] != self.size)

    def _constant_entries(self) -> Reals:
        """The entries of the Jacobian that no pose changes, (rows, coordinates + 1), 0 elsewhere.

        The last column takes those of fixed coordinates.
        """
        entries = np.zeros((self.rows, self.size + 1))
        pins = slice(0, self.pins)
        for rows, part in ((self.x_rows, 0), (self.y_rows, 1)):
            entries[rows, self.column[self.body[pins], part]] = 1.0
            entries[rows, self.column[self.host[pins], part]] = -1.0
        entries[self.turn_rows, self.column[self.turn_body, 2]] = 1.0
        entries[self.turn_rows, self.column[self.turn_host, 2]] = -1.0
        if self.driver.turns:
            entries[self.crank_row, self.column[self.driver.crank, 2]] = 1.0
        return entries

    def arms(self, pose: Pose) -> Arms:
        """Joint vectors, ground frame, units: arms to the joints' points, gaps, guides, and the driver's span."""
        body, host = pose.turned(self.body_anchor, self.body), pose.turned(self.host_anchor, self.host)
        gap = (pose.place[:, self.body] - pose.place[:, self.host]) + (body - host)
        return Arms(body, host, gap, pose.turned(self.along, self.host[self.pins :]), self.driver.span(pose))

    def residual(self, pose: Pose, arms: Arms) -> Reals:
        """The residual Φ of the equations, (n, rows), of a pose and its arms: lengths in units, angles by their sine.

        The driver's row is 0, since poses are made with the driver where the drive has it (``violation`` has it).
        """
        result = np.zeros((len(pose.place), self.rows), dtype=pose.place.dtype)
        result[:, self.x_rows], result[:, self.y_rows] = arms.gap[:, : self.pins, 0], arms.gap[:, : self.pins, 1]
        result[:, self.line_rows] = dot(across(arms.along), arms.gap[:, self.pins :])
        if len(self.turn_rows):
            body, host = self.turn_body, self.turn_host
            c = pose.cosine[:, body] * pose.cosine[:, host] + pose.sine[:, body] * pose.sine[:, host]
            s = pose.sine[:, body] * pose.cosine[:, host] - pose.cosine[:, body] * pose.sine[:, host]
            result[:, self.turn_rows] = s * self.turn_cosine - c * self.turn_sine
        return result

    def jacobian(self, arms: Arms) -> Reals:
        """The Jacobian G = ∂Φ/∂q of the equations, (n, rows, free coordinates), for these joint vectors."""
        entries = np.empty((len(arms.gap), *self._template.shape), dtype=arms.gap.dtype)
        entries[:] = self._template
        pins, lines = slice(0, self.pins), slice(self.pins, None)
        turn = self.column[:, 2]
        body, host = across(arms.body), across(arms.host)
        for part, rows in ((0, self.x_rows), (1, self.y_rows)):
            entries[:, rows, turn[self.body[pins]]] = body[:, pins, part]
            entries[:, rows, turn[self.host[pins]]] = -host[:, pins, part]
        normal = across(arms.along)
        for part in (0, 1):
            entries[:, self.line_rows, self.column[self.body[lines], part]] = normal[..., part]
            entries[:, self.line_rows, self.column[self.host[lines], part]] = -normal[..., part]
        entries[:, self.line_rows, turn[self.body[lines]]] = dot(normal, body[:, lines])
        # The line turns with its host: its normal's own rate is -θ' along.
        entries[:, self.line_rows, turn[self.host[lines]]] = -dot(normal, host[:, lines]) - dot(
            arms.along, arms.gap[:, lines]
        )
        if arms.driver is not None:
            entries[:, self.crank_row, : self.size] = self.gather(self.driver.gradient(arms.driver, len(entries)))
        return entries[:, :, : self.size]

    def violation(self, pose: Pose, coordinate: Reals) -> tuple[Reals, Reals]:
        """Φ with the driver at ``coordinate`` (n,), rad or units, (n, rows), and the Jacobian G there."""
        arms = self.arms(pose)
        residual = self.residual(pose, arms)
        residual[:, self.crank_row] = self.driver.value(pose) - coordinate
        return residual, self.jacobian(arms)

    def bend(self, arms: Arms, rate: Reals) -> Reals:
        """The part γ (n, rows) of G q̈ that follows from the rates (n, bodies, 3); the driver's ε is left out.

        Lengths are in units.
        """
        body, host = rate[:, self.body], rate[:, self.host]
        first, second = body[..., 2:], host[..., 2:]
        inward = first * first * arms.body - second * second * arms.host
        result = np.zeros((len(rate), self.rows), dtype=rate.dtype)
        result[:, self.x_rows], result[:, self.y_rows] = inward[:, : self.pins, 0], inward[:, : self.pins, 1]
        gap_rate = body[..., :2] - host[..., :2] + first * across(arms.body) - second * across(arms.host)
        lines = slice(self.pins, None)
        coriolis = 2.0 * second[:, lines, 0] * dot(arms.along, gap_rate[:, lines])
        result[:, self.line_rows] = dot(across(arms.along), inward[:, lines]) + coriolis
        result[:, self.crank_row] = self.driver.bend(arms.driver, rate)
        return result

    def openings(self, residual: Reals) -> Reals:
        """Opening of each joint's point, (n, joints), never negative, from a residual (n, rows) or its time derivative.

        It is in the residual's unit; a slider's turning does not count.
        """
        pins = np.hypot(residual[:, self.x_rows], residual[:, self.y_rows])
        return np.concatenate([pins, np.abs(residual[:, self.line_rows])], axis=1)

    def joint_forces(self, arms: Arms, multipliers: Reals) -> Reals:
        """Force on each joint's first body, N, ground frame, (n, joints, 2), from λ (n, rows), N."""
        forces = np.empty_like(arms.gap)
        forces[:, : self.pins, 0] = multipliers[:, self.x_rows]
        forces[:, : self.pins, 1] = multipliers[:, self.y_rows]
        forces[:, self.pins :] = multipliers[:, self.line_rows, None] * across(arms.along)
        return forces

    def generalised(self, loads: Reals) -> Reals:
        """Loads (n, bodies, 3), N and N m, along the free coordinates, (n, k), N, moments divided by the unit."""
        return self.gather(loads / np.array([1.0, 1.0, self.unit]))

    def crank_unit(self, count: int) -> Reals:
        """The unit vector e of the crank's row for each of ``count`` instants, (count, rows)."""
        result = np.zeros((count, self.rows))
        result[:, self.crank_row] = 1.0
        return result

    def spread(self, coordinates: Reals) -> Reals:
        """Values (n, k) of the free coordinates as (n, bodies, 3), 0 where a body is fixed."""
        result = np.zeros((len(coordinates), len(self.column) * 3), dtype=coordinates.dtype)
        result[:, self.free] = coordinates
        return result.reshape(len(coordinates), -1, 3)

    def gather(self, bodies: Reals) -> Reals:
        """Those entries of (n, bodies, 3) that belong to free coordinates, (n, k)."""
        return bodies.reshape(len(bodies), -1)[:, self.free]

    def start(self) -> Pose:
        """The pose of the scene's start state, one instant, lengths in units."""
        return pose_of(start_motion(self.scene)[0] / self.metres)


def scene_size(scene: Scene) -> float:
    """Largest distance, m, of a pin from the mass centre of its body, the scale for gaps; 1 without any."""
    arms = (math.hypot(*anchor) for pin in scene.pins for body, anchor in pin.ends if body != GROUND)
    return max(arms, default=0.0) or 1.0


def turn_of_driver(scene: Scene) -> float:
    """What counts as a turn of the driver: 2π rad of a crank, a travel of the scene's size, m, of a linear driver."""
    return FULL_TURN if scene.driver_kind is DriverKind.CRANK else scene_size(scene)


def _vector_array(pairs: list[Vector]) -> Reals:
    """Plane vectors as an array (n, 2), (0, 2) where there are none."""
    return np.array(pairs, dtype=float).reshape(-1, 2)


def _power_of_two(length: float) -> float:
    """The power of two nearest to a length, so that scaling by it rounds nothing; 1 for no usable length."""
    return 2.0 ** round(math.log2(length)) if length > 0.0 and math.isfinite(length) else 1.0


# The loads of a scene on its bodies, at n instants at once: gravity, applied forces and torques, springs, dampers.
#
# Everything is SI; poses are in metres.


def applied_loads(scene: Scene, pose: Pose, rate: Reals) -> Reals:
    """Weights, loads, springs and dampers, not joint friction: N and, about mass centres, N m, (n, bodies, 3).

    ``pose`` is in m, ``rate`` (n, bodies, 3) the bodies' rates, SI. Loads are in the ground frame, the last body's are
    those on the ground.
    """
    numbers = body_numbers(scene)
    loads = np.zeros_like(rate)
    loads[..., :2] = body_masses(scene)[:, :2] * np.asarray(scene.gravity)
    crank_angle = np.asarray(Driver(scene).value(pose), dtype=float)
    for applied in scene.forces:
        _add_applied_force(loads, scene, applied, pose, _law_values(scene, applied.force, crank_angle, pose, rate))
    for torque in scene.torques:
        loads[:, numbers[torque.body], 2] += _law_values(scene, torque.torque, crank_angle, pose, rate)[0]
    for damper in scene.dampers:
        first, second = numbers[damper.first], numbers[damper.second]
        drag = damper.coefficient * (rate[:, first, 2] - rate[:, second, 2])
        loads[:, first, 2] -= drag
        loads[:, second, 2] += drag
    for spring in scene.springs:
        _add_spring(loads, numbers, spring, pose, rate)
    for coil in scene.turn_springs:
        turned = coil.stiffness * _turned_from(coil, numbers, pose)
        loads[:, numbers[coil.first], 2] -= turned
        loads[:, numbers[coil.second], 2] += turned
    return loads


def force_levers(scene: Scene, applied: AppliedForce, pose: Pose) -> Iterator[Reals]:
    """Yield for each component of a force the loads of 1 N of it on the bodies, N and N m, (n, bodies, 3).

    ``pose`` is in m.
    """
    for unit in np.eye(2):
        lever = np.zeros((*pose.place.shape[:2], 3), dtype=pose.place.dtype)
        _add_applied_force(lever, scene, applied, pose, unit[:, None])
        yield lever


def _add_applied_force(loads: Reals, scene: Scene, applied: AppliedForce, pose: Pose, parts: Reals) -> None:
    """Add a force and its reaction to ``loads`` (n, bodies, 3), N and N m, in place.

    ``parts`` (2, n), N, are its components in the frame that it names; ``pose`` is in m.
    """
    numbers = body_numbers(scene)
    body, other, frame = numbers[applied.body], numbers[applied.reaction], numbers[applied.frame]
    (x, y), c, s = parts, pose.cosine[:, frame], pose.sine[:, frame]
    force = np.stack([c * x - s * y, s * x + c * y], axis=-1)
    arm = pose.arm(body, applied.anchor)
    _add_force(loads, body, arm, force)
    if applied.reaction != GROUND:
        _add_force(loads, other, pose.place[:, body] + arm - pose.place[:, other], -force)


def joint_friction(equations: JointEquations, arms: Arms, rate: Reals, multipliers: Reals) -> Reals:
    """Friction's loads on the bodies, N and N m, (n, bodies, 3), for multipliers λ (n, rows), N.

    Of ``rate`` (n, bodies, 3), which may be over any variable, the direction counts: friction is against it, and none
    at rest. Lengths of ``arms`` and ``rate`` are in the equations' unit.
    """
    result = np.zeros_like(rate)
    forces = equations.joint_forces(arms, multipliers)
    sizes = np.hypot(forces[..., 0], forces[..., 1])
    for contact in equations.scene.friction:
        joint = equations.joints.index(contact.name)
        body, host = equations.body[joint], equations.host[joint]
        if joint < equations.pins:
            turn = contact.coefficient * contact.radius * sizes[:, joint] * np.sign(rate[:, body, 2] - rate[:, host, 2])
            result[:, body, 2] -= turn
            result[:, host, 2] += turn
            continue
        along, gap = arms.along[:, joint - equations.pins], arms.gap[:, joint]
        host_arm = arms.host[:, joint] + gap  # to the point of the host where the body's anchor is
        sliding = point_velocity(arms.body[:, joint], rate[:, body]) - point_velocity(host_arm, rate[:, host])
        force = (contact.coefficient * sizes[:, joint] * np.sign(dot(along, sliding)))[:, None] * along
        _add_force(result, body, arms.body[:, joint] * equations.unit, -force)
        _add_force(result, host, host_arm * equations.unit, force)
    return result


def output_travel(scene: Scene, pose: Pose, rate: Reals) -> tuple[Reals, Reals]:
    """S, the output's travel, m, on which loads may depend, and its rate, m/s, (n,) each.

    ``pose`` and ``rate`` (n, bodies, 3) are SI; the rate may be over φ instead. Only for a scene with a ``travel``.
    """
    assert scene.travel is not None
    body, along = body_numbers(scene)[scene.travel.body], np.asarray(scene.travel.along)
    speed = point_velocity(pose.arm(body, scene.travel.anchor), rate[:, body])
    return scene.travel.zero - dot(pose.point(body, scene.travel.anchor), along), -dot(speed, along)


def _law_values(scene: Scene, law: Law, crank_angle: Reals, pose: Pose, rate: Reals) -> Reals:
    """The k components of a load's law, N or N m, at φ (n,), rad or m, or at S, (k, n); 0 where it does not act.

    ``pose`` and ``rate`` are SI.
    """
    if law.over == "phi" and law.when is None:
        return law(crank_angle)
    travel, speed = output_travel(scene, pose, rate)
    values = law(crank_angle if law.over == "phi" else travel)
    return values * ((law.when is None) | ((law.when == "advance") == (speed >= 0.0)))


def _turned_from(coil: TurnSpring, numbers: dict[str, int], pose: Pose) -> Reals:
    """Angle, rad, (n,), of a torsion spring's first body against its second less the free angle, within half a turn."""
    turned = pose.angle[:, numbers[coil.first]] - pose.angle[:, numbers[coil.second]] - coil.angle
    return np.asarray(np.pi - np.mod(np.pi - turned, 2.0 * np.pi))


def potential_energy(scene: Scene, pose: Pose) -> Reals:
    """Energy of gravity and springs, J, (n,), at poses in m; that of gravity is 0 at the ground's origin."""
    numbers, masses = body_numbers(scene), body_masses(scene)
    energy: Reals = -np.einsum("nbk,k,b->n", pose.place, np.asarray(scene.gravity), masses[:, 0])
    for spring in scene.springs:
        first = pose.point(numbers[spring.first], spring.first_anchor)
        span = first - pose.point(numbers[spring.second], spring.second_anchor)
        energy += 0.5 * spring.stiffness * (np.sqrt(dot(span, span)) - spring.length) ** 2
    for coil in scene.turn_springs:
        energy = energy + 0.5 * coil.stiffness * _turned_from(coil, numbers, pose) ** 2
    return energy


def without_potential(scene: Scene) -> Scene:
    """A copy of the scene without gravity and springs: its loads left do work that no energy stores.

    Dashpots of springs stay.
    """
    springs = tuple(replace(spring, stiffness=0.0) for spring in scene.springs if spring.damping)
    return replace(scene, gravity=(0.0, 0.0), springs=springs, turn_springs=())


def _add_force(loads: Reals, body: int, arm: Reals, force: Reals) -> None:
    """Add a force (n, 2), N, at an ``arm`` (n, 2), m, from the mass centre to the ``loads`` on a body, in place."""
    loads[:, body, :2] += force
    loads[:, body, 2] += dot(across(arm), force)


def _add_spring(loads: Reals, numbers: dict[str, int], spring: PointSpring, pose: Pose, rate: Reals) -> None:
    """Add a spring's and dashpot's pull on both of its ends to ``loads``, N and N m, in place; pose and rate are SI.

    ``numbers`` are the bodies', by name. Ends that meet are not pulled.
    """
    first, second = numbers[spring.first], numbers[spring.second]
    first_arm, second_arm = pose.arm(first, spring.first_anchor), pose.arm(second, spring.second_anchor)
    span = pose.place[:, first] + first_arm - (pose.place[:, second] + second_arm)
    span_rate = point_velocity(first_arm, rate[:, first]) - point_velocity(second_arm, rate[:, second])
    length = np.sqrt(dot(span, span))
    # Ends that meet have no direction to pull in; without a free length there is no pull either.
    direction = span / np.where(length > 0.0, length, 1.0)[:, None]
    tension = spring.stiffness * (length - spring.length) + spring.damping * dot(direction, span_rate)
    pull = -tension[:, None] * direction
    _add_force(loads, first, first_arm, pull)
    _add_force(loads, second, second_arm, -pull)
