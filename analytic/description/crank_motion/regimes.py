"""The regimes of a linkage file: a released crank, or a motion that its crank follows, in SI units."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from typing import Final

import numpy as np

from analytic.description import schema as doc
from analytic.description.crank_motion import LAWS, REGIMES, RPM, CrankMotion, Move, sequence, swing
from analytic.description.crank_motion.prescribed import check_times, table_motion
from analytic.description.law import Law, TimeLaw
from analytic.description.linkage import FileRegime, PrescribedRegime, ReleasedRegime
from analytic.description.load_tables import law_over_angle
from analytic.description.lookup import Reader
from analytic.errors import LinkproofError, UnknownNameError, listed

USUAL_LAW: Final = "constant-speed"
# Of each kind of regime, the keys that it takes, the first of them what tells it from the others.
KINDS: Final[Mapping[str, tuple[str, ...]]] = {
    "segments": ("segments", "start_angle"),
    "swing": ("to", "from", "speed", "time", "law", "dwell", "back"),
    "table": ("angle", "time"),
    "released crank": ("torque", "start_angle", "start_speed", "duration", "angle", "time"),
}


def regime_of(reader: Reader, name: str) -> FileRegime:
    """The regime of this name in a linkage file; raises DescriptionError for the name of a prescribed motion."""
    table, where = reader.document.regimes[name], f"regimes.{name}"
    if name in (*REGIMES, *LAWS):
        raise reader.fail(f"{where}: expected a name of its own, got that of a prescribed regime; choose another")
    given = _written_keys(table)
    kind = _kind_of_regime(given)
    for key in given:
        if key not in KINDS[kind]:
            raise reader.fail(
                f"{where}.{key}: expected the keys of a {kind}, {listed(KINDS[kind])}, got '{key}' beside them; leave "
                "it out, or make it a regime of its own"
            )
    if kind == "released crank":
        return _released_regime(reader, name, table, where)
    makers = {"segments": _segments_motion, "swing": _swing_motion, "table": _table_motion}
    with _errors_at(reader, where):
        motion, conditions = makers[kind](reader, name, table, where)
    return PrescribedRegime(name, motion, conditions)


def _written_keys(table: doc.RegimeTable) -> list[str]:
    """Keys of the regime in the file, as written there."""
    return [field.alias or name for name, field in type(table).model_fields.items() if name in table.model_fields_set]


def _kind_of_regime(keys: Sequence[str]) -> str:
    """What the keys of a regime describe, a key of ``KINDS``: a swing, segments, a table, or a released crank."""
    if "segments" in keys:
        return "segments"
    if "to" in keys or "from" in keys:
        return "swing"
    return "table" if "angle" in keys and "torque" not in keys else "released crank"


@contextmanager
def _errors_at(reader: Reader, where: str) -> Iterator[None]:
    """Put the place in the file before the message of an error that a motion raises in the block."""
    try:
        yield
    except LinkproofError as error:
        if type(error) in (LinkproofError, UnknownNameError):
            raise reader.fail(f"{where}: {error}") from error
        raise


def _required(reader: Reader, value: float | None, where: str, meaning: str) -> float:
    """A number that the regime needs; raises DescriptionError where it is missing."""
    if value is None:
        raise reader.fail(f"{where} is missing: expected {meaning}; add it")
    return value


def _coordinate_unit(reader: Reader) -> float:
    """A unit of the file's crank angle in rad, or of a linear drive's travel in m."""
    return reader.scale[reader.coordinate]


def _speed_unit(reader: Reader) -> float:
    """A unit of the file's speed: rpm of a crank, the file's length a second of a linear drive."""
    return reader.scale["length"] if reader.is_linear else RPM


def _phi_text(reader: Reader, place: float) -> str:
    """A value of φ, rad or m, for a reader, in the file's unit."""
    if reader.is_linear:
        return f"{place / _coordinate_unit(reader):.10g} {reader.document.units.length}"
    return f"{math.degrees(place):.10g}°"


def _peak_speed_text(reader: Reader, motion: CrankMotion) -> str:
    """The motion's largest speed for a reader."""
    unit = f"{reader.document.units.length}/s" if reader.is_linear else "rpm"
    return f"at most {motion.peak_speed / _speed_unit(reader):.6g} {unit}"


def _swing_motion(reader: Reader, name: str, table: doc.RegimeTable, where: str) -> tuple[CrankMotion, str]:
    """The motion of a regime with ``from`` and ``to``, and its conditions in words."""
    scale = _coordinate_unit(reader)
    start = _required(reader, table.begin, f"{where}.from", "the angle at which the swing begins") * scale
    end = _required(reader, table.to, f"{where}.to", "the angle at which the swing ends") * scale
    law, dwell, back = table.law or USUAL_LAW, table.dwell or 0.0, bool(table.back)
    if isinstance(table.time, list):
        raise reader.fail(f"{where}.time: expected the time of one way in s, got a list; give one number")
    speed = None if table.speed is None else table.speed * _speed_unit(reader)
    motion = swing(law, start, end, speed=speed, time=table.time, dwell=dwell, back=back, regime=name)
    pause = f", {dwell:g} s there" if dwell else ""
    ways = f"from {_phi_text(reader, start)} to {_phi_text(reader, end)}{pause}{' and back' if back else ''}"
    return motion, f"{law} {ways}, {_peak_speed_text(reader, motion)}"


