"""A folder judged anew: texts, curves and records compared with each other and with the closed form."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Final

import numpy as np
from numpy.typing import NDArray

from analytic.errors import LinkproofError
from comparisons.campaign.key_figures import changes
from comparisons.campaign.project import checksum
from comparisons.campaign.results import Results, is_saved, load
from comparisons.datasheet.saved import FILE as SHEETS
from comparisons.folders.difference import Place, as_baseline, saved_cases, saved_figures
from comparisons.folders.studies import StudyFolder, check_studies
from comparisons.judging.baseline import Baseline
from comparisons.judging.deviations import Deviation, signal_deviation
from comparisons.judging.limits import LimitTable, Standard, read_limits, shipped_limits
from comparisons.judging.quantities import Quantity, chosen_quantities
from comparisons.judging.records import Record
from comparisons.reference.case import Case
from comparisons.runs.environment import environment
from engines.contract import Signal

# Of a peak: what rounding may change on another machine. A thousandth of the tightest limit.
SAME_SHARE: Final = 1e-9


@dataclass(frozen=True)
class VerificationFinding:
    """A contradiction within a folder or with the closed form: its place, and a sentence."""

    place: str
    sentence: str


@dataclass(frozen=True)
class Verification:
    """The result of judging a folder anew.

    ``records`` and ``invariants`` are as judged now, ``curves``, ``figures`` and ``texts`` count what was computed
    again; ``studies`` are others, checked for contradictions; ``notes`` say what they were judged by and what
    a folder cannot show.
    """

    records: tuple[Record, ...] = ()
    invariants: tuple[Record, ...] = ()
    curves: int = 0
    figures: int = 0
    texts: int = 0
    notes: tuple[str, ...] = ()
    findings: tuple[VerificationFinding, ...] = ()
    studies: tuple[str, ...] = ()


class _SavedBounds(Baseline):
    """The bounds of a baseline as records have them; the baseline itself stayed where they were made."""

    def allowed(self, record: Record) -> float | None:
        """The bound in the record."""
        return record.baseline


def verify(folder: Path, limits: Path | None = None) -> Verification:
    """Judge a campaign by the limits saved in its folder or by a file's, and hold other studies against themselves.

    Every curve of a campaign is compared with the closed form of the folder's texts, computed now, and every record
    against its curve. Raises LinkproofError for a folder that cannot be read, or that judge wrote.
    """
    studies = list(check_studies(StudyFolder(folder)))
    verification = Verification()
    if is_saved(folder) or not studies:
        verification = _verify_campaign(load(folder, with_sheets=False), folder, limits)
    faults = (VerificationFinding(*fault) for _, faults in studies for fault in faults)
    extents = tuple(extent for extent, _ in studies)
    return replace(verification, studies=extents, findings=(*verification.findings, *faults))


def _verify_campaign(results: Results, folder: Path, limits: Path | None) -> Verification:
    """A campaign judged anew."""
    if "judgement" in results.document:
        raise LinkproofError(
            f"expected the folder of a compare in '{folder}', got one of judge: judge the tool's own files again"
        )
    cases = saved_cases(results)
    table, sentence = _limits_to_use(results, limits)
    standard = Standard(table, _SavedBounds())
    judged = [_judge_again(results, cases[record.run[:3]], record, standard) for record in results.records]
    invariants = [(fresh := standard.judge(record), _verdict_faults(record, fresh)) for record in results.invariants]
    return Verification(
        tuple(record for record, _ in judged),
        tuple(record for record, _ in invariants),
        sum(record.error_max is not None for record in results.records),
        len(results.figures),
        len(results.linkages),
        (sentence, *_verification_notes(results, folder)),
        (
            *_text_findings(results),
            *(
                VerificationFinding(_record_name(record), words)
                for record, names in (*judged, *invariants)
                for words in names
            ),
            *_figure_findings(results, cases),
        ),
    )


def _record_name(record: Record) -> str:
    return f"{record.key}: {record.quantity}"


def _limits_to_use(results: Results, file: Path | None) -> tuple[LimitTable, str]:
    """The table of limits to judge by, and a note on its origin."""
    if file is not None:
        return read_limits(file), f"judged by the limits of {file}"
    shipped = shipped_limits().as_dict
    others = [row for row in results.limits.as_dict if row not in shipped]
    added = [f"{', '.join(row['quantities'])} {row['value']:g} ({row['reason']})" for row in others]
    words = f"judged by the folder's limits, of which this version has not: {'; '.join(added)}" if added else ""
    return results.limits, words or "judged by the limits of this version, which are the folder's"


def _verification_notes(results: Results, folder: Path) -> Iterator[str]:
    made, here = results.document["environment"], environment()
    changed = [f"{name} {made[name]} ({here[name]} here)" for name in ("linkproof", "numpy", "scipy")
               if name in made and made[name] != here.get(name, made[name])]  # fmt: skip
    if changed:
        yield f"made with {', '.join(changed)}"
    if results.invariants:
        yield (
            f"{len(results.invariants)} invariants are judged by their saved errors: the motions that they check are "
            "not in the folder"
        )
    if any(record.baseline is not None for record in results.records):
        yield "what a baseline allowed is taken from the records: the baseline is not in the folder"
    if not (folder / SHEETS).is_file():
        yield f"the folder has no {SHEETS}, without which no pages are made of it"


def _text_findings(results: Results) -> Iterator[VerificationFinding]:
    for row in results.document["descriptions"]:
        now = checksum(row["text"])
        if row.get("checksum", now) != now:
            yield VerificationFinding(
                f"{row['name']} ({row['variant']})", f"its text has the checksum {now}, recorded is {row['checksum']}"
            )


def _judge_again(results: Results, case: Case, record: Record, standard: Standard) -> tuple[Record, list[str]]:
    """A record as its curve has it, judged now, and what of it is not as saved."""
    if record.error_max is None:
        return record, []
    (quantity,) = chosen_quantities(case, [record.quantity])
    time, angle, observed, reference = results.curve(record.run, record.quantity)
    deviation = signal_deviation(case, quantity, Signal(time, observed), record.samples + record.left_out)
    faults = [*_curve_faults(deviation, angle, reference), *_error_faults(case, quantity, deviation, record)]
    measured = max(deviation.error_max, record.error_max) if _is_vector(case, quantity) else deviation.error_max
    fresh = standard.judge(replace(record, error_max=measured, error_at_jumps=deviation.error_at_jumps))
    return fresh, faults + _verdict_faults(record, fresh)


def _is_vector(case: Case, quantity: Quantity) -> bool:
    return quantity.reference(case, np.zeros(1)).ndim > 1


def _curve_faults(deviation: Deviation, angle: NDArray[np.float64], reference: NDArray[np.float64]) -> Iterator[str]:
    """Saved reference curves that differ from the closed form of the folder's text."""
    scale = deviation.peak or 1.0
    off = float(np.max(np.abs(deviation.reference - reference), initial=0.0)) / scale
    if not off <= SAME_SHARE:
        yield f"the saved reference differs from the closed form of the folder's text by {off:.2g} of the peak"
    turned = float(np.max(np.abs(deviation.angle - angle), initial=0.0))
    if not turned <= SAME_SHARE * max(1.0, float(np.max(np.abs(deviation.angle), initial=0.0))):
        yield f"the saved crank angle differs from the folder's motion by {turned:.2g}"


