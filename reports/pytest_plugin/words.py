"""What a failed test says: why, and the command that repeats it."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace

from comparisons.campaign.key_figures import KeyFigure
from comparisons.invariants.checks import NEEDS as INVARIANTS
from comparisons.judging.records import Record
from reports.command_line.requests import CampaignChoice


def failure(record: Record, asked: CampaignChoice, notes: Iterable[str] = ()) -> str:
    """Why a requested record failed; ``notes`` are further remarks on the file."""
    again = replace(
        asked,
        engines=(record.engine,),
        settings=(record.setting,),
        regimes=(record.regime,),
        quantities=() if record.quantity in INVARIANTS else (record.quantity,),
    )
    run = (record.regime, f"{record.engine} {record.engine_version}".rstrip(), record.setting)
    place = f"{record.mechanism} ({record.variant}), {', '.join(run)}: {record.quantity}"
    return "\n".join((place, record.detail, *_size(record), *notes, f"repeat it: {again.command}"))


def _size(record: Record) -> tuple[str, ...]:
    if record.error_max is None or record.peak is None:
        return ()
    at = "" if record.worst_time is None else f", worst at {record.worst_time:.4g} s"
    return (f"error {record.error_max:.3e} of the peak, {record.peak:.6g} {record.unit}".rstrip() + at,)


def changed(figure: KeyFigure, asked: CampaignChoice, notes: Iterable[str] = ()) -> str:
    """How a requested key figure has changed, and the command that records it as it is now."""
    again = replace(asked, regimes=(figure.regime,))
    return "\n".join((figure.sentence, *notes, f"repeat it: {again.command}", f"if it is meant: {recording(again)}"))


def recording(asked: CampaignChoice) -> str:
    """The command that records the requested baseline."""
    return f"{asked.command} --record-baseline"
