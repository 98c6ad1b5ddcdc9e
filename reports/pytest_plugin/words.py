"""What a failed test says: why, and the command that repeats it."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace

from comparisons.campaign.key_figures import KeyFigure
from comparisons.invariants.checks import NEEDS as INVARIANTS
from comparisons.judging.records import Record
from reports.requests.options.campaign import CompareOptions
from reports.requests.options.declaring import command_line


def failure(record: Record, options: CompareOptions, notes: Iterable[str] = ()) -> str:
    """Why a requested record failed; ``notes`` are further remarks on the file."""
    again = replace(
        options,
        engine=(record.engine,),
        setting=(record.setting,),
        regime=(record.regime,),
        quantity=() if record.quantity in INVARIANTS else (record.quantity,),
    )
    run = (record.regime, f"{record.engine} {record.engine_version}".rstrip(), record.setting)
    place = f"{record.mechanism} ({record.variant}), {', '.join(run)}: {record.quantity}"
    return "\n".join((place, record.detail, *_size(record), *notes, f"repeat it: {command_line('compare', again)}"))


def _size(record: Record) -> tuple[str, ...]:
    if record.error_max is None or record.peak is None:
        return ()
    at = "" if record.worst_time is None else f", worst at {record.worst_time:.4g} s"
    return (f"error {record.error_max:.3e} of the peak, {record.peak:.6g} {record.unit}".rstrip() + at,)


def changed(figure: KeyFigure, options: CompareOptions, notes: Iterable[str] = ()) -> str:
    """How a requested key figure has changed, and the command that records it as it is now."""
    again = replace(options, regime=(figure.regime,))
    return "\n".join(
        (figure.sentence, *notes, f"repeat it: {command_line('compare', again)}", f"if it is meant: {recording(again)}")
    )


def recording(options: CompareOptions) -> str:
    """The command that records the requested baseline."""
    return f"{command_line('compare', options)} --record-baseline"
