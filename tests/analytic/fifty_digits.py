"""A second derivation of every reference quantity, in 50 digits, that shares no formula with the closed form.

The linkage becomes rigid bodies in absolute coordinates (x, y, θ of every link's frame) with one equation per pin
component, slider, slot and for the crank's angle. Newton's iteration solves them, from a rounded start, with a Jacobian
of double precision: each step gains some fifteen digits. All derivatives over φ are central differences of such
solutions, and the reduced quantities follow from energies and virtual work.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from functools import lru_cache

import numpy as np
from mpmath import mp, mpf

from analytic.description.law import Law
from analytic.description.linkage import GROUND, Guide, Linkage, Vector
from analytic.kinematics.mechanism import Mechanism
from analytic.kinematics.sweep import Sweep
from analytic.signals import evaluate

DIGITS = 50
STEP = mpf(10) ** -12  # of φ: central differences err by its square and lose 24 digits of 50
STENCIL = range(-2, 3)


class Frames:
    """Where every link is: x, y, θ and the cosine and sine of θ."""

    def __init__(self, linkage: Linkage, coordinates: Sequence[mpf]) -> None:
        self.linkage = linkage
        self.coordinates = list(coordinates)
        self.of = {GROUND: (mpf(0), mpf(0), mpf(0), mpf(1), mpf(0))}
        for number, name in enumerate(linkage.links):
            x, y, angle = self.coordinates[3 * number : 3 * number + 3]
            self.of[name] = (x, y, angle, *mp.cos_sin(angle))

    def turned(self, body: str, local: Vector) -> tuple[mpf, mpf]:
        """A vector of a body in the ground frame."""
        *_, c, s = self.of[body]
        a, b = map(mpf, local)
        return c * a - s * b, s * a + c * b

    def place(self, body: str, local: Vector) -> tuple[mpf, mpf]:
        """A point of a body in the ground frame."""
        x, y, *_ = self.of[body]
        a, b = self.turned(body, local)
        return x + a, y + b

    def local(self, body: str, place: tuple[mpf, mpf]) -> tuple[mpf, mpf]:
        """A place of the ground frame in a body's own axes."""
        x, y, _, c, s = self.of[body]
        a, b = place[0] - x, place[1] - y
        return c * a + s * b, c * b - s * a

    def named(self, point: str, body: str) -> tuple[mpf, mpf]:
        """A named point as a body carries it."""
        return self.place(body, self.linkage.local(point, body))

    def angle(self, body: str) -> mpf:
        """Angle of a body."""
        return self.of[body][2]

    def length(self, points: tuple[str, str], links: tuple[str, str]) -> mpf:
        """Distance between two named points."""
        (x, y), (u, v) = (self.named(point, body) for point, body in zip(points, links, strict=True))
        return mp.sqrt((x - u) ** 2 + (y - v) ** 2)

    def potential(self) -> mpf:
        """Energy of gravity and springs."""
        gx, gy = map(mpf, self.linkage.gravity)
        total = mpf(0)
        for name, link in self.linkage.links.items():
            x, y = self.place(name, link.centre)
            total -= mpf(link.mass) * (gx * x + gy * y)
        for spring in self.linkage.springs:
            stretch = self.length(spring.points, spring.links) - mpf(spring.length)
            total += mpf(spring.stiffness) * stretch**2 / 2
        return total


