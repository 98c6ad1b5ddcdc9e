"""Plane vectors as pairs of numbers."""

from __future__ import annotations

import math

from analytic.description.linkage import Vector


def rotate(vector: Vector, turn: Vector) -> Vector:
    """Turn a plane vector by an angle given as (cos, sin)."""
    return (vector[0] * turn[0] - vector[1] * turn[1], vector[0] * turn[1] + vector[1] * turn[0])


def unit(vector: Vector) -> Vector:
    """The unit vector along a non-zero vector."""
    length = math.hypot(*vector)
    return (vector[0] / length, vector[1] / length)
