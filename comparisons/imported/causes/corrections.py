"""Corrections that a file seems to need: estimated, said, and applied only where the mapping agrees to them."""

from __future__ import annotations

from collections.abc import Collection, Mapping

from comparisons.imported.causes.search import Explanation
from comparisons.imported.columns import NO_CORRECTION, Correction


def proposals(
    explanation: Explanation, columns: Collection[str], agreed: Mapping[str, Correction]
) -> dict[str, Correction]:
    """The corrections among the likeliest causes by the names of ``columns``, those agreed to already included."""
    found: dict[str, Correction] = {}
    for finding in explanation.findings:
        for name, correction in finding.corrections.items():
            for one in finding.signals if name == "*" else (name,):
                if one in columns:
                    found[one] = combined(agreed.get(one, NO_CORRECTION), correction)
    return found


def combined(first: Correction, then: Correction) -> Correction:
    """One correction after another."""
    return Correction(
        first.sign * then.sign,
        first.factor * then.factor,
        first.time_shift + then.time_shift,
        then.sign * first.angle_offset + then.angle_offset,
    )


def written(correction: Correction) -> str:
    """A correction as the keys of a mapping."""
    return ", ".join(correction.keys(digits=6)) or "nothing"
