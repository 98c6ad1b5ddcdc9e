"""RPP: the second link slides on a placed body, the first on the second and turns with it about a placed pin A."""

from __future__ import annotations

from typing import NamedTuple

from analytic.description.linkage import Vector
from analytic.kinematics import frames
from analytic.kinematics.dyads.closure import (  # noqa: F401 - of both kinds
    Closure,
    Hosts,
    Links,
    Poses,
    Rates,
    Travel,
    assembly_fault,
    dead_determinant,
    dead_position_text,
    point_on_rail,
    reach_margin,
    solve_slides,
)
from analytic.kinematics.structure import Prismatic, Revolute


class RPPConstants(NamedTuple):
    """A on its placed body and on the first link; the outer line with the second link's home, the inner line.

    ``start`` is where the host has A at zero travel.
    """

    a: Vector
    pin_a: Vector
    along: Vector
    turn: Vector
    origin: Vector
    inner_along: Vector
    inner_turn: Vector
    start: Vector


def constants(first: Revolute, inner: Prismatic, second: Prismatic, sign: float) -> RPPConstants:
    """The dyad's constants from its joints; it has one assembly mode."""
    return RPPConstants(
        first.near_local,
        first.far_local,
        second.along,
        second.turn,
        second.origin,
        inner.along,
        inner.turn,
        point_on_rail(second, point_on_rail(inner, first.far_local)),
    )


def poses(k: RPPConstants, host_poses: Poses) -> tuple[Poses, Closure]:
    """The pin A lies on the second link's line: A = start + t e − u f, f against the inner slide."""
    host = host_poses[1]
    a, e = frames.point(host_poses[0], k.a), frames.arm(host, k.along)
    c, s = frames.turned(host, k.turn)
    x, y = frames.rotated(c, s, k.inner_along)
    f = (-x, -y)
    determinant = frames.cross(e, f)
    slide, _ = solve_slides(e, f, frames.minus(a, frames.point(host, k.start)), frames.inverse(determinant))
    x, y = frames.point_along(frames.point(host, k.origin), slide, e)
    first = frames.pose_through(a, frames.rotated(c, s, k.inner_turn), k.pin_a)
    return (first, (x, y, c, s)), Closure(e, f, determinant, a)


def rates(
    k: RPPConstants, host_poses: Poses, host_rates: Rates, link_poses: Poses, closure: Closure
) -> tuple[Rates, Travel]:
    """The pin moves as the point of the host under it does, plus the two slides."""
    host, moves, e = host_poses[1], host_rates[1], closure.u
    a = frames.point_rate(host_poses[0], host_rates[0], k.a)
    scale = frames.inverse(closure.determinant)
    first, two = solve_slides(e, closure.v, frames.minus(a, frames.carried_rate(host, moves, closure.pin)), scale)
    x, y = frames.point_along(frames.carried_rate(host, moves, (link_poses[1][0], link_poses[1][1])), first, e)
    return (frames.rate_through(link_poses[0], a, moves[2], k.pin_a), (x, y, moves[2])), Travel(scale, first, two)


def accelerations(k: RPPConstants, hosts: Hosts, links: Links, closure: Closure, travel: Travel) -> Rates:
    """Closure twice differentiated, with the Coriolis term of both slides on the turning host."""
    host_poses, host_rates, host_seconds = hosts
    link_poses, _ = links
    host, moves, seconds = host_poses[1], host_rates[1], host_seconds[1]
    e, f = closure.u, closure.v
    a = frames.point_acceleration(host_poses[0], host_rates[0], host_seconds[0], k.a)
    under = frames.carried_acceleration(host, moves, seconds, closure.pin)
    first, two = frames.coriolis(moves[2], travel.first, e), frames.coriolis(moves[2], travel.second, f)
    gap = frames.minus(frames.minus(a, under), frames.minus(first, two))
    slide, _ = solve_slides(e, f, gap, travel.scale)
    home = frames.carried_acceleration(host, moves, seconds, (link_poses[1][0], link_poses[1][1]))
    x, y = frames.plus(frames.point_along(home, slide, e), first)
    return frames.acceleration_through(link_poses[0], a, moves[2], seconds[2], k.pin_a), (x, y, seconds[2])
