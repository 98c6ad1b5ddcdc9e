"""Orders, steps and comparisons of settings in words."""

from __future__ import annotations

from comparisons.judging.limits import grouped
from comparisons.work_precision.analysis import SATURATED, EngineFacts, MethodSweep, Regimes, SettingComparison
from comparisons.work_precision.records import Bench, BenchRecord
from engines.contract import Setting
from reports.document.numbers import bound, error, figure, seconds
from reports.document.templates import plain, sentence

# Times closer than this are the same time, however quiet the machine.
LEAST_NOISE = 0.05


def comparison_words(comparison: SettingComparison, noise: float) -> str:
    """A setting's distance from the methods' front, as the end of a sentence.

    ``best`` is compared with all methods, the others with those of a single run; a share ``noise`` of its time is
    nothing.
    """
    record, ratio, whole = comparison.record, comparison.ratio, comparison.record.setting == Setting.BEST
    if (record.error_max or 0.0) > SATURATED:
        return ": no solution"
    if ratio is None or comparison.rival is None or comparison.rival_seconds is None:
        return f"; no {'method' if whole else 'single run'} measured gets there"
    front = "the front" if whole else "the front of single runs"
    beside = f"{method_words(comparison.rival)} takes {seconds(comparison.rival_seconds)} to the same error"
    if ratio <= 1.0 / (1.0 + noise):
        return f"; ahead of {front}: {beside}, {figure(1.0 / ratio, 2)} × as long"
    return f"; {'on' if ratio <= 1.0 + noise else f'{figure(ratio, 2)} ×'} {front}: {beside}"


def way_words(record: BenchRecord) -> str:
    """A point's way and, behind an @, its steps a turn, which a setting's adapter fixes: "trapezoidal x4 @ 48"."""
    return " @ ".join(filter(None, (method_words(record), per_turn(record))))


def method_words(record: BenchRecord) -> str:
    """The name of a point's setting or method, without its step.

    Of several runs extrapolated it ends in "x3", with which the name of a method may end already.
    """
    runs = f" x{record.runs}" if record.is_extrapolated else ""
    return record.setting.removesuffix(runs) + runs


def effort_words(effort: float | None, unit: str) -> str:
    """A solver effort: "300 iterations", "relative tolerance 1e-6"; of an engine's own, that it is."""
    if effort is None:
        return f"the engine's own {unit}" if unit else ""
    return f"{unit} {bound(effort)}" if "tolerance" in unit else f"{effort:g} {unit}"


def per_turn(record: BenchRecord) -> str:
    """Steps a turn; nothing for a setting."""
    return "" if record.steps_per_turn is None else f"{record.steps_per_turn:.0f}"


def least_words(sweep: MethodSweep) -> str:
    """The least error of a sweep, called a floor where a finer step does not lower it, and its steps a turn."""
    return f"{'floor' if sweep.has_floor else 'least'} {error(sweep.least.error_max)} @ {per_turn(sweep.least)}"


def noise_share(bench: Bench) -> float:
    """The share by which two times of one thing may differ here."""
    return max(LEAST_NOISE, bench.noise.median_excess)


def noise_note(bench: Bench) -> str:
    """How the times were measured, in small print."""
    return sentence("machine_noise", noise=bench.noise, repeats=bench.document["extent"]["repeats"])


def engine_label(name: str, is_control: bool) -> str:
    """An engine's name for a reader; the reference's control is marked."""
    return f"{name} (control)" if is_control else name


def label_of(facts: EngineFacts) -> str:
    """The label of an engine in one place."""
    return engine_label(facts.engine, facts.is_control)


def engine_labels(bench: Bench) -> dict[str, str]:
    """The labels of all engines of a benchmark, by name, the control last."""
    controls = {record.engine: record.is_control for record in bench.records}
    return {name: engine_label(name, controls[name]) for name in sorted(controls, key=lambda own: (controls[own], own))}


def judged_by(regimes: Regimes) -> str:
    """The quantities that places are judged by, for a reader."""
    return " or ".join(dict.fromkeys(plain(place.foremost) for places in regimes.values() for place in places))


def failed_methods(facts: EngineFacts) -> tuple[str, ...]:
    """Methods and settings that never finished anything, by reason; then what of a quantity was left out."""
    finished = {record.setting for record in facts.records if record.finished}
    reasons = {r.setting: f"{r.outcome}: {r.detail}" for r in reversed(facts.records) if not r.finished}
    every = dict.fromkeys(record.setting for record in facts.records)
    names = grouped((reasons[name], name or facts.engine) for name in every if name not in finished)
    left_out = dict.fromkeys(r.error.detail for r in facts.records if r.finished and r.error and r.error.detail)
    return (*(f"{', '.join(same)}: {reason}" for reason, same in names.items()), *left_out)
