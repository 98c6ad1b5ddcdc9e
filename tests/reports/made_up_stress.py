"""A finished stress test of engines that do not exist, with every verdict in it, for tests of its page and tables."""

from dataclasses import replace
from itertools import pairwise

from comparisons.stress.campaign import Stress
from comparisons.stress.cells import axes
from comparisons.stress.verdict import Cell, StressVerdict, blank_result

SETTINGS = ("naive", "tuned", "best")
METHODS = {"alpha": ("generalised alpha", "trapezoidal"), "beta": ("centred", "defaults")}
REASON = "velocity of <rod> off by 0.3 of the peak at 0.01 s"


def made_up_stress(
    names=("mass", "change-point", "speed"), engines=("alpha", "beta"), *, quick=False, cells=None, **changes
):
    """Axes as the table has them, verdicts in turn where a line is beyond its border."""
    results, borders = [], []
    for name in names:
        axis = axes()[name]
        for row in axis.chosen_rows(quick=quick):
            for engine in engines:
                for usage in METHODS[engine] if axis.methods else SETTINGS:
                    values = axis.chosen_values(row, quick=quick)
                    line = [
                        made_up_cell(
                            verdict(row.label, value, usage, axis.good, values),
                            axis=name, row=row.label, value=value, engine=engine, usage=usage,
                        )
                        for value in values
                    ]  # fmt: skip
                    results += line
                    borders += _borders(line)
    document = {
        "command": "linkproof stress --out 'a <folder>'",
        "environment": {"date": "today", "machine": "this one", "commit": "none", "python": "3"},
        "quick": quick,
        "borders": borders,
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
    cell = Cell(**place)
    found = {"verdict": came_to, "reason": reason, "differing": {"linkage": "m"}, "spent": 0.5, "steps": 10}
    return replace(blank_result(cell, "m"), **found)


def border(inside, outside, beyond, **place):
    """One border as the document has it."""
    commands = {"inside_command": "in", "outside_command": "out"}
    middle = 0.5 * (inside + outside)
    return {**place, "value": middle, "inside": inside, "outside": outside, "verdict": beyond, **commands}


def _borders(line):
    """Between every two neighbours of which one alone is within, a third of the way."""
    found = []
    for one, other in pairwise(line):
        within = [cell for cell in (one, other) if cell.verdict is StressVerdict.WITHIN]
        if len(within) == 1:
            (beyond,) = [cell for cell in (one, other) if cell not in within]
            inner, outer = within[0].cell.value, beyond.cell.value
            cell = beyond.cell
            place = {"axis": cell.axis, "row": cell.row, "engine": cell.engine, "usage": cell.usage}
            found.append(border(inner + 0.30 * (outer - inner), inner + 0.31 * (outer - inner), beyond.verdict.value,
                                **place))  # fmt: skip
    return found