class Exact:
    """One linkage at one crank angle, in the assembly mode of the sweep it starts from."""

    def __init__(self, sweep: Sweep) -> None:
        mp.dps = DIGITS
        self.linkage: Linkage = sweep.linkage
        self.zero_of_s = sweep.zero_of_s
        self.angle = sweep.angle if isinstance(sweep.angle, mpf) else mpf(float(sweep.angle))
        start = _start(sweep)
        self.inverse = np.linalg.inv(_jacobian(self.linkage, start))
        self.states = {k: self._solved(start, self.angle + k * STEP) for k in STENCIL}

    def _solved(self, start: Sequence[float], angle: mpf) -> Frames:
        """Newton's iteration with one Jacobian, until the equations hold to the last digits."""
        frames = Frames(self.linkage, [mpf(q) for q in start])
        for _ in range(30):
            residual = list(equations(frames, angle))
            size = max(map(abs, residual))
            if size < mpf(10) ** (4 - DIGITS):
                return frames
            change = self.inverse @ np.array([float(r / size) for r in residual])
            moved = [q - size * mpf(float(d)) for q, d in zip(frames.coordinates, change, strict=True)]
            frames = Frames(self.linkage, moved)
        raise ArithmeticError(f"Newton's iteration of '{self.linkage.name}' does not converge: {size}")

    def differences(self, quantity: Callable[[Frames], mpf]) -> tuple[mpf, mpf, mpf]:
        """A quantity with its first and second derivative over φ."""
        before, here, after = (quantity(self.states[k]) for k in (-1, 0, 1))
        return here, (after - before) / (2 * STEP), (after - 2 * here + before) / STEP**2

    def point(self, body: str, local: Vector) -> tuple[tuple[mpf, mpf, mpf], ...]:
        """Coordinates x and y of a point, each with two derivatives."""
        before, here, after = (self.states[k].place(body, local) for k in (-1, 0, 1))
        return tuple(
            (q, (r - p) / (2 * STEP), (r - 2 * q + p) / STEP**2) for p, q, r in zip(before, here, after, strict=True)
        )

    def turn(self, body: str) -> tuple[mpf, mpf, mpf]:
        """Angle of a body with two derivatives."""
        return self.differences(lambda frames: frames.angle(body))

    def inertia(self, at: int = 0) -> mpf:
        """Jeq = 2 T / ω², from the velocities for unit crank speed at a place of the stencil."""
        ends = self.states[at - 1], self.states[at + 1]
        total = mpf(0)
        for name, link in self.linkage.links.items():
            before, after = ((*frames.place(name, link.centre), frames.angle(name)) for frames in ends)
            vx, vy, w = ((b - a) / (2 * STEP) for a, b in zip(before, after, strict=True))
            total += mpf(link.mass) * (vx**2 + vy**2) + mpf(link.inertia or 0.0) * w**2
        return total

    def half_slope(self) -> mpf:
        """½ Jeq', a difference of Jeq itself."""
        return (self.inertia(1) - self.inertia(-1)) / (4 * STEP)

    def force(self, speed: float = 1.0) -> mpf:
        """Q: minus the slope of the potential, plus the virtual work of forces and torques."""
        total = -self.differences(Frames.potential)[1]
        for body, local, fx, fy, moment in self.loads(speed):
            if body != GROUND:
                x, y = self.point(body, local)
                total += fx * x[1] + fy * y[1] + moment * self.turn(body)[1]
        return total

    def loads(self, speed: float = 1.0) -> Iterator[tuple[str, tuple[mpf, mpf], mpf, mpf, mpf]]:
        """Of every applied load and its reaction: body, point in its own axes, force and moment in the ground frame."""
        here, none = self.states[0], (mpf(0), mpf(0))
        for force in self.linkage.forces:
            point = self.linkage.local(force.point, force.link)
            fx, fy = here.turned(force.frame, self.law(force.force, speed))
            yield force.link, point, fx, fy, mpf(0)
            if force.reaction:
                yield force.reaction, here.local(force.reaction, here.place(force.link, point)), -fx, -fy, mpf(0)
        for torque in self.linkage.torques:
            (moment,) = self.law(torque.torque, speed)
            yield torque.link, none, mpf(0), mpf(0), moment
            if torque.reaction:
                yield torque.reaction, none, mpf(0), mpf(0), -moment

    def law(self, law: Law, speed: float) -> list[mpf]:
        """Components of a load's law where the linkage is, each in double precision."""
        if law.over == "phi" and not law.when:
            return [mpf(float(part)) for part in law(float(self.angle))]
        output = self.linkage.output
        place = self.point(output.link, self.linkage.local(output.point, output.link))
        height, rate, _ = (sum(mpf(c) * q[k] for c, q in zip(output.along, place, strict=True)) for k in range(3))
        if law.when and (law.when == "advance") != (
            rate * speed < 0
        ):  # S grows while the point goes back along the output
            return [mpf(0)] * len(law(0.0))
        return [mpf(float(part)) for part in law(float(self.angle if law.over == "phi" else self.zero_of_s() - height))]

    def damping(self) -> mpf:
        """Damping reduced to the crank: twice the dissipation at unit speed."""
        total = mpf(0)
        for damper in self.linkage.dampers:
            one, two = (self.turn(body)[1] for body in damper.links)
            total += mpf(damper.coefficient) * (one - two) ** 2
        for spring in self.linkage.springs:
            rate = self.differences(lambda frames, s=spring: frames.length(s.points, s.links))[1]
            total += mpf(spring.damping) * rate**2
        return total

    def torque(self, speed: float, acceleration: float) -> mpf:
        """Mkr that the crank's motion takes."""
        moving = self.inertia() * mpf(acceleration) + self.half_slope() * mpf(speed) ** 2
        return moving + self.damping() * mpf(speed) - self.force(speed)


