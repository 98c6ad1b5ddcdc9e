"""The diagram of error over cost, as data for its script: any mechanism, quantity and measure of the cost."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from comparisons.work_precision.places import EngineFacts, PlaceFacts, Regimes
from comparisons.work_precision.records import SETTING, BenchRecord
from reports.document.parts import Widget
from reports.document.templates import plain
from reports.records.views import anchor
from reports.work_precision.overview import drawn_error, inks
from reports.work_precision.words import effort_words, limit_words, way

LABEL = "Error over cost: a point is a method at one step, or a setting"
# What the points of a sweep share, and what each has of its own: cost, s, steps and work.
SHARED = ("engine", "engine_version", "kind", "setting", "runs", "work_unit")
OWN = ("step", "steps_per_turn", "seconds", "seconds_median", "setup_seconds", "readout_seconds", "steps",
       "solver_work", "used")  # fmt: skip


def widget(regimes: Regimes, labels: Mapping[str, str]) -> Widget:
    """The diagram of all places; the first one is on the page, the others are loaded when they are chosen."""
    places = {
        anchor(facts.mechanism, facts.variant, facts.regime): facts for factses in regimes.values() for facts in factses
    }
    colours, (first, *others) = inks(labels), places
    data = {
        "places": [[key, f"{place.mechanism}, {place.regime}"] for key, place in places.items()],
        "engines": [[name, label, colours[name]] for name, label in labels.items()],
        "first": place_data(places[first]),
    }
    return Widget("bench", "diagram", LABEL, data, {key: place_data(places[key]) for key in others})


def place_data(place: PlaceFacts) -> dict[str, Any]:
    """Sweeps and settings of one mechanism and regime, JSON-ready.

    A quantity is its name, a reader's, its unit and the closed form's peak; the foremost is the first. A sweep's
    ``ends`` have by quantity what limits the error, and the order; a point's ``errors`` are, over the peak, the largest
    as drawn, the largest and the root mean square.
    """
    names = sorted(place.quantities, key=lambda name: name != place.foremost)
    sweeps: dict[tuple[object, ...], dict[str, Any]] = {}
    peaks = {}
    for facts in (entry for name in names for entry in place.engines(name)):
        for record in facts.records:
            if record.finished and (quantity_record := record.error):
                point = _point(sweeps.setdefault(_sweep(record), _shared(facts, record)), record)
                errors = (drawn_error(record), quantity_record.error_max, quantity_record.error_rms)
                point["errors"][record.quantity] = [*map(_digits, errors)]
                peaks[record.quantity] = [quantity_record.unit, _digits(quantity_record.peak)]
        for sweep in facts.sweeps:
            sweeps[_sweep(sweep.first)]["ends"][sweep.first.quantity] = [limit_words(sweep), _digits(sweep.order)]
    tables = [{**sweep, "points": list(sweep["points"].values())} for sweep in sweeps.values()]
    return {"quantities": [[name, plain(name), *peaks[name]] for name in names], "sweeps": tables}


def _sweep(record: BenchRecord) -> tuple[object, ...]:
    return (record.engine, record.kind, record.setting, record.effort)


def _shared(facts: EngineFacts, record: BenchRecord) -> dict[str, Any]:
    own, solver = record.kind == SETTING or facts.is_own(record), effort_words(record.effort, record.effort_unit)
    table = {name: getattr(record, name) for name in SHARED}
    return {**table, "way": way(facts, record), "own": own, "solver": solver, "ends": {}, "points": {}}


def _point(sweep: dict[str, Any], record: BenchRecord) -> dict[str, Any]:
    words = {name: _digits(getattr(record, name)) for name in OWN}
    table: dict[str, Any] = sweep["points"].setdefault(record.step, {**words, "errors": {}})
    return table


def _digits(value: object) -> object:
    """A number to four digits, which is all that a reader sees; anything else as it is."""
    return float(f"{value:.4g}") if isinstance(value, float) else value
