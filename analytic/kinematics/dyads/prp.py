"""PRP: each link slides on a placed body; they share the inner pin C."""

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
from analytic.kinematics.frames import Pair, Pose, Rate, Scalar
from analytic.kinematics.structure import Prismatic, Revolute


class PRPConstants(NamedTuple):
    """Of each slide its line, where its host has C at zero travel, and C on the link."""

    first_along: Vector
    first_turn: Vector
    first_base: Vector
    first_pin: Vector
    second_along: Vector
    second_turn: Vector
    second_base: Vector
    second_pin: Vector


def constants(first: Prismatic, inner: Revolute, second: Prismatic, sign: float) -> PRPConstants:
    """The dyad's constants from its joints; it has one assembly mode."""
    return PRPConstants(
        first.along,
        first.turn,
        point_on_rail(first, inner.far_local),
        inner.far_local,
        second.along,
        second.turn,
        point_on_rail(second, inner.near_local),
        inner.near_local,
    )


def poses(k: PRPConstants, host_poses: Poses) -> tuple[Poses, Closure]:
    """The pin C lies where the two lines cross: C = one + t e = two + u f."""
    e, f = frames.arm(host_poses[0], k.first_along), frames.arm(host_poses[1], k.second_along)
    determinant = frames.cross(e, f)
    pair = frames.point(host_poses[0], k.first_base)
    slide, _ = solve_slides(
        e, f, frames.minus(frames.point(host_poses[1], k.second_base), pair), frames.inverse(determinant)
    )
    c = frames.point_along(pair, slide, e)
    first = frames.pose_through(c, frames.turned(host_poses[0], k.first_turn), k.first_pin)
    second = frames.pose_through(c, frames.turned(host_poses[1], k.second_turn), k.second_pin)
    return (first, second), Closure(e, f, determinant, c)


def rates(
    k: PRPConstants, host_poses: Poses, host_rates: Rates, link_poses: Poses, closure: Closure
) -> tuple[Rates, Travel]:
    """C moves as the point of each host under it does, plus that host's slide."""
    a = frames.carried_rate(host_poses[0], host_rates[0], closure.pin)
    b = frames.carried_rate(host_poses[1], host_rates[1], closure.pin)
    scale = frames.inverse(closure.determinant)
    first, two = solve_slides(closure.u, closure.v, frames.minus(b, a), scale)
    c = frames.point_along(a, first, closure.u)
    pair = (
        frames.rate_through(link_poses[0], c, host_rates[0][2], k.first_pin),
        frames.rate_through(link_poses[1], c, host_rates[1][2], k.second_pin),
    )
    return pair, Travel(scale, first, two)


def accelerations(k: PRPConstants, hosts: Hosts, links: Links, closure: Closure, travel: Travel) -> Rates:
    """Closure twice differentiated, with the Coriolis term of each slide on its host."""
    host_poses, host_rates, host_seconds = hosts
    link_poses, _ = links
    a = _pin_acceleration(host_poses[0], host_rates[0], host_seconds[0], closure.pin, travel.first, closure.u)
    b = _pin_acceleration(host_poses[1], host_rates[1], host_seconds[1], closure.pin, travel.second, closure.v)
    slide, _ = solve_slides(closure.u, closure.v, frames.minus(b, a), travel.scale)
    c = frames.point_along(a, slide, closure.u)
    return (
        frames.acceleration_through(link_poses[0], c, host_rates[0][2], host_seconds[0][2], k.first_pin),
        frames.acceleration_through(link_poses[1], c, host_rates[1][2], host_seconds[1][2], k.second_pin),
    )


def _pin_acceleration(host: Pose, rate: Rate, second: Rate, pin: Pair, travel: Scalar, along: Pair) -> Pair:
    """Second derivative of the pin, less that of the travel along its line."""
    carried = frames.carried_acceleration(host, rate, second, pin)
    return carried if frames.is_still(rate) else frames.plus(carried, frames.coriolis(rate[2], travel, along))
