"""A finished stress test of engines that do not exist, with every verdict in it, for tests of its page and tables."""

from comparisons.trials.stress.campaign import Stress
from comparisons.trials.stress.cells import StressVerdict, axes
from tests.comparisons.true_motions import cell

SETTINGS = ("naive", "tuned", "best")
METHODS = {"alpha": ("generalised alpha", "trapezoidal"), "beta": ("centred", "defaults")}
REASON = "velocity of <rod> off by 0.3 of the peak at 0.01 s"


def made_up_stress(
    names=("mass", "change-point", "speed"), engines=("alpha", "beta"), *, quick=False, cells=None, **changes
):
    """Axes as the table has them, verdicts in turn where a line is beyond its border."""
    results = []
    for name in names:
        axis = axes()[name]
        for row in axis.chosen_rows(quick=quick):
            for engine in engines:
                for usage in METHODS[engine] if axis.methods else SETTINGS:
                    values = axis.chosen_values(row, quick=quick)
                    results += [
                        made_up_cell(
                            verdict(row.label, value, usage, axis.good, values),
                            axis=name, row=row.label, value=value, engine=engine, usage=usage,
                        )
                        for value in values
                    ]  # fmt: skip
    document = {
        "command": "linkproof stress --out 'a <folder>'",
        "environment": {"date": "today", "machine": "this one", "commit": "none", "python": "3"},
        "quick": quick,
    }
    return Stress({**document, **changes}, results if cells is None else cells)


def verdict(row, value, usage, good, values):
    """Within the limit near the easy value; beyond, every other verdict in turn."""
    far = abs(values.index(value) - values.index(good)) if good in values else values.index(value)
    reaches = 3 + ("naive", "tuned", "best").index(usage) if usage in SETTINGS else 4
    others = [verdict for verdict in StressVerdict if verdict is not StressVerdict.WITHIN]
    beyond = max(0, far - reaches)
    turn = (beyond + len(row)) % len(others) if beyond > 1 else 0
    return others[turn] if beyond else StressVerdict.WITHIN


def made_up_cell(came_to, **place):
    """One cell of a verdict."""
    reason = "" if came_to is StressVerdict.WITHIN else REASON
    return cell(**place, verdict=came_to, reason=reason, differing={"linkage": "m"}, spent=0.5, steps=10)