@lru_cache(maxsize=512)
def exact(mechanism: Mechanism, angle: float) -> Exact:
    """A linkage in its own assembly mode at one crank angle, rad; kept, since several tests look at the same ones."""
    return Exact(mechanism.sweep(angle))


def equations(frames: Frames, angle: mpf) -> Iterator[mpf]:
    """What has to vanish: 2 per body on a pin after the first, 2 per slider, 1 per slot, and the crank's angle."""
    linkage = frames.linkage
    for pin in linkage.pins:
        ends = [frames.named(pin.point, body) for body in pin.links]
        for x, y in ends[1:]:
            yield x - ends[0][0]
            yield y - ends[0][1]
    for slider in linkage.sliders:
        yield _off(frames, frames.named(slider.point, slider.link), slider.guide)
        tilt = frames.angle(slider.link) - frames.angle(slider.guide.host)
        tilt -= mp.atan2(*map(mpf, reversed(slider.guide.along)))
        yield tilt - 2 * mp.pi * mp.nint(tilt / (2 * mp.pi))
    for slot in linkage.slots:
        carriers = [name for name, link in linkage.links.items() if slot.point in link.points]
        carrier = GROUND if slot.point in linkage.ground else carriers[0]
        yield _off(frames, frames.named(slot.point, carrier), slot.guide)
    yield _driven(frames) - angle


def _driven(frames: Frames) -> mpf:
    """The coordinate of the driver: a crank's angle, a slider's travel, a cylinder's length."""
    linkage = frames.linkage
    if getattr(linkage, "cylinder", None) is not None:
        return frames.length(linkage.cylinder.points, linkage.cylinder.links)
    slider = next((s for s in linkage.sliders if s.link == linkage.crank and s.guide.host == GROUND), None)
    if slider is None:
        return frames.angle(linkage.crank)
    (x, y), (c, s) = frames.named(slider.point, slider.link), map(mpf, slider.guide.along)
    return ((x - mpf(slider.guide.through[0])) * c + (y - mpf(slider.guide.through[1])) * s) / mp.hypot(c, s)


def _off(frames: Frames, place: tuple[mpf, mpf], guide: Guide) -> mpf:
    """Distance of a place from a guide's line."""
    x, y = frames.place(guide.host, guide.through)
    c, s = frames.turned(guide.host, guide.along)
    return (c * (place[1] - y) - s * (place[0] - x)) / mp.hypot(c, s)


def _start(sweep: Sweep) -> list[float]:
    """The closed form's poses in single precision: near enough to stay in the assembly mode, no nearer."""
    start: list[float] = []
    for name in sweep.linkage.links:
        x, y, c, s = (float(part) for part in sweep.poses(name))
        turns = name == sweep.linkage.crank and not sweep.linkage.is_linear
        angle = float(sweep.angle) if turns else np.arctan2(s, c)
        start += [float(np.float32(part)) for part in (x, y, angle)]
    return start


def _jacobian(linkage: Linkage, start: Sequence[float]) -> np.ndarray:
    """Derivatives of the equations by the coordinates, by differences."""
    tiny = mpf(10) ** -20
    state = [mpf(q) for q in start]
    zero = list(equations(Frames(linkage, state), mpf(0)))
    columns = []
    for i in range(len(state)):
        moved = list(equations(Frames(linkage, [*state[:i], state[i] + tiny, *state[i + 1 :]]), mpf(0)))
        columns.append([float((a - b) / tiny) for a, b in zip(moved, zero, strict=True)])
    return np.array(columns).T


# Signals of a linkage in many digits, its joint forces too: Lagrange's multipliers of its equations.


TINY = mpf(10) ** -20  # m or rad, of differences of the equations
SAME = mpf(10) ** -40
Push = tuple[str, tuple[mpf, mpf], mpf, mpf, mpf]  # body, point in its own axes, force and moment in the ground's


