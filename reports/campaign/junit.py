"""A campaign as test cases in JUnit's XML, which CI services show: one for every record and every change."""

from __future__ import annotations

import re
from collections.abc import Container, Iterable, Iterator, Sequence
from typing import Final
from xml.etree import ElementTree

from comparisons.trials.judging.changes import Change
from comparisons.trials.judging.limits import deciding, grouped
from comparisons.trials.judging.records import Error, RunRecord, Verdict

ILLEGAL: Final = re.compile("[^\t\n\r\x20-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")
CHANGES: Final = "changes"  # the suite of what is not as it was recorded


def junit(runs: Iterable[RunRecord], changes: Sequence[Change] = ()) -> str:
    """JUnit's XML of a campaign as text: a suite per mechanism, variant and regime; the class of a case is its run.

    Skipped are records that are not judged, naive ones that fail beside other settings, and what was not recorded
    before. Changes are a suite of their own.
    """
    by_motion = grouped((run.run[:3], run) for run in runs)
    records = [record for part in by_motion.values() for run in part for record in run.every]
    decisive = {record.setting for record in deciding(records)}
    suites = {
        "/".join(motion): [_record_case(record, decisive) for run in part for record in run.every]
        for motion, part in by_motion.items()
    }
    seconds = {"/".join(motion): sum(run.total_seconds for run in part) for motion, part in by_motion.items()}
    if changes:
        suites[CHANGES] = list(map(_change_case, changes))
    counts = _outcome_counts([case for cases in suites.values() for case in cases])
    root = ElementTree.Element("testsuites", {"name": "linkproof"} | counts)
    for suite, cases in suites.items():
        name = {"name": _legal(suite), "time": f"{seconds.get(suite, 0.0):.6f}"}
        ElementTree.SubElement(root, "testsuite", name | _outcome_counts(cases)).extend(cases)
    ElementTree.indent(root, " ")
    return f'<?xml version="1.0" encoding="utf-8"?>\n{ElementTree.tostring(root, encoding="unicode")}\n'


def _record_case(record: Error, decisive: Container[str]) -> ElementTree.Element:
    """A record as JUnit's test case: passed, failed, in error for a fault of linkproof, or skipped if not judged.

    One over its limit is skipped where its setting is not among the ``decisive`` ones.
    """
    case = _test_case("/".join(record.run), record.quantity)
    verdict, decides = Verdict(record.outcome), record.setting in decisive
    if verdict is Verdict.PASSED:
        return case
    kind = "error" if verdict is Verdict.SUITE_ERROR else "failure" if verdict.failed and decides else "skipped"
    words = (
        record.detail if decides or not verdict.failed else f"decides nothing beside other settings: {record.detail}"
    )
    element = ElementTree.SubElement(case, kind, message=_legal(words), type=record.outcome)
    element.text = _legal("\n".join((f"{record.conditions}: {words}", *_number_lines(record))))
    return case


def _number_lines(record: Error) -> Iterator[str]:
    """Yield the record's error and its limit, a line each, where it has them."""
    if record.error_max is not None:
        yield f"error {record.error_max:.3e} of the peak, {record.peak or 0.0:.6g} {record.unit}".rstrip()
    if record.limit is not None:
        yield f"limit {record.limit:.3e}"


def _change_case(entry: Change) -> ElementTree.Element:
    """A change as JUnit's test case: a failure, or skipped if it does not fail."""
    mechanism, variant, regime, conditions, engine, setting, quantity = entry.place
    suite = (CHANGES, mechanism, variant, regime, engine, setting)
    case = _test_case("/".join(filter(None, suite)), quantity)
    kind = "failure" if entry.fails else "skipped"
    ElementTree.SubElement(case, kind, message=_legal(entry.sentence), type=entry.kind.value).text = conditions
    return case


def _test_case(place: str, name: str) -> ElementTree.Element:
    """An empty test case of JUnit called ``name``; ``place`` becomes its class name."""
    return ElementTree.Element("testcase", classname=_legal(place), name=_legal(name))


def _outcome_counts(cases: Sequence[ElementTree.Element]) -> dict[str, str]:
    """The numbers of tests, failures, errors and skipped tests among cases, as JUnit's attributes by name."""
    kinds = {"failures": "failure", "errors": "error", "skipped": "skipped"}
    counts = {name: sum(case.find(tag) is not None for case in cases) for name, tag in kinds.items()}
    return {"tests": str(len(cases)), **{name: str(count) for name, count in counts.items()}}


def _legal(text: str) -> str:
    """The text with � in place of characters that XML does not allow."""
    return ILLEGAL.sub("�", text)