def _error_faults(case: Case, quantity: Quantity, deviation: Deviation, record: Record) -> Iterator[str]:
    """Records that contradict their curves; magnitudes of a vector bound its errors from below."""
    pairs = {
        "error_max": deviation.error_max,
        "error_rms": deviation.error_rms,
        "error_at_jumps": deviation.error_at_jumps,
    }
    for name, now in pairs.items():
        saved = getattr(record, name) or 0.0
        if name == "error_max" and saved == record.error_at_jumps > now:
            continue  # a record that failed at a jump has that error
        slack = SAME_SHARE + SAME_SHARE * now
        if not (now <= saved + slack and (saved <= now + slack or _is_vector(case, quantity))):
            yield f"its {name} is {saved:.3g}, its curve's is {now:.3g}"
    if record.samples != deviation.samples:
        yield f"it states {record.samples} compared samples, its curve has {deviation.samples}"
    if not abs((record.peak or 0.0) - deviation.peak) <= SAME_SHARE * deviation.peak:
        yield f"its peak is {record.peak:.9g}, the closed form's is {deviation.peak:.9g} {record.unit}"


def _verdict_faults(record: Record, fresh: Record) -> list[str]:
    """A verdict or a limit that is not the saved one."""
    if record.outcome != fresh.outcome:
        detail = f": {fresh.detail}" if fresh.detail else ""
        return [f"saved as {record.outcome}, judged {fresh.outcome}{detail}"]
    if record.limit is not None and fresh.limit is not None and record.limit != fresh.limit:
        return [f"its limit is {record.limit:.3g}, judged by {fresh.limit:.3g}; {fresh.outcome} by both"]
    return []


def _figure_findings(results: Results, cases: Mapping[Place, Case]) -> Iterator[VerificationFinding]:
    """Key figures that the folder's texts do not give."""
    for figure in changes(cases.values(), as_baseline(results, saved_figures(results))):
        if figure.recorded is not None:  # earlier versions had fewer
            yield VerificationFinding("key figures", figure.sentence)
