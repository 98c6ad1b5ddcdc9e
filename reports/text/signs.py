"""Verdicts as a reader meets them: a sign, a word and a colour; sign and word carry the meaning without the colour."""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

from comparisons.judging.records import Verdict


class VerdictSign(NamedTuple):
    """``style`` is a class of the page's style sheet, ``colour`` a colour of the terminal."""

    symbol: str
    word: str
    style: str
    colour: str


RUNS: Mapping[str, VerdictSign] = {
    Verdict.PASSED.value: VerdictSign("✓", "within its limit", "pass", "green"),
    Verdict.OVER_LIMIT.value: VerdictSign("✗", "over its limit", "over", "red"),
    Verdict.DIVERGED.value: VerdictSign("✗", "diverged", "failed", "red"),
    Verdict.UNSUPPORTED.value: VerdictSign("–", "unsupported", "absent", "yellow"),
    Verdict.UNAVAILABLE.value: VerdictSign("–", "not installed", "absent", "yellow"),
    Verdict.TIMED_OUT.value: VerdictSign("✗", "timed out", "failed", "red"),
    Verdict.CRASHED.value: VerdictSign("✗", "crashed", "failed", "red"),
    Verdict.ADAPTER_ERROR.value: VerdictSign("✗", "adapter error", "failed", "red"),
    Verdict.SUITE_ERROR.value: VerdictSign("–", "fault of linkproof", "absent", "bold red"),
    Verdict.UNDEFINED.value: VerdictSign("?", "undefined", "absent", "yellow"),
}
PUBLISHED: Mapping[str, VerdictSign] = {
    "reproduced": VerdictSign("✓", "reproduced", "pass", "green"),
    "within 6 %": VerdictSign("≈", "within 6 %", "near", ""),
    "not reproduced": VerdictSign("✗", "not reproduced", "over", "red"),
}
