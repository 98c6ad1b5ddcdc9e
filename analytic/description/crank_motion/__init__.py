"""Crank motions: run-ups, constant speed, swings by the laws of cams and servos, tables; all polynomials of time."""

from analytic.description.crank_motion.prescribed import (
    LARGEST,
    RAMPS,
    REGIMES,
    RPM,
    CrankMotion,
    Segment,
    crank_motion,
    degrees,
    derivative,
)
from analytic.description.crank_motion.swings import LAWS, Move, sequence, swing

__all__ = [
    "LARGEST",
    "LAWS",
    "RAMPS",
    "REGIMES",
    "RPM",
    "CrankMotion",
    "Move",
    "Segment",
    "crank_motion",
    "degrees",
    "derivative",
    "sequence",
    "swing",
]
