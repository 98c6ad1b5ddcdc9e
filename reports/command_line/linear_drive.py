"""Motions of linkages that are driven along a line, in the unit of length of their file.

``--from``, ``--to`` are travels there and ``--speed`` is per second. Without a speed a motion has the mean speed of one
second; without ends it goes over the range of the drive.
"""

from __future__ import annotations

from collections.abc import Sequence

from analytic.description.crank_motion import LAWS, CrankMotion, swing
from analytic.description.linkage import Linkage
from analytic.description.units import factor
from analytic.errors import LinkproofError
from analytic.kinematics.mechanism import Mechanism
from comparisons.datasheet.building import within
from reports.command_line.motion_choice import MotionChoice
from reports.command_line.motions import EVERYTHING, SWINGING, motions, offered


def prescribed(choice: MotionChoice, linkages: Sequence[Linkage]) -> tuple[tuple[CrankMotion, ...], str]:
    """The requested prescribed motions, without the linkages' own, and their conditions in words."""
    linear = [linkage for linkage in linkages if linkage.is_linear]
    if not linear:
        return motions(choice), choice.conditions
    linkage = linear[0]
    if len(linkages) > 1:
        raise LinkproofError(
            f"'{linkage.name}' is driven along a line and cannot share a motion with other linkages: run it separately"
        )
    own = {regime.name for regime in linkage.regimes}
    for name in choice.regimes:
        if name in offered(choice) and name not in LAWS and name not in own:
            raise LinkproofError(
                f"--regime {name} turns a crank, but '{linkage.name}' is driven along a line: choose one of "
                f"{', '.join(LAWS)} with --from and --to"
            )
    if choice.start_angle:
        raise LinkproofError(
            f"--start-angle turns a crank, but '{linkage.name}' is driven along a line: give --from and --to"
        )
    names = LAWS if EVERYTHING in choice.regimes else choice.regimes or (SWINGING,)
    unit = linkage.units.get("length", "m")
    (first, last), size = _ends(choice, linkage), factor("length", unit)
    speed = abs(last - first) if choice.speed is None else abs(choice.speed) * size
    found = tuple(swing(name, first, last, speed=speed) for name in dict.fromkeys(names) if name in LAWS)
    return found, f"from {linkage.written(first)} to {linkage.written(last)}, at most {speed / size:.4g} {unit}/s"


def _ends(choice: MotionChoice, linkage: Linkage) -> tuple[float, float]:
    """Travels at which a motion begins and ends, m."""
    if choice.from_angle is not None and choice.to_angle is not None:
        size = factor("length", linkage.units.get("length", "m"))
        return choice.from_angle * size, choice.to_angle * size
    return within(Mechanism(linkage).crank_range(), backwards=choice.turns_back)
