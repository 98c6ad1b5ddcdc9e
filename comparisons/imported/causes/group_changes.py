"""What may be wrong with several columns at once: an axis the other way, a unit, a reaction for an action."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from typing import Final

import numpy as np
from numpy.typing import NDArray

from comparisons.imported.causes.fitting import FaultModel, said
from comparisons.imported.causes.signal_changes import UNIT_RATIOS
from comparisons.imported.columns import Correction
from comparisons.imported.judging.judgement import SignalVerdict

Array = NDArray[np.float64]
Chosen = Callable[[str], bool]

ROTARY: Final = ("phi", "omega", "epsilon", "Mkr", "shaking_moment")


def is_rotary(name: str) -> bool:
    """Whether a signal changes its sign where the drawing is looked at from behind."""
    return name in ROTARY or name.startswith("link:")


def group_changes(verdicts: Sequence[SignalVerdict]) -> Iterator[FaultModel]:
    """Every cause that lies in a group of at least two columns."""
    names = [verdict.name for verdict in verdicts]
    groups: dict[str, tuple[Chosen, str]] = {
        "rotary": (is_rotary, "angles, turns and torques count clockwise"),
        "x": (_component("x"), "the x axis points the other way"),
        "y": (_component("y"), "the y axis points the other way"),
        "output": (lambda name: name in ("S", "v", "a"), "the output counts the other way"),
    }
    joints = {name.rpartition(":")[0] for name in names if name.startswith("joint_force")}
    for joint in joints:
        words = f"the force of '{joint.partition(':')[2]}' is that on the other link"
        groups[joint] = (lambda name, joint=joint: name.rpartition(":")[0] == joint, words)  # type: ignore[misc]
    if len(joints) > 1:
        groups["forces"] = (lambda name: name.startswith("joint_force"), "joint forces are those on the other links")
    for kind, (chosen, words) in groups.items():
        yield from _group(f"sign of {kind}", [name for name in names if chosen(name)], -1.0, words)
    units = {verdict.unit for verdict in verdicts}
    for unit in sorted(units):
        members = [verdict.name for verdict in verdicts if verdict.unit == unit]
        for ratio in UNIT_RATIOS.values():
            for factor in (ratio, 1.0 / ratio):
                words = f"all that is in {unit or '1'} is {factor:.6g} times too large: a unit taken for another"
                yield from _group(f"unit {unit} {factor:g}", members, factor, words)


def _component(axis: str) -> Chosen:
    def chosen(name: str) -> bool:
        return name.rpartition(":")[2] in (axis, f"v{axis}", f"a{axis}")

    return chosen


def _group(kind: str, members: Sequence[str], factor: float, words: str) -> Iterator[FaultModel]:
    if len(members) < 2:
        return
    chosen = frozenset(members)

    def predict(_: Array, verdicts: Sequence[SignalVerdict]) -> list[Array]:
        return [factor * v.truth if v.name in chosen else v.truth for v in verdicts]

    agreed = Correction(sign=-1) if factor < 0.0 else Correction(factor=1.0 / factor)
    yield FaultModel(kind, predict, said(words), signals=chosen, corrections=lambda _: dict.fromkeys(members, agreed))
