"""A baseline: errors and key figures as recorded before, to notice what changed within its limit.

One JSON file beside a user's linkages, with an entry per linkage file, by its path from there; two files of one name
have an entry each.
"""

from __future__ import annotations

import json
import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import chain
from pathlib import Path
from typing import Any, Final

from analytic.description.crank_motion import LAWS, REGIMES
from analytic.description.linkage import Linkage
from analytic.errors import LinkproofError
from comparisons.judging.records import Record
from comparisons.runs.files import write_text

FORMAT: Final = 1
# A deviation may grow to this multiple of its recorded value before the check fails.
GROWTH: Final = 3.0
# Deviations below this share of their limit are round-off and are never judged by growth.
FLOOR_SHARE: Final = 1e-3
# What a key figure of the closed form may change by, relative.
SAME_FIGURE: Final = 1e-6
OLD_ENDING: Final = r"\.first$"  # an earlier name of figures at the time 0


@dataclass(frozen=True)
class Place:
    """A linkage's place in a baseline: its file's path from there, and the checksum of its text."""

    path: str
    checksum: str


@dataclass(frozen=True)
class Coverage:
    """The extent of a comparison with a baseline, and the departures that it allows.

    ``every_linkage`` says that the linkages are all there are, ``every_motion`` that a linkage's motions are,
    ``every_variant`` that key figures of its other variants, which no engine runs, are compared;
    ``new_motions`` that a motion without a record fails. An allowed departure is a note. ``figures`` are names of
    figures that are compared besides the key figures.
    """

    every_linkage: bool = False
    every_motion: bool = False
    every_variant: bool = False
    new_motions: bool = True
    allow_new: bool = False
    allow_missing: bool = False
    figures: tuple[str, ...] = ()


@dataclass(frozen=True)
class Baseline:
    """A baseline. ``places`` contains every linkage's place, by the name in its records.

    ``linkages`` is as in the file: by path its checksum, and by variant and regime with its conditions the figures, and
    by engine and setting the errors. ``lost`` are paths in it whose files do not exist any more; ``is_recorded`` is
    false where there is no file yet.
    """

    linkages: Mapping[str, Any] = field(default_factory=dict)
    places: Mapping[str, Place] = field(default_factory=dict)
    lost: tuple[str, ...] = ()
    coverage: Coverage = field(default_factory=Coverage)
    is_recorded: bool = True

    def allowed(self, record: Record) -> float | None:
        """The largest deviation that the baseline allows; None without a record."""
        errors = self._recorded_regime(record).get("errors", {}).get(f"{record.engine} {record.setting}", {})
        value = errors.get(record.quantity)
        if value is None or record.limit is None:
            return None
        return max(GROWTH * float(value), FLOOR_SHARE * record.limit)

    def figures(self, record: Record) -> Mapping[str, float]:
        """The key figures recorded for a record's linkage, variant and regime; empty without a record."""
        recorded = self._recorded_regime(record).get("figures", {})
        return {re.sub(OLD_ENDING, "@0s", name): float(value) for name, value in recorded.items()}

    @property
    def regimes(self) -> frozenset[str]:
        """Names of all regimes of which anything was recorded."""
        variants = (regimes for entry in self.linkages.values() for regimes in entry["variants"].values())
        return frozenset(key.partition(": ")[0] for regimes in variants for key in regimes)

    def changed(self) -> tuple[str, ...]:
        """Paths of the files that are not as they were when their entry was recorded."""
        known = [place for place in self.places.values() if place.path in self.linkages]
        return tuple(place.path for place in known if self.linkages[place.path]["checksum"] != place.checksum)

    def _recorded_regime(self, record: Record) -> Mapping[str, Any]:
        place = self.places.get(record.mechanism)
        entry = self.linkages.get(place.path, {}) if place else {}
        table: Mapping[str, Any] = entry.get("variants", {}).get(record.variant, {}).get(_record_key(record), {})
        return table

    def recorded(
        self,
        records: Iterable[Record],
        figures: Mapping[tuple[str, str, str], Any],
        without: Iterable[tuple[str, ...]] = (),
    ) -> Baseline:
        """A baseline with these records and figures, by mechanism, variant and ``regime_key``, in place of older ones.

        Entries at the places ``without`` are left out: a path, with a variant, with a regime's key.
        """
        linkages = json.loads(json.dumps(self.linkages))
        for path, *below in without:
            *above, last = [path, "variants", *below] if below else [path]
            table = linkages
            for name in above:
                table = table[name]
            del table[last]
        for record in records:
            regime = self._writable_entry(linkages, record.mechanism, record.variant, _record_key(record))
            if record.error_max is not None:
                errors = regime.setdefault("errors", {}).setdefault(f"{record.engine} {record.setting}", {})
                errors[record.quantity] = float(f"{record.error_max:.3e}")
        for (mechanism, variant, key), values in figures.items():
            self._writable_entry(linkages, mechanism, variant, key)["figures"] = {
                name: float(f"{value:.9g}") for name, value in values.items()
            }
        return Baseline(linkages, self.places, coverage=self.coverage)

    def _writable_entry(self, linkages: dict[str, Any], mechanism: str, variant: str, key: str) -> dict[str, Any]:
        place = self.places[mechanism]
        entry = linkages.setdefault(place.path, {"variants": {}})
        entry["checksum"] = place.checksum
        table: dict[str, Any] = entry["variants"].setdefault(variant, {}).setdefault(key, {})
        return table

    def write(self, path: Path) -> None:
        """Write the file in one step, sorted, so that two of them are compared line by line."""
        document = {"format": FORMAT, "linkages": self.linkages}
        write_text(path, json.dumps(document, indent=1, sort_keys=True, ensure_ascii=False) + "\n")


