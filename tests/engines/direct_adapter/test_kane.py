"""The direct solution is that of Kane's method as sympy derives it: a third derivation, by another hand."""

import numpy as np
import pytest

from comparisons.trials.conformance.trial import case
from engines.contract import Setting
from engines.direct_adapter.adapter import DirectEngine
from engines.scene import Channel

INSTANTS = [0, 300, 700, 1100, 1400]  # samples: at rest, on the run-up and at speed
SAME = 1e-11  # of the largest acceleration, torque or force


def kane(scene):
    """Kane's equations of a scene with one loop of pins and guides on the ground, cut at the pin that closes it.

    The bodies in their order there, the pin's name, and a function of each body's coordinate, an angle or a travel, and
    speed: mass matrix, right-hand side, its share for each unit of drive torque and of the pin's force, the loop's
    Jacobian, and the part of its acceleration that is quadratic in the speeds.
    """
    import sympy  # noqa: PLC0415 - which takes a second, and is imported where this test runs
    from sympy.physics.mechanics import (  # noqa: PLC0415
        KanesMethod,
        Point,
        ReferenceFrame,
        RigidBody,
        dynamicsymbols,
        inertia,
    )  # fmt: skip

    q, u = dynamicsymbols(f"q:{len(scene.bodies)}"), dynamicsymbols(f"u:{len(scene.bodies)}")
    unknown = torque, x, y = sympy.symbols("T X Y")
    ground, origin = ReferenceFrame("N"), Point("O")
    origin.set_vel(ground, 0)
    frames, centres, order, parts = {"ground": ground}, {"ground": origin}, [], []
    guides, pins = {slider.body: slider for slider in scene.sliders}, [*scene.pins]

    def vector(pair, frame=ground):
        return pair[0] * frame.x + pair[1] * frame.y

    def point(body, anchor):
        place = centres[body].locatenew(f"{body}{anchor}", vector(anchor, frames[body]))
        place.v2pt_theory(centres[body], ground, frames[body])
        return place

    while len(order) < len(scene.bodies):
        body = next(
            b for b in scene.bodies if b not in order and (b.name in guides or any(_hangs(p, b, frames) for p in pins))
        )
        k = len(order)
        if body.name in guides:
            guide = guides[body.name]
            start = np.array(body.position) - np.array(guide.along) * (np.array(body.position) @ np.array(guide.along))
            frames[body.name] = ground.orientnew(body.name, "Axis", (body.angle, ground.z))
            frames[body.name].set_ang_vel(ground, 0)
            centres[body.name] = origin.locatenew(body.name, vector(start) + q[k] * vector(guide.along))
            centres[body.name].set_vel(ground, u[k] * vector(guide.along))
        else:
            pin = next(p for p in pins if _hangs(p, body, frames))
            pins.remove(pin)
            ends = [(pin.first, pin.first_anchor), (pin.second, pin.second_anchor)]
            (_, own), (host, there) = ends if pin.first == body.name else ends[::-1]
            frames[body.name] = ground.orientnew(body.name, "Axis", (q[k], ground.z))
            frames[body.name].set_ang_vel(ground, u[k] * ground.z)
            seat = point(host, there)
            centres[body.name] = seat.locatenew(body.name, -vector(own, frames[body.name]))
            centres[body.name].v2pt_theory(seat, ground, frames[body.name])
        own = inertia(frames[body.name], 0, 0, body.inertia or 0)
        parts.append(RigidBody(body.name, centres[body.name], frames[body.name], body.mass, (own, centres[body.name])))
        order.append(body)
    (cut,) = pins
    first, second = point(cut.first, cut.first_anchor), point(cut.second, cut.second_anchor)
    loads = [(part.masscenter, part.mass * vector(scene.gravity)) for part in parts]
    loads += [(first, vector((x, y))), (second, -vector((x, y))), (frames[scene.crank], torque * ground.z)]
    method = KanesMethod(ground, q, u, kd_eqs=[b - a.diff() for a, b in zip(q, u, strict=True)])
    method.kanes_equations(parts, loads)
    closing = first.pos_from(second).to_matrix(ground)[:2, :].jacobian(q)
    bend = (closing * sympy.Matrix(u)).jacobian(q) * sympy.Matrix(u)
    forcing = method.forcing
    right = [forcing.subs(dict.fromkeys(unknown, 0)), forcing.jacobian(unknown)]
    return order, cut.name, sympy.lambdify([q, u], [method.mass_matrix, *right, closing, bend], cse=True)


def _hangs(pin, body, placed):
    """Whether a pin joins a body to one that is placed."""
    return body.name in (pin.first, pin.second) and bool({pin.first, pin.second} & placed.keys())


@pytest.mark.nightly  # deriving the equations takes seconds
@pytest.mark.parametrize("sample", ["four-bar", "slider-crank"])
def test_accelerations_torque_and_a_joint_force_are_those_of_kanes_method(sample):
    scene = case(sample).scene(frozenset(Channel))
    history = DirectEngine().run(scene, Setting.TUNED).history
    order, cut, equations = kane(scene)
    numbers, travels = [scene.bodies.index(body) for body in order], {s.body: s.along for s in scene.sliders}
    crank = [body.name for body in order].index(scene.crank)

    def coordinates(values):
        return [
            row[:2] @ np.array(travels[body.name]) if body.name in travels else row[2]
            for body, row in zip(order, values[numbers], strict=True)
        ]

    found, expected = [], []
    for instant in INSTANTS:
        states = [signal.values[instant] for signal in (history.position, history.velocity, history.acceleration)]
        q, u, rates = map(coordinates, states)
        mass, rest, pushed, closing, bend = equations(q, u)
        count = len(q)
        system = np.zeros((count + 3, count + 3))
        system[:count, :count], system[:count, count:] = mass, -pushed
        system[count, crank], system[count + 1 :, :count] = 1.0, closing
        right = np.concatenate([rest.ravel(), [rates[crank]], -bend.ravel()])
        found.append(np.linalg.solve(system, right))
        expected.append([*rates, history.torque.values[instant], *history.joint_force[cut].values[instant]])
    size = np.max(np.abs(expected), axis=0)
    assert np.max(np.abs(np.array(found) - expected) / size) < SAME
