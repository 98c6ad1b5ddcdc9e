"""The driver's coordinate φ as a function of the bodies: a crank's angle, a slider's travel, a cylinder's length.

A crank's angle is one of the bodies' coordinates. A slider of the ground, or a cylinder, is two points: φ is their span
along the guide, or its length, so that with u the unit vector along it

    φ' = u · s',    φ'' = u · s'' + (|s'|² − (u · s')²) / φ

where the last term is a cylinder's only. The force that drives it acts along u on the first point, and its reverse on
the second.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from analytic.description.linkage import DriverKind
from engines.mechanics.states import Pose, Reals, across, body_numbers, dot, pose_of
from engines.scene import Scene


@dataclass(frozen=True)
class Span:
    """Between the two points of a linear driver, at n instants: arms from the mass centres to them, span, direction u.

    All are (n, 2); ``length`` (n,) is φ.
    """

    first: Reals
    second: Reals
    between: Reals
    along: Reals
    length: Reals


class Driver:
    """The driver of a scene, lengths counted in ``unit``; ``scale`` is what φ counts in: rad, or that unit in m."""

    def __init__(self, scene: Scene, unit: float = 1.0) -> None:
        numbers = body_numbers(scene)
        self.kind = scene.driver_kind
        self.turns = self.kind is DriverKind.CRANK
        self.scale = 1.0 if self.turns else unit
        self.count = len(numbers)
        if self.turns:
            self.crank = numbers[scene.crank]
            return
        first, second, here, there = scene.driver_ends
        self.crank = -1
        self.ends = np.array([numbers[first], numbers[second]], dtype=np.intp)
        self.anchors = np.array([here, there], dtype=float) / unit
        self.line = np.array(scene.driven_slider.along) if self.kind is DriverKind.SLIDER else None

    def span(self, pose: Pose) -> Span | None:
        """The two points of a linear driver; None of a crank."""
        if self.turns:
            return None
        arms = pose.turned(self.anchors, self.ends)
        between = pose.place[:, self.ends[0]] - pose.place[:, self.ends[1]] + (arms[:, 0] - arms[:, 1])
        if self.line is None:
            length = np.sqrt(dot(between, between))
            return Span(arms[:, 0], arms[:, 1], between, between / length[:, None], length)
        along = np.broadcast_to(self.line.astype(between.dtype), between.shape)
        return Span(arms[:, 0], arms[:, 1], between, along, dot(along, between))

    def value(self, pose: Pose) -> Reals:
        """φ (n,), rad or units."""
        span = self.span(pose)
        return pose.angle[:, self.crank] if span is None else span.length

    def gradient(self, span: Span | None, count: int) -> Reals:
        """∂φ over every body's x, y and angle, (n, bodies, 3)."""
        result = np.zeros((count, self.count, 3), dtype=float if span is None else span.between.dtype)
        if span is None:
            result[:, self.crank, 2] = 1.0
            return result
        for body, arm, sign in zip(self.ends, (span.first, span.second), (1.0, -1.0), strict=True):
            result[:, body, :2] += sign * span.along
            result[:, body, 2] += sign * dot(span.along, across(arm))
        return result

    def bend(self, span: Span | None, rate: Reals) -> Reals:
        """The part of φ'' that the bodies' rates (n, bodies, 3) alone make, (n,), with its sign reversed."""
        if span is None:
            return np.zeros(len(rate), dtype=rate.dtype)
        first, second = rate[:, self.ends[0]], rate[:, self.ends[1]]
        first_spin, second_spin = first[:, 2:], second[:, 2:]
        inward = first_spin**2 * span.first - second_spin**2 * span.second
        result = dot(span.along, inward)
        if self.line is None:
            moved = first[:, :2] - second[:, :2] + first_spin * across(span.first) - second_spin * across(span.second)
            result = result - dot(across(span.along), moved) ** 2 / span.length
        return np.asarray(result)


def driven(scene: Scene, position: Reals, *rates: Reals) -> tuple[Reals, ...]:
    """φ, rad or m, and its time derivatives from the motion of the bodies, SI, each (n, bodies, 3)."""
    driver, pose = Driver(scene), pose_of(position)
    span = driver.span(pose)
    gradient = driver.gradient(span, len(position))
    result = [driver.value(pose)]
    for order, rate in enumerate(rates, start=1):
        along = np.sum(gradient * rate, axis=(1, 2))
        result.append(along if order == 1 else along - driver.bend(span, rates[0]))
    return tuple(result)