def signals_of(exact: Exact, speed: float) -> dict[str, mpf]:
    """Torque, energies, points and angles by the names of ``analytic.signals`` at constant speed, rad/s."""
    w, linkage = mpf(speed), exact.linkage
    inertia, torque = exact.inertia(), exact.torque(speed, 0.0)
    outcome = {"Jeq": inertia, "Mkr": torque, "Peq": torque * w, "Teq": inertia * w * w / 2}
    for name, link in linkage.links.items():
        outcome |= zip(
            [f"link:{name}:{one}" for one in ("angle", "omega", "alpha")], _timed(exact.turn(name), w), strict=True
        )
        for point, local in link.points.items():
            x, y = (_timed(one, w) for one in exact.point(name, local))
            parts = zip((x[0], y[0], x[1], y[1], x[2], y[2]), ("x", "y", "vx", "vy", "ax", "ay"), strict=True)
            outcome |= {f"point:{point}:{part}": value for value, part in parts}
    if linkage.output is not None:
        x, y = (
            _timed(one, w)
            for one in exact.point(linkage.output.link, linkage.local(linkage.output.point, linkage.output.link))
        )
        c, s = map(mpf, linkage.output.along)
        outcome |= {"v": -(c * x[1] + s * y[1]), "a": -(c * x[2] + s * y[2])}
    return outcome


def _timed(parts: tuple[mpf, mpf, mpf], speed: mpf) -> tuple[mpf, mpf, mpf]:
    return parts[0], parts[1] * speed, parts[2] * speed**2


def forces_of(exact: Exact, speed: float) -> dict[str, mpf]:
    """Joint forces by the names of ``analytic.signals``: what the multipliers of a joint do to the body it acts on.

    The drive's torque is among them. Friction is put in again and again until no force changes in 40 digits.
    """
    slopes, before = _slopes(exact.states[0], exact.angle), dict[str, mpf]()
    found = dict(_forces(exact, slopes, mpf(speed), ()))
    while exact.linkage.friction and max(abs(f - before.get(k, 0)) for k, f in found.items()) > SAME * abs(
        found["Mkr"]
    ):
        before, found = found, dict(_forces(exact, slopes, mpf(speed), _friction(exact, mp.sign(speed), found)))
    return found


def errors_at(mechanism: Mechanism, angles: np.ndarray, number: int, speed: float) -> dict[str, float]:
    """Errors of torque and joint forces by name at one of crank angles, rad, over the peaks among all of these.

    All joint forces have one peak.
    """
    truth = forces_of(Exact(mechanism.sweep(angles[number])), speed)
    found = evaluate(mechanism, angles, list(truth), speed=speed)
    peaks = {name: np.max(np.abs(values)) for name, values in found.items()}
    force = max(peak for name, peak in peaks.items() if name != "Mkr")
    return {
        name: abs(float(mpf(float(found[name][number])) - value)) / (peaks[name] if name == "Mkr" else force)
        for name, value in truth.items()
    }


def _friction(exact: Exact, sense: int, forces: Mapping[str, mpf]) -> Iterator[Push]:
    """What friction is on every body where the joints have these ``forces``, for a crank that turns in a ``sense``."""
    linkage, here, none = exact.linkage, exact.states[0], (mpf(0), mpf(0))
    rubs = {joint: (mpf(own.coefficient), mpf(own.radius)) for joint, own in linkage.friction.items()}
    for pin in linkage.pins if rubs else ():
        for joint, link in pin.joints.items() if pin.point in rubs else ():
            size = mp.hypot(*(forces[f"joint_force:{joint}:{axis}"] for axis in "xy"))
            moment = mp.fprod(rubs[pin.point]) * size * sense * mp.sign(exact.turn(link)[1] - exact.turn(pin.hub)[1])
            yield from ((link, none, mpf(0), mpf(0), -moment), (pin.hub, none, mpf(0), mpf(0), moment))
    guided = [(slider, slider.link, slider.link) for slider in linkage.sliders]
    for slot in linkage.slots:
        carriers = (GROUND, *linkage.links)
        body = next(b for b in carriers if b != slot.guide.host and slot.point in _points(linkage, b))
        guided.append((slot, slot.name, body))
    for joint, key, body in guided:
        if key in rubs:
            size = mp.hypot(*(forces[f"joint_force:{joint.name}:{axis}"] for axis in "xy"))
            host, local, along = joint.guide.host, linkage.local(joint.point, body), joint.guide.along

            def slid(frames: Frames, host=host, body=body, local=local, along=along) -> mpf:
                return mp.fdot(along, frames.local(host, frames.place(body, local)))

            force = -sense * rubs[key][0] * size * mp.sign(exact.differences(slid)[1])
            x, y = (force * part / mp.hypot(*along) for part in here.turned(host, along))
            yield from ((body, local, x, y, mpf(0)), (host, here.local(host, here.place(body, local)), -x, -y, mpf(0)))