def _record_key(record: Record) -> str:
    return regime_key(record.regime, record.conditions)


def regime_key(regime: str, conditions: str) -> str:
    """The key of an entry's regime: with speed, times and angles."""
    return f"{regime}: {conditions}"


def read_baseline(path: Path, places: Mapping[str, Place]) -> Baseline:
    """A baseline back from its file, empty if the file does not exist; raises LinkproofError for a damaged one."""
    if not path.exists():
        return Baseline({}, places, is_recorded=False)
    try:
        document = json.loads(path.read_text(encoding="utf-8"))
        if document["format"] != FORMAT:
            raise LinkproofError(
                f"expected a baseline of format {FORMAT} in '{path}', got format {document['format']!r}: read it with "
                "the version that wrote it, or record it anew"
            )
        for entry in document["linkages"].values():
            _check_entry(entry)
        return Baseline(document["linkages"], places)
    except OSError as error:
        raise LinkproofError(
            f"expected a baseline of linkproof in '{path}', got '{error.strerror}'; check it"
        ) from error
    except (ValueError, TypeError, KeyError, AttributeError) as error:
        raise LinkproofError(
            f"expected a baseline of linkproof in '{path}', got a damaged file ({error}); restore it, or delete it to "
            "judge by the limits alone"
        ) from error


def _check_entry(entry: Any) -> None:  # noqa: ANN401 - whatever JSON holds
    """Raise ValueError, TypeError, KeyError or AttributeError for an invalid entry."""
    str.encode(entry["checksum"])
    for regimes in entry["variants"].values():
        for regime in regimes.values():
            tables = [regime.get("figures", {}), *regime.get("errors", {}).values()]
            for value in (value for table in tables for value in table.values()):
                float(value)


# Departures of a comparison from its baseline: linkages, variants and motions missing, new or renamed.

RECORD_HINT = "--record-baseline records it"
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
            words = f"{old} is in the baseline and {gone} any more: {RECORD_HINT}, {MISSING} lets it be"
            result.append(Departure((old,), words, is_recorded=True, is_allowed=coverage.allow_missing))
            continue
        new.remove(twin)
        words = f"{old} was renamed to {twin}, its text is the same: {RECORD_HINT}, {NEW} and {MISSING} let it be"
        result.append(
            Departure((old,), words, is_recorded=True, is_allowed=coverage.allow_new and coverage.allow_missing)
        )
    words = f"is not in the baseline: {RECORD_HINT}, {NEW} lets it be"
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
            groups += [_missing_motions(place.path, linkage, keys, baseline), _new_motions(place.path, keys, baseline)]
    return tuple(chain.from_iterable(groups))


def _missing_motions(
    path: str, linkage: Linkage, keys: Mapping[str, Sequence[str]], baseline: Baseline
) -> Iterator[Departure]:
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
        gone = f"{_place_words(place)} is in the baseline and is not compared any more"
        words = f"{gone}: {RECORD_HINT}, {MISSING} lets it be"
        yield Departure(place, words, is_recorded=True, is_allowed=coverage.allow_missing)


def _new_motions(path: str, keys: Mapping[str, Sequence[str]], baseline: Baseline) -> Iterator[Departure]:
    """Motions without a recorded figure, by variant."""
    coverage, recorded = baseline.coverage, baseline.linkages[path]["variants"]
    for variant, key in ((variant, key) for variant, compared in keys.items() for key in compared):
        if not recorded.get(variant, {}).get(key, {}).get("figures"):
            place = (path, variant, key)
            words = f"{_place_words(place)} is not in the baseline: {RECORD_HINT}, {NEW} lets it be"
            is_allowed = coverage.allow_new or not coverage.new_motions
            yield Departure(place, words, is_recorded=False, is_allowed=is_allowed)


def _place_words(place: tuple[str, ...]) -> str:
    path, variant, *motion = place
    return f"{path} ({variant})" + "".join(f", {words}" for words in motion)
