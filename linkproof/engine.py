"""The contract between linkproof and an engine: every name that an adapter needs."""
# ruff: noqa: E402, I001  - strangers are refused first; a line of its own for every name would be two pages

import linkproof

linkproof.refuse_strangers()

from analytic.description.linkage import DriverKind
from engines.contract import (
    Abilities, Engine, History, Method, Origin, Outcome, ReadOut, Run, Setting, Signal, StudiedEngine,
)  # fmt: skip
from engines.scene import (
    AppliedForce, AppliedTorque, Body, Channel, CoulombFriction, Cylinder, Free, PinJoint, PointSpring, Prescribed,
    Scene, SliderJoint, SlotJoint, Travel, TurnDamper, TurnSpring,
)  # fmt: skip
from engines.stepping.intervals import DivergedError, UnsupportedError
from engines.stepping.stepped_engine import LoopEngine, plain_law
from engines.stepping.stepped_engine import Course, Recipe, SteppedEngine

__all__ = [
    "Abilities", "AppliedForce", "AppliedTorque", "Body", "Channel", "CoulombFriction", "Course", "Cylinder",
    "DivergedError", "DriverKind", "Engine", "Free", "History", "LoopEngine", "Method", "Origin", "Outcome", "PinJoint",
    "PointSpring", "Prescribed", "ReadOut", "Recipe", "Run", "Scene", "Setting", "Signal", "SliderJoint", "SlotJoint",
    "SteppedEngine", "StudiedEngine", "Travel", "TurnDamper", "TurnSpring", "UnsupportedError", "plain_law",
]  # fmt: skip