def _points(linkage: Linkage, body: str) -> Mapping[str, Vector]:
    return linkage.ground if body == GROUND else linkage.links[body].points


def _forces(exact: Exact, slopes: mp.matrix, speed: mpf, pushes: Iterable[Push]) -> Iterator[tuple[str, mpf]]:
    linkage, bodies = exact.linkage, list(exact.linkage.links)
    multipliers = mp.lu_solve(slopes.T, -_loads(exact, speed, pushes))
    yield "Mkr", multipliers[len(multipliers) - 1]

    def on(body: str, rows: range) -> tuple[mpf, mpf]:
        column = 3 * bodies.index(body)
        return tuple(sum(multipliers[r] * slopes[r, column + part] for r in rows) for part in (0, 1))

    row = 0
    for pin in linkage.pins:
        rows = range(row, row := row + 2 * len(pin.links) - 2)
        for joint, link in pin.joints.items():
            yield from zip((f"joint_force:{joint}:x", f"joint_force:{joint}:y"), on(link, rows), strict=True)
    for slider in linkage.sliders:
        force = on(slider.link, range(row, row := row + 2))
        yield from zip((f"joint_force:{slider.name}:x", f"joint_force:{slider.name}:y"), force, strict=True)
    for slot in linkage.slots:
        host = slot.guide.host
        rows = range(row, row := row + 1)
        carriers = [name for name, link in linkage.links.items() if slot.point in link.points]
        force = on(carriers[0], rows) if slot.point not in linkage.ground else tuple(-f for f in on(host, rows))
        yield from zip((f"joint_force:{slot.name}:x", f"joint_force:{slot.name}:y"), force, strict=True)


def _slopes(here: Frames, angle: mpf) -> mp.matrix:
    """Derivatives of the equations by the coordinates."""
    state, count = here.coordinates, len(here.coordinates)
    result = mp.matrix(count, count)
    for column in range(count):
        ends = [
            list(equations(Frames(here.linkage, [*state[:column], state[column] + side, *state[column + 1 :]]), angle))
            for side in (TINY, -TINY)
        ]
        for row, (high, low) in enumerate(zip(*ends, strict=True)):
            result[row, column] = (high - low) / (2 * TINY)
    return result


def _loads(exact: Exact, speed: mpf, pushes: Iterable[Push]) -> mp.matrix:
    """Loads, other ``pushes`` and inertia forces along the coordinates x, y and θ of every link's frame."""
    linkage, here = exact.linkage, exact.states[0]
    bodies, total = list(linkage.links), mp.matrix(3 * len(linkage.links), 1)

    def push(body: str, local: tuple[mpf, mpf], fx: mpf, fy: mpf, moment: mpf | int = 0) -> None:
        if body != GROUND:
            a, b = here.turned(body, local)
            for part, load in enumerate((fx, fy, a * fy - b * fx + moment)):
                total[3 * bodies.index(body) + part] += load

    gx, gy = map(mpf, linkage.gravity)
    for name, link in linkage.links.items():
        x, y = exact.point(name, link.centre)
        moment = -mpf(link.inertia or 0.0) * exact.turn(name)[2] * speed**2
        push(name, link.centre, link.mass * (gx - x[2] * speed**2), link.mass * (gy - y[2] * speed**2), moment)
    for load in (*exact.loads(speed), *pushes):
        push(*load)
    for damper in linkage.dampers:
        one, two = (exact.turn(body)[1] for body in damper.links)
        for body, side in zip(damper.links, (-1, 1), strict=True):
            push(body, (0, 0), mpf(0), mpf(0), side * mpf(damper.coefficient) * speed * (one - two))
    for spring in linkage.springs:
        length, rate, _ = exact.differences(lambda frames, s=spring: frames.length(s.points, s.links))
        pull = (spring.stiffness * (length - spring.length) + spring.damping * rate * speed) / length
        (x, y), (u, v) = (here.named(point, body) for point, body in zip(spring.points, spring.links, strict=True))
        for point, body, side in zip(spring.points, spring.links, (1, -1), strict=True):
            push(body, linkage.local(point, body), side * pull * (u - x), side * pull * (v - y))
    return total
