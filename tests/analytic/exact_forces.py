"""Signals of a linkage in many digits, its joint forces too: Lagrange's multipliers of its equations."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping

from mpmath import mp, mpf

from analytic.description.linkage import GROUND, Linkage, Vector
from tests.analytic.fifty_digits import Exact, Frames, equations

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