def _segments_motion(reader: Reader, name: str, table: doc.RegimeTable, where: str) -> tuple[CrankMotion, str]:
    """The motion of a regime with ``segments``, and its conditions in words."""
    begin = (table.start_angle or 0.0) * _coordinate_unit(reader)
    moves: list[Move] = []
    angle = begin
    for number, segment in enumerate(table.segments or ()):
        place = f"{where}.segments.{number}"
        with _errors_at(reader, place):
            move = _move(reader, segment, angle, place)
        moves.append(move)
        angle = angle if move.to is None else move.to
    motion = sequence(name, begin, moves)
    stops = " to ".join(_phi_text(reader, each) for each in (begin, *(m.to for m in moves if m.to is not None)))
    return motion, f"{len(moves)} segments, {stops}, {motion.duration:.6g} s, {_peak_speed_text(reader, motion)}"


def _move(reader: Reader, segment: doc.SegmentTable, angle: float, place: str) -> Move:
    """A segment of a motion that is at ``angle``, rad or m: a move by a law, or a dwell."""
    if (segment.to is None) == (segment.dwell is None):
        raise reader.fail(f"{place}: expected either an angle to go to or a dwell, got both or none; give one of them")
    if segment.dwell is not None:
        beside = [key for key in ("time", "speed", "law") if getattr(segment, key) is not None]
        if beside:
            raise reader.fail(f"{place}: expected a dwell alone, got {listed(beside)} beside it; leave that out")
        return Move(segment.dwell)
    assert segment.to is not None
    law, end = segment.law or USUAL_LAW, segment.to * _coordinate_unit(reader)
    speed = None if segment.speed is None else segment.speed * _speed_unit(reader)
    return Move(swing(law, angle, end, speed=speed, time=segment.time).duration, end, law)


def _table_motion(reader: Reader, name: str, table: doc.RegimeTable, where: str) -> tuple[CrankMotion, str]:
    """The motion of a regime with ``angle`` over ``time``, and its conditions in words."""
    times = table.time if isinstance(table.time, list) else None
    if times is None:
        raise reader.fail(f"{where}.time: expected a list of times in s beside the angles, got none; add time = [...]")
    angles = [angle * _coordinate_unit(reader) for angle in table.angle or ()]
    with _errors_at(reader, f"{where}.time"):
        check_times(np.array(times or [0.0]))
    with _errors_at(reader, f"{where}.angle"):
        motion = table_motion(name, times, angles)
    low, high = motion.reach
    words = f"table of {len(times)} points between {_phi_text(reader, low)} and {_phi_text(reader, high)}"
    return motion, f"{words}, {motion.duration:.6g} s, {_peak_speed_text(reader, motion)}"


def _released_regime(reader: Reader, name: str, table: doc.RegimeTable, where: str) -> ReleasedRegime:
    """The regime of a released crank in SI units."""
    start = reader.number(
        _required(reader, table.start_angle, f"{where}.start_angle", "a finite angle in the file's angle unit"),
        reader.coordinate,
        f"{where}.start_angle",
    )
    duration = _required(reader, table.duration, f"{where}.duration", "a positive finite time in s")
    speed = (table.start_speed or 0.0) * (_coordinate_unit(reader) if reader.is_linear else 1.0)
    torque, over_angle, over_time = _torque(reader, table, where)
    return ReleasedRegime(name, torque, start, speed, duration, over_angle, over_time)


def _torque(reader: Reader, table: doc.RegimeTable, where: str) -> tuple[float, Law | None, TimeLaw | None]:
    """The crank's torque: its constant part, its law over the angle, its law over time."""
    if not isinstance(table.torque, list):
        if table.angle is not None or table.time is not None:
            key = "angle" if table.angle is not None else "time"
            raise reader.fail(f"{where}.{key}: expected a list of torques beside it, got none; add torque = [...]")
        return reader.number(table.torque or 0.0, reader.drive, f"{where}.torque"), None, None
    if (table.angle is None) == (table.time is None):
        raise reader.fail(
            f"{where}.torque: expected a list of torques over angle = [...] or over time = [...], got both or none; "
            "give one of them"
        )
    if table.angle is not None:
        if reader.is_linear:
            raise reader.fail(
                f"{where}.angle: expected a force over time of a linear drive, which has no angle, got one over the "
                "angle; give time = [...]"
            )
        return 0.0, law_over_angle(reader, table.torque, table.angle, "torque", where), None
    values = [reader.number(value, reader.drive, f"{where}.torque") for value in table.torque]
    return 0.0, None, _time_law(reader, values, table.time, where)


def _time_law(reader: Reader, values: list[float], times: float | list[float] | None, where: str) -> TimeLaw:
    """The crank's torque over time, in SI units: straight lines between its values."""
    if not isinstance(times, list) or len(times) != len(values) or len(times) < 2:
        count = len(times) if isinstance(times, list) else 1
        raise reader.fail(
            f"{where}: expected as many times as torques and 2 or more of each, got {count} times and {len(values)} "
            "torques; complete the shorter list"
        )
    if np.any(np.diff(times) <= 0.0):
        number = int(np.argmax(np.diff(times) <= 0.0))
        raise reader.fail(
            f"{where}.time: expected times that increase, got {times[number + 1]:g} s after {times[number]:g} s; sort "
            "them, and give a step a short time of its own"
        )
    return TimeLaw(tuple(times), tuple(values))
