"""The diagram of error over cost, as data for its script: any mechanism, quantity and measure of the cost."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from comparisons.work_precision.places import EngineFacts, PlaceFacts, Regimes
from comparisons.work_precision.records import SETTING, BenchRecord, PointError
from reports.document.parts import Widget
from reports.document.templates import plain
from reports.records.views import anchor
from reports.work_precision.overview import drawn_error, inks
from reports.work_precision.words import effort_words, limit_words, way

LABEL = "Error over cost: a point is a method at one step, or a setting"


def widget(regimes: Regimes, labels: Mapping[str, str]) -> Widget:
    """The diagram of all places; the first one is on the page, the others are loaded when they are chosen."""
    places = [place for found in regimes.values() for place in found]
    colours = inks(labels)
    data = {
        "places": [[_key(place), f"{place.mechanism}, {place.regime}"] for place in places],
        "engines": [[name, label, colours[name]] for name, label in labels.items()],
        "first": place_data(places[0]),
    }
    return Widget("bench", "diagram", LABEL, data, {_key(place): place_data(place) for place in places[1:]})


def _key(place: PlaceFacts) -> str:
    return anchor(place.mechanism, place.variant, place.regime)


def place_data(place: PlaceFacts) -> dict[str, Any]:
    """Sweeps and settings of one mechanism and regime, JSON-ready.

    A quantity is its name, a reader's, its unit and the closed form's peak. ``quantities`` starts with the foremost.
    """
    names = sorted(place.quantities, key=lambda name: name != place.foremost)
    engines = [(name, facts) for name in names for facts in place.engines(name)]
    sweeps: dict[tuple[object, ...], dict[str, Any]] = {}
    for name, facts in engines:
        for record in facts.records:
            if record.finished:
                key = (record.engine, record.kind, record.setting, record.effort)
                told = sweeps.setdefault(key, {**_sweep(facts, record), "points": {}})
                point = told["points"].setdefault(record.step, {**_point(record), "errors": {}})
                point["errors"][name] = _error(record)
        for sweep in facts.sweeps:
            first = sweep.first
            told = sweeps[first.engine, first.kind, first.setting, first.effort]
            told["ends"][name] = [limit_words(sweep), sweep.order and _digits(sweep.order)]
    return {
        "quantities": [[name, plain(name), *_peak(place, name)] for name in names],
        "sweeps": [{**told, "points": list(told["points"].values())} for told in sweeps.values()],
    }


def _peak(place: PlaceFacts, quantity: str) -> tuple[str, float]:
    found: PointError = next(one.error for one in place.records if one.quantity == quantity and one.error)
    return found.unit, _digits(found.peak)


def _sweep(facts: EngineFacts, record: BenchRecord) -> dict[str, Any]:
    """What the points of a sweep share; ``ends`` has by quantity what limits the error, and the order."""
    return {
        "engine": record.engine,
        "version": record.engine_version,
        "way": way(facts, record),
        "setting": record.kind == SETTING and record.setting,
        "own": record.kind == SETTING or facts.is_own(record),
        "runs": record.runs,
        "solver": effort_words(record.effort, record.effort_unit),
        "unit": record.work_unit,
        "ends": {},
    }


def _point(record: BenchRecord) -> dict[str, Any]:
    """A point's cost, s, steps and work; its errors over the peak stand beside it by quantity."""
    times = (record.seconds_min, record.seconds_median, record.setup_seconds, record.readout_seconds)
    stepping, median, setup, readout = (_digits(one or 0.0) for one in times)
    return {
        "stepping": stepping, "median": median, "setup": setup, "readout": readout, "repeats": len(record.repeats),
        "step": record.step and _digits(record.step), "turn": record.steps_per_turn and round(record.steps_per_turn),
        "steps": record.steps, "work": record.solver_work, "used": record.used,
    }  # fmt: skip


def _error(record: BenchRecord) -> list[float]:
    """Largest error as drawn, largest and root mean square, all over the peak."""
    assert record.error is not None
    return [_digits(one) for one in (drawn_error(record), record.error.error_max, record.error.error_rms)]


def _digits(value: float) -> float:
    """A number to four digits, which is all that a reader sees."""
    return float(f"{value:.4g}")
