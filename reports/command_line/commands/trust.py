"""What ``linkproof sweep --simulate`` does: a sample of the designs in engines, judged and saved as a campaign."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Final

from analytic.description.crank_motion import CrankMotion
from analytic.kinematics.mechanism import Mechanism
from comparisons.campaign.campaign import CampaignRequest, compare
from comparisons.campaign.standards import judged_campaign
from comparisons.designs.sweep.space import DesignSpace, Grid
from comparisons.designs.trust.sample import DesignSample, hypercube, rows, sample
from comparisons.designs.trust.trust import trust
from comparisons.judging.records import Verdict, to_json
from comparisons.judging.verdicts import shipped_standard
from comparisons.runs.files import write_text
from reports.command_line import PASSED, SUITE_ERROR
from reports.command_line.commands.compare import campaign_document, save_campaign
from reports.command_line.commands.results import chosen_case
from reports.command_line.commands.trust_choice import TrustChoice, Trusted
from reports.command_line.destination import Destination
from reports.command_line.interruption import interruptible, journal
from reports.command_line.linear_drive import prescribed
from reports.command_line.motion_choice import MotionChoice
from reports.command_line.requests import RunLimits, named
from reports.designs.trust.trust_terminal import printout

FOLDER: Final = "simulated"  # below the folder of the sweep, as are the designs' files
DESIGN_FILES: Final = "designs"
PICTURE: Final = "trust.svg"
FILE: Final = "trust.json"


def simulate(
    mechanism: Mechanism,
    space: DesignSpace,
    choice: TrustChoice,
    motion: MotionChoice,
    *,
    command: str,
    destination: Destination,
    limits: RunLimits,
) -> Trusted:
    """Simulate a sample of the designs, and write what came of it below the folder of the destination.

    ``command`` is the one that asks for the same. Raises LinkproofError where no design can make the motion.
    """
    folder = destination.folder
    motions, conditions = _motions(mechanism, motion)
    drawn, words = _drawn(mechanism, space, choice, motions)
    linkages = tuple(one.linkage for one in drawn.designs)
    wanted = CampaignRequest(linkages, motions, conditions, named(choice.engines))
    below = replace(destination, folder=folder and folder / FOLDER, json=None, junit=None)
    kept = None
    with limits.pool() as pool, interruptible(folder) as counting:
        if below.folder:
            kept = journal(below.folder, command, wanted.engines, linkages, resume=destination.resume)
        with destination.progress() as announce, destination.own_stdout():
            found = list(compare(wanted, counting(announce), bounds=limits.bounds, pool=pool, journal=kept))
        judged = judged_campaign(wanted, found, shipped_standard())
        if below.folder:
            told = campaign_document(wanted, judged, command)
            told["environment"] |= pool.place
            save_campaign(below, wanted, judged, told, limits)
        result = trust(drawn, judged.records, choice.seed)
        if folder:
            from reports.designs.trust.trust_picture import trust_svg  # noqa: PLC0415 - figures cost a second

            for one in linkages[not drawn.designs[0].number :]:
                write_text(folder / DESIGN_FILES / f"{one.name}.toml", one.text)
            write_text(folder / PICTURE, trust_svg(result, f"{mechanism.linkage.name}: designs {words}", conditions))
            write_text(folder / FILE, to_json({"command": command, "conditions": conditions, **result.told}))
        if kept:
            kept.clear()
    is_ours = any(record.outcome == Verdict.SUITE_ERROR for record in judged.records)
    return Trusted(result, printout(result, words, conditions), SUITE_ERROR if is_ours else PASSED)


def _motions(mechanism: Mechanism, choice: MotionChoice) -> tuple[tuple[CrankMotion, ...], str]:
    """The motion that compare gives a linkage where none is named; over the range of a crank that makes no turn."""
    linkage = mechanism.linkage
    if linkage.is_linear or choice.swings or mechanism.crank_range(math.radians(choice.start_angle)).is_full_turn:
        return prescribed(choice, [linkage])
    motion = chosen_case(mechanism, choice).motion
    assert isinstance(motion, CrankMotion)
    first, last = (linkage.place(float(motion.angle(time))) for time in (0.0, motion.duration))
    return (motion,), f"{abs(choice.speed):g} rpm, from {first} to {last}"


def _drawn(
    mechanism: Mechanism, space: DesignSpace, choice: TrustChoice, motions: tuple[CrankMotion, ...]
) -> tuple[DesignSample, str]:
    """A sample of a space, and how it was drawn, in words."""
    if isinstance(space, Grid):
        draw, words = hypercube(space.ends, choice.seed), f"of a Latin hypercube over the ranges (seed {choice.seed})"
    else:
        draw = rows(space.count, lambda number: space.shown(number, number + 1)[:, 0], choice.seed)
        words = f"of the table's {space.count}, drawn at random (seed {choice.seed})"
    return sample(mechanism.linkage, space.parameters, draw, choice.designs, motions), words
