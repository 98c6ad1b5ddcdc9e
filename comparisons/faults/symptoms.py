"""Kinds of faults of an engine's model or read-out, recognised by the combination of rows of a run that fail.

Each was confirmed by planting every fault of the conformance test in every engine: the rows that fail are the same.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Final

from comparisons.judging.records import IMPORTED, Record, Verdict
from engines.contract import Setting

POSITIONS: Final = frozenset(("joint_gap", "crank_phase", "S"))
MOTION: Final = POSITIONS | {"closure", "v", "a"}


@dataclass(frozen=True)
class Symptom:
    """A kind of fault: the rows that fail of it and those that pass, as far as a run has them, and its sentence."""

    words: str
    fails: frozenset[str]
    passes: frozenset[str] = frozenset()

    def fits(self, failed: dict[str, bool]) -> bool:
        """Whether a run whose judged rows have ``failed`` or not shows it."""
        known = self.fails & failed.keys()
        return bool(known) and all(failed[name] for name in known) and not any(map(failed.get, self.passes))


GEOMETRY: Final = Symptom(
    "the positions do not fit the joints: a length, a pin, a guide or a mass centre of the engine's model is not the "
    "scene's, or the positions are not those of the mass centres in the ground frame",
    frozenset(("joint_gap",)),
)
DRIVE: Final = Symptom(
    "the positions fit the joints, but the crank is not where its drive moves it: the engine's drive is not the "
    "scene's, or positions are read at another instant",
    frozenset(("crank_phase",)),
    frozenset(("joint_gap",)),
)
VELOCITY: Final = Symptom(
    "the positions are right, but the velocities are not their derivatives: they are read at another instant, in "
    "another frame or with the wrong sign",
    frozenset(("closure", "v")),
    POSITIONS,
)
ACCELERATION: Final = Symptom(
    "positions and velocities are right, but the accelerations are not their derivatives: they are read at another "
    "instant or in another frame, or gravity is subtracted",
    frozenset(("closure",)),
    POSITIONS | {"energy_balance", "v"},
)
MODEL: Final = Symptom(
    "the motion is right, but the forces are not those it takes: a mass, an inertia, gravity or a load of the engine's "
    "model is not the scene's",
    frozenset(("torque_two_routes", "force_balance", "Mkr", "joint_force")),
    MOTION,
)
TORQUE: Final = Symptom(
    "the motion is right, but the drive torque is not the one it takes: it is read with the wrong sign, at another "
    "instant or without a share, as the crank's own inertia",
    frozenset(("torque_two_routes", "Mkr")),
    MOTION | {"force_balance", "joint_force"},
)
FORCE: Final = Symptom(
    "motion and drive torque are right, but the joint forces do not balance: they are read on the other body, in "
    "another frame or at another instant",
    frozenset(("force_balance", "joint_force")),
    MOTION | {"torque_two_routes", "Mkr"},
)
SYMPTOMS: Final = (GEOMETRY, DRIVE, VELOCITY, ACCELERATION, MODEL, TORQUE, FORCE)
BALANCES: Final = frozenset(
    ("joint_gap", "closure", "crank_phase", "energy_balance", "torque_two_routes", "force_balance")
)


def symptoms(failed: dict[str, bool]) -> tuple[Symptom, ...]:
    """The kinds of faults that a run may have, of whose judged rows each has ``failed`` or not."""
    if not any(map(failed.get, BALANCES)):
        return ()
    return tuple(symptom for symptom in SYMPTOMS if symptom.fits(failed))


def probable_faults(run: Iterable[Record]) -> str:
    """The probable faults behind the failing rows of a run, with a remedy; "" if no kind of fault fits."""
    records = [entry for entry in run if Verdict(entry.outcome).judged and entry.error_max is not None]
    if not records or records[0].origin == IMPORTED:
        return ""
    failed: dict[str, bool] = {}
    for record in records:
        name = record.quantity.partition(":")[0]
        failed[name] = failed.get(name, False) or Verdict(record.outcome).failed
    words = "; or ".join(symptom.words for symptom in symptoms(failed))
    cure = f"run 'linkproof engines {records[0].engine} --check', and if it passes shorten the step"
    if records[0].setting == Setting.NAIVE:  # an engine's defaults may be this wrong though its adapter is right
        cure = "naive takes the engine's defaults: use the setting tuned"
    return f"{words}; {cure}" if words else ""
