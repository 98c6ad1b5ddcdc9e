"""A linkage as a page computes it: its formulas printed in JavaScript, its numbers, loads and motion as plain data."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Final

from analytic import signals
from analytic.description.changes import SPEED, Number, named_numbers
from analytic.description.crank_motion import RPM, CrankMotion
from analytic.description.law import FULL_TURN, Law
from analytic.description.linkage import Linkage
from analytic.description.written import file_unit
from analytic.kinematics.mechanism import Mechanism
from analytic.machine_code.compiling import javascript_source
from analytic.machine_code.tracing import ACCELERATION, PHI, LinkageTrace, is_traceable, linkage_trace
from comparisons.datasheet.building import MARGIN, OVER_RANGE

MOST_OPERATIONS: Final = 12_000
LEFT_OUT: Final = ("phi", "omega", "epsilon", signals.THREAD_FEED)  # the motion itself; what needs a search
VELOCITIES: Final = (":vx", ":vy", ":ax", ":ay", ":omega", ":alpha")
ALWAYS: Final = (PHI, SPEED, ACCELERATION)  # of a row, in this order


@dataclass(frozen=True)
class Model:
    """The ``source`` of a linkage's function, the ``numbers`` that it is given by name, and what else it takes."""

    mechanism: Mechanism
    source: str
    numbers: tuple[str, ...]
    data: Mapping[str, Any]


def model(mechanism: Mechanism, motion: CrankMotion | None) -> Model | str:
    """The model of a linkage under a motion, or the reason for its absence."""
    if mechanism.is_numerical:
        return "one of its groups has no formula and is solved by Newton's method"
    if not is_traceable(mechanism):
        return "it passes change points, where its formulas branch"
    if motion is None:
        return "its crank is released, so that the motion follows from masses and loads"
    listed = _trace_signals(mechanism, motion)
    looked_up = [hashable for hashable in listed.trace.inputs if isinstance(hashable, tuple)]
    if len(listed.trace.operations) > MOST_OPERATIONS or any(order for _, order, _ in looked_up):
        return "its formulas are too many to be computed while a number is pulled"
    needed = set(listed.trace.lines_needed(listed.lines))
    numbers = tuple(name for name in sorted(listed.varied) if listed.trace.inputs[name] in needed)
    lines = [listed.trace.inputs.get(entries, -1) for entries in (*ALWAYS, *looked_up)]
    source = javascript_source(listed.trace, [listed.trace.inputs[name] for name in numbers], lines, listed.lines)
    laws = list(dict.fromkeys(law for law, _, _ in looked_up))
    data = {
        "rows": [[laws.index(law), component] for law, _, component in looked_up],
        "laws": [_law(law, mechanism) for law in laws],
        "motion": _motion(motion, is_linear=mechanism.linkage.is_linear),
        "results": [_result(name, mechanism) for name in results(mechanism)],
        "groups": [
            {"name": dyad.name, "point": getattr(dyad.inner_joint, "point", "")} for dyad in mechanism.structure.dyads
        ],
    }
    return Model(mechanism, source, numbers, data)


def results(mechanism: Mechanism) -> tuple[str, ...]:
    """The signals that a page computes: what is drawn, plotted, or among the key figures."""
    every = signals.names_with_magnitudes(mechanism)
    return tuple(name for name in every if name not in LEFT_OUT and not name.endswith(VELOCITIES))


def loads(linkage: Linkage) -> list[Law]:
    """The forces and torques of a linkage, in the order in which they are scaled."""
    return [*(load.force for load in linkage.forces), *(load.torque for load in linkage.torques)]


def load_of(number: Number, linkage: Linkage) -> int | None:
    """The load that a number is of, among those of ``loads``."""
    kind, index, *_ = number.place
    if kind not in ("forces", "torques") or not isinstance(index, int):
        return None
    return index if kind == "forces" else len(linkage.forces) + index


def is_of_table(number: Number, linkage: Linkage) -> bool:
    """Whether a number is a value of a load over φ, which is looked up."""
    load = load_of(number, linkage)
    return load is not None and not loads(linkage)[load].is_constant


def _trace_signals(mechanism: Mechanism, motion: CrankMotion) -> LinkageTrace:
    """The list of the page's signals with every number free but directions, the sketch and loads over φ."""
    every = named_numbers(mechanism.linkage).items()
    free = {
        name for name, number in every
        if number.kind != "direction" and number.place[0] != "sketch" and not is_of_table(number, mechanism.linkage)
    }  # fmt: skip
    accelerates = any(len(segment.coefficients) > 2 for segment in motion.segments)
    return linkage_trace(mechanism, free, results(mechanism), accelerates=accelerates)


def _law(law: Law, mechanism: Mechanism) -> dict[str, Any]:
    """A load over φ as cubics, and which it is."""
    knots, pieces = law.pieces()
    load = [curve is law for curve in loads(mechanism.linkage)].index(True)
    return {"knots": knots, "pieces": pieces, "period": FULL_TURN if law.periodic else 0, "load": load}


def _motion(motion: CrankMotion, *, is_linear: bool) -> dict[str, Any]:
    """The pieces of a motion; its ``speed``, rpm, where it has one alone, which can be changed."""
    segments = [[segment.start, segment.end, list(segment.coefficients)] for segment in motion.segments]
    first = motion.segments[0].coefficients
    is_steady = len(segments) == 1 and len(first) == 2
    turns = is_steady and not is_linear and abs(abs(first[1]) * motion.duration - FULL_TURN) < 1e-9
    speed = first[1] if is_steady else motion.peak_speed if motion.regime == OVER_RANGE else 0.0
    return {
        "segments": segments,
        "duration": motion.duration,
        "speed": 0.0 if is_linear else float(f"{speed / RPM:.12g}"),
        "steady": is_steady,
        "range": MARGIN if is_steady and not turns and motion.regime == OVER_RANGE else 0.0,
        "turns": turns,
        "linear": is_linear,
    }


def _result(name: str, mechanism: Mechanism) -> dict[str, Any]:
    """A signal with the file's unit of it and the unit's size."""
    unit = file_unit(signals.unit(name, mechanism.linkage), mechanism.linkage)
    return {"name": name, "unit": unit.on_page, "size": unit.size}
