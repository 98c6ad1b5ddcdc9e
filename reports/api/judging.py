"""``judge``: another tool's results against the closed form under the requested motion."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Final

import numpy as np

from analytic.description.crank_motion import REGIMES
from analytic.description.linkage import Linkage
from analytic.errors import LinkproofError
from analytic.kinematics.mechanism import Mechanism
from comparisons.designer.building import STEADY
from comparisons.filejudge.columns import ImportedResults
from comparisons.filejudge.judge import ImportedJudgement
from comparisons.filejudge.judge import judge as judge_results
from comparisons.filejudge.reading import read_results
from comparisons.motion.case import DriverMotion
from reports.api.motions import check_motion, named_case
from reports.api.options import Motion as Asked

STEADY_WITHIN: Final = 1e-9  # of its largest: by what the speed of a crank that turns steadily may differ


def judge_files(
    linkage: Linkage, files: Sequence[Path], motion: Asked, *, map: Sequence[str], limit: float, encoding: str
) -> ImportedJudgement:
    """The judgement of a tool's result files against the closed form of a linkage, by the options of ``judge``.

    ``map`` says what columns are, "COLUMN=SIGNAL" each, ``limit`` is a share of the peak, ``encoding`` of texts that
    are not UTF-8 or UTF-16, "" for none. Raises LinkproofError for an impossible motion, and for files that cannot be
    read or judged.
    """
    check_motion(motion)
    imported = read_results(files, linkage, map, encoding)
    return judge_results(
        linkage,
        imported,
        _stated_motion(motion, linkage, imported),
        limit=limit,
        start_angle=math.radians(motion.start_angle),
        gives_speed=motion.speed is not None,
    )


def _stated_motion(options: Asked, linkage: Linkage, imported: ImportedResults) -> DriverMotion | None:
    """The driver's motion by the options: of a regime, at constant speed, or None if the files give it.

    It is steady too where all signals are over φ. Raises LinkproofError for signals over φ under a speed that changes,
    since they do not say when, and for times after the motion's end.
    """
    over_angle = [signal.column.header for signal in imported.signals if signal.axis == "phi"]
    if not (options.regime or options.swings) and (
        options.speed is not None or len(over_angle) == len(imported.signals)
    ):
        options = replace(options, regime=(STEADY,))
    case = named_case(options, Mechanism(linkage))
    if case is None:
        return None
    motion = case.motion
    speed = motion.speed(np.linspace(0.0, motion.duration, 101))
    if over_angle and np.ptp(speed) > STEADY_WITHIN * np.max(np.abs(speed)):
        raise LinkproofError(
            f"'{over_angle[0]}' is over the crank angle, which does not say when the crank was there in "
            f"'{motion.regime}': give --speed alone if it turned steadily, or export the time beside it"
        )
    if options.swings or motion.regime not in REGIMES:  # a crank that was brought to speed goes on turning
        _check_end(motion, imported)
    return motion


def _check_end(motion: DriverMotion, imported: ImportedResults) -> None:
    """Raise LinkproofError for a signal of which more than the last sample is after the end of the stated motion."""
    for signal in imported.signals:
        if signal.axis == "time" and len(signal.time) > 1 and float(signal.time[-2]) > motion.duration:
            raise LinkproofError(
                f"'{signal.column.header}' has times up to {signal.time[-1]:.4g} s, and the stated motion "
                f"'{motion.regime}' ends at {motion.duration:.4g} s: correct the motion, or leave out the rows after it"
            )
