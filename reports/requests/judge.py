"""``judge``: another tool's results against the closed form under the requested motion."""

from __future__ import annotations

import math

from analytic.description.changes import without
from analytic.description.crank_motion import REGIMES, RPM, crank_motion
from analytic.description.linkage import Linkage
from analytic.errors import LinkproofError
from analytic.kinematics.mechanism import Mechanism
from comparisons.filejudge.columns import ImportedResults
from comparisons.filejudge.judge import ImportedJudgement
from comparisons.filejudge.judge import judge as judge_results
from comparisons.filejudge.reading import read_results
from comparisons.motion.case import Motion
from reports.requests.motions import check_motion, requested_motion
from reports.requests.options import JudgeOptions


def check_judgement(options: JudgeOptions) -> None:
    """Raise LinkproofError for bad options, before a file is read."""
    check_motion(options)
    if not 0.0 < options.limit < math.inf:
        raise LinkproofError(f"--limit: expected a positive share of the peak, such as 0.01, got {options.limit:g}")


def judge_files(options: JudgeOptions, linkage: Linkage) -> ImportedJudgement:
    """The judgement of a tool's results against the closed form of a linkage.

    Raises LinkproofError for files that cannot be read.
    """
    model = linkage if options.gravity else without(linkage, "gravity")
    imported = read_results(options.results, model, options.map, options.encoding)
    return judge_results(
        model,
        imported,
        _motion(options, model, imported),
        limit=options.limit,
        start_angle=math.radians(options.start_angle),
        gives_speed=options.speed is not None,
    )


def _motion(options: JudgeOptions, linkage: Linkage, imported: ImportedResults) -> Motion | None:
    """The motion of the regime; constant speed if all signals are over φ; None if the file's columns give it."""
    motion = requested_motion(options, Mechanism(linkage))
    if motion is not None:
        if options.swings or motion.regime not in REGIMES:  # a crank that was brought to speed goes on turning
            _check_end(motion, imported)
        return motion
    if imported.signals and all(signal.axis == "phi" for signal in imported.signals):
        return crank_motion("constant-speed", speed=abs(options.rpm) * RPM, clockwise=options.turns_back)
    return None


def _check_end(motion: Motion, imported: ImportedResults) -> None:
    """Raise LinkproofError for times of a file that are more than a sample after the end of the stated motion."""
    for signal in imported.signals:
        if signal.axis == "time" and len(signal.at) > 1 and float(signal.at[-2]) > motion.duration:
            raise LinkproofError(
                f"'{signal.column.header}' has times up to {signal.at[-1]:.4g} s, and the stated motion "
                f"'{motion.regime}' ends at {motion.duration:.4g} s: correct the motion, or leave out the rows after it"
            )
