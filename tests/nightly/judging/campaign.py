"""How often ``judge`` names the fault in files of a program that shares nothing with the closed form.

``python -m tests.nightly.judging.campaign KIND COUNT [SEED]``: KIND is ``clean``, ``fault``, or ``columns`` with two
wrong ones. Every file is judged twice, the second time with points and links renamed and the linkage's file in another
order.
"""

from __future__ import annotations

import re
import sys
import tempfile
import time as clock
from collections import Counter
from pathlib import Path

import numpy as np

from analytic.description.changes import named_numbers
from analytic.description.crank_motion import crank_motion
from analytic.description.loading import load
from analytic.errors import LinkproofError
from comparisons.filejudge.judge import judge
from comparisons.filejudge.reading import read_results
from comparisons.trials.judging.records import Verdict
from tests.nightly.judging.exports import ENDINGS, case

KINDS = {"clean": 0, "fault": 1, "columns": 2}
CLOSE = 0.05  # of a number's change, within which it is named right
EQUAL = 1e-6  # of the largest number of its kind
RIGHT = ("clean", "first")


def judged(export):
    """The judgement of an export, by the files that a user has."""
    with tempfile.TemporaryDirectory() as folder:
        model, file = (Path(folder) / n for n in ("model.toml", f"run.{ENDINGS.get(export.layout, 'csv')}"))
        model.write_text(export.linkage)
        file.write_bytes(export.text if isinstance(export.text, bytes) else export.text.encode())
        linkage = load(str(model))
        return judge(linkage, read_results([file], linkage, export.mapping), _stated(export.stated))


def _stated(motion):
    if motion is None:
        return None
    ramp = 0.0 if motion.law == "constant-speed" else motion.ramp
    return crank_motion(
        motion.law, speed=abs(motion.speed), clockwise=motion.speed < 0.0, start_angle=motion.start, ramp_time=ramp,
        hold_time=motion.duration - ramp,
    )  # fmt: skip


def is_same(named, planted, clean):
    """Whether two descriptions are the same but for a small part of what was changed."""
    one, other, true = (
        {name: n for name, n in named_numbers(k).items() if n.path[0] != "sketch"} for k in (named, planted, clean)
    )
    bounds: dict[str, float] = {}
    for name in true.keys() & other.keys():
        kind, change = true[name].kind, CLOSE * abs(other[name].value - true[name].value)
        bounds[kind] = max(bounds.get(kind, 0.0), change, EQUAL * abs(true[name].value))
    return named is not clean and all(
        abs(one[name].value - other[name].value) <= bounds[one[name].kind]
        if name in one and name in other
        else not (one.get(name) or other[name]).value or (one.get(name) or other[name]).kind == "length"
        for name in {*one, *other}
    )


def is_named(fit, plan, model, planted):
    """Whether a fit is the planted fault: by its name, or by the linkage that it makes."""
    named = fit.fault.name
    if plan.names:
        return any(named == name or (name.endswith(":") and named.startswith(name)) for name in plan.names)
    try:
        return is_same(fit.applied(model).linkage, planted, model.linkage)
    except LinkproofError:
        return False


def outcome(export, judgement):
    """The outcome of a judgement, in one or two words."""
    findings = judgement.explanation.findings
    if not export.plans:
        over = any(verdict.outcome is Verdict.OVER_LIMIT for verdict in judgement.verdicts)
        return "false alarm" if findings or over else "clean" if judgement.passed else "open"
    if not findings and judgement.passed:
        return "within the limit"
    with tempfile.TemporaryDirectory() as folder:
        (path := Path(folder) / "planted.toml").write_text(export.faulty)
        planted = load(str(path))
    right = [
        [any(is_named(fit, p, judgement.model, planted) for p in export.plans) for fit in f.every] for f in findings
    ]
    if not findings:
        return "no cause"
    if all(first for first, *_ in right):
        return "first, rest open" if judgement.explanation.unexplained else "first"
    return "tied" if all(map(any, right)) else "misnamed"


def answer(judgement, back):
    """The causes, and the signals without one, in the linkage's own names."""

    def own(text):
        return re.sub(r"\w+", lambda word: back.get(word[0], word[0]), text)

    causes = [
        (own(f.likeliest.fault.name), *(f"{x:.3g}" for x in f.likeliest.numbers))
        for f in judgement.explanation.findings
    ]
    return sorted(causes), sorted(map(own, judgement.explanation.unexplained))


def trial(kind, number, seed=0):
    """Outcome of a case, whether renaming changes it, CPU time of the first judgement, s, and a line for the log."""
    export, again = (case(seed, number, KINDS[kind], rename=rename) for rename in (False, True))
    begun = clock.process_time()
    try:
        judgement = judged(export)
    except LinkproofError as error:
        return "refused", False, clock.process_time() - begun, str(error)
    seconds = clock.process_time() - begun
    try:
        changes = answer(judgement, {}) != answer(judged(again), again.back)
    except LinkproofError:
        changes = True
    causes = [f"{fit.words} {f.signals}" for f in judgement.explanation.findings for fit in f.every]
    errors = [f"{v.name} {v.error_max:.1e}/{v.floor:.1e}" for v in judgement.verdicts]
    words = f"{[p.kind for p in export.plans]} {export.layout} {errors} {causes} {judgement.explanation.unexplained}"
    return outcome(export, judgement), changes, seconds, words


def main(kind="fault", count=100, seed=0, first=0):
    """Print every miss, and the rates."""
    outcomes, changed, times = Counter(), 0, []
    for number in range(int(first), int(first) + int(count)):
        came, changes, seconds, words = trial(kind, number, int(seed))
        outcomes[came] += 1
        changed += changes
        times.append(seconds)
        if came not in RIGHT or changes:
            sys.stdout.write(f"{number} {came}{', changed by renaming' if changes else ''}: {words}\n")
    spent = f"CPU median {np.median(times):.2f} s, largest {max(times):.2f} s"
    sys.stdout.write(f"{dict(outcomes)}, {changed} changed by renaming; {spent}\n")


if __name__ == "__main__":
    main(*sys.argv[1:])
