"""Departures of a comparison from its baseline: linkages, variants and motions missing, new or renamed."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import chain

from analytic.description.crank_motion import LAWS, REGIMES
from analytic.description.linkage import Linkage
from comparisons.judging.baseline import Baseline, regime_key
from comparisons.judging.records import Record

ANEW = "--record-baseline records it"
NEW, MISSING = "--allow-new", "--allow-missing"


@dataclass(frozen=True)
class Departure:
    """A departure from the baseline, in a sentence; if ``is_allowed`` it is only a note.

    ``place`` is a path, with a variant, with a regime and its conditions, as far as it goes; ``is_recorded`` says that
    it stands in the baseline, and is not compared any more.
    """

    place: tuple[str, ...]
    sentence: str
    is_recorded: bool
    is_allowed: bool


def departures(linkages: Sequence[Linkage], cases: Iterable[Record], baseline: Baseline) -> tuple[Departure, ...]:
    """Every departure of linkages and their motions from a baseline; empty as long as the baseline is."""
    return (*file_departures(baseline), *motion_departures(linkages, cases, baseline))


def file_departures(baseline: Baseline) -> tuple[Departure, ...]:
    """Linkages that are new, missing or, with the same text under another name, both: renamed."""
    if not baseline.is_recorded or not baseline.places:
        return ()
    coverage, recorded = baseline.coverage, baseline.linkages
    here = {place.path: place.checksum for place in baseline.places.values()}
    new = [path for path in here if path not in recorded]
    missing = [path for path in sorted({*recorded} - {*here}) if coverage.every_linkage or path in baseline.lost]
    result = []
    for old in missing:
        twin = next((path for path in new if here[path] == recorded[old]["checksum"]), None)
        if twin is None:
            gone = "does not exist" if old in baseline.lost else "is not compared"
            words = f"{old} is in the baseline and {gone} any more: {ANEW}, {MISSING} lets it be"
            result.append(Departure((old,), words, is_recorded=True, is_allowed=coverage.allow_missing))
            continue
        new.remove(twin)
        words = f"{old} was renamed to {twin}, its text is the same: {ANEW}, {NEW} and {MISSING} let it be"
        result.append(
            Departure((old,), words, is_recorded=True, is_allowed=coverage.allow_new and coverage.allow_missing)
        )
    words = f"is not in the baseline: {ANEW}, {NEW} lets it be"
    return (
        *result,
        *(Departure((path,), f"{path} {words}", is_recorded=False, is_allowed=coverage.allow_new) for path in new),
    )


def motion_departures(
    linkages: Sequence[Linkage], cases: Iterable[Record], baseline: Baseline
) -> tuple[Departure, ...]:
    """Of linkages that are in a baseline the variants and motions that are new or missing.

    ``cases`` are those that are compared, as blank records name them.
    """
    if not baseline.is_recorded:
        return ()
    groups, by_mechanism = [], dict[str, list[Record]]()
    for case in cases:
        by_mechanism.setdefault(case.mechanism, []).append(case)
    for linkage in linkages:
        place = baseline.places.get(linkage.name)
        if place is not None and place.path in baseline.linkages:
            variants = linkage.variants if baseline.coverage.every_variant else (linkage.variant,)
            keys: dict[str, list[str]] = {name: [] for name in variants}
            for case in by_mechanism.get(linkage.name, ()):
                keys[case.variant].append(regime_key(case.regime, case.conditions))
            groups += [_missing(place.path, linkage, keys, baseline), _new(place.path, keys, baseline)]
    return tuple(chain.from_iterable(groups))


def _missing(path: str, linkage: Linkage, keys: Mapping[str, Sequence[str]], baseline: Baseline) -> Iterator[Departure]:
    """Variants and regimes that the file has no more, and motions that are not compared though all are to be."""
    coverage, variants = baseline.coverage, baseline.linkages[path]["variants"]
    possible = tuple(f"{name}: " for name in (*REGIMES, *LAWS, *(regime.name for regime in linkage.regimes)))
    places: list[tuple[str, ...]] = [(path, variant) for variant in variants if variant not in linkage.variants]
    places += [
        (path, variant, key)
        for variant, compared in keys.items()
        for key in variants.get(variant, {})
        if key not in compared and (coverage.every_motion or not key.startswith(possible))
    ]
    for place in places:
        words = f"{_words(place)} is in the baseline and is not compared any more: {ANEW}, {MISSING} lets it be"
        yield Departure(place, words, is_recorded=True, is_allowed=coverage.allow_missing)


def _new(path: str, keys: Mapping[str, Sequence[str]], baseline: Baseline) -> Iterator[Departure]:
    """Motions without a recorded figure, by variant."""
    coverage, recorded = baseline.coverage, baseline.linkages[path]["variants"]
    for variant, key in ((variant, key) for variant, compared in keys.items() for key in compared):
        if not recorded.get(variant, {}).get(key, {}).get("figures"):
            place = (path, variant, key)
            words = f"{_words(place)} is not in the baseline: {ANEW}, {NEW} lets it be"
            is_allowed = coverage.allow_new or not coverage.new_motions
            yield Departure(place, words, is_recorded=False, is_allowed=is_allowed)


def _words(place: tuple[str, ...]) -> str:
    path, variant, *motion = place
    return f"{path} ({variant})" + "".join(f", {words}" for words in motion)
