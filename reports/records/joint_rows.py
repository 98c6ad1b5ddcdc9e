"""Joint forces of one regime as rows: peak by the closed form, largest error of every run."""

from __future__ import annotations

from comparisons.judging.quantities import JOINT_FORCE
from comparisons.judging.records import Record
from reports.document.numbers import ABSENT, figure, steady_error
from reports.document.parts import Table
from reports.document.templates import plain
from reports.records.views import Regime, View

CAPTION = "Joint forces: peak by the closed form, and the largest error of every run over it."


def joint_table(view: View, regime: Regime) -> Table | None:
    """A row per joint, largest peak first; None where the campaign asked for no joint forces."""
    records = [record for record in view.of(regime) if record.quantity.startswith(JOINT_FORCE)]
    if not records:
        return None
    runs = list(dict.fromkeys((r.engine, r.setting) for r in records))
    by_run = {(r.quantity, r.engine, r.setting): r for r in records}
    peaks = {
        name: _peak([r for r in records if r.quantity == name]) for name in dict.fromkeys(r.quantity for r in records)
    }
    rows = [
        (
            plain(name.removeprefix(JOINT_FORCE)),
            figure(peaks[name] or None),
            *(_error(by_run.get((name, *run))) for run in runs),
        )
        for name in sorted(peaks, key=lambda name: (-peaks[name], name))
    ]
    return Table(CAPTION, ("joint", "peak, N", *(" ".join(run) for run in runs)), tuple(rows))


def _peak(records: list[Record]) -> float:
    return max((r.peak for r in records if r.peak is not None), default=0.0)


def _error(record: Record | None) -> str:
    return ABSENT if record is None else steady_error(record.error_max)
