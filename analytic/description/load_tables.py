"""The loads of a linkage file: forces at points, torques on links, springs and dampers, in SI units.

Each kind is sorted by body and point, so that the order of listing changes no result, not even its rounding.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from analytic.description import schema as doc
from analytic.description.law import FULL_TURN, Law
from analytic.description.linkage import GROUND, LinkTorque, PointForce, RotaryDamper, Spring
from analytic.description.lookup import Reader

LEAST_STEP = 1e-6  # rad between the angles of a law: nearer ones are one angle written twice


def forces(reader: Reader) -> tuple[PointForce, ...]:
    """Forces at points; a force on the ground has no effect and is left out."""
    loads = [_force(reader, table, f"forces.{number}") for number, table in enumerate(reader.document.forces)]
    return tuple(sorted((load for load in loads if load.link != GROUND), key=sort_key))


def _force(reader: Reader, table: doc.ForceTable, where: str) -> PointForce:
    """A force at a point in SI units."""
    rows = table.force if isinstance(table.force, list) else [table.force]
    link = reader.owner(table.point, table.link, where)
    return PointForce(table.point, link, _interpolated_law(reader, table, rows, "force", where))


def torques(reader: Reader) -> tuple[LinkTorque, ...]:
    """Torques on links; a torque on the ground has no effect and is left out."""
    loads = [_torque(reader, table, f"torques.{number}") for number, table in enumerate(reader.document.torques)]
    return tuple(sorted((load for load in loads if load.link != GROUND), key=sort_key))


def _torque(reader: Reader, table: doc.TorqueTable, where: str) -> LinkTorque:
    """A torque on a link in SI units."""
    values = table.torque if isinstance(table.torque, list) else [table.torque]
    law = _interpolated_law(reader, table, [(value,) for value in values], "torque", where)
    return LinkTorque(reader.body(table.link, where), law)


def _interpolated_law(
    reader: Reader, table: doc.ForceTable | doc.TorqueTable, rows: Sequence[tuple[float, ...]], kind: str, where: str
) -> Law:
    """The law of a force or torque, by a spline or by straight lines as the table says."""
    law = _law(reader, rows, table.angle, kind, where)
    if table.interpolation and law.is_constant:
        raise reader.fail(
            f"{where}.interpolation: expected a list of values over angle = [...] beside it, got one value; leave it "
            "out"
        )
    return replace(law, linear=table.interpolation == "linear")


def law_over_angle(reader: Reader, values: list[float], angles: list[float], kind: str, where: str) -> Law:
    """The law of one component through values at angles, both in the file's units."""
    return _law(reader, [(value,) for value in values], angles, kind, where)


def sort_key(load: PointForce | LinkTorque | Spring | RotaryDamper) -> tuple[object, ...]:
    """The key by which loads of a kind are sorted: bodies and points, then numbers."""
    match load:
        case PointForce():
            return (load.point, load.link, _law_key(load.force))
        case LinkTorque():
            return (load.link, _law_key(load.torque))
        case Spring():
            return (load.points, load.links, load.stiffness, load.length, load.damping)
    return (load.links, load.coefficient)


def _law_key(law: Law) -> tuple[bytes, bytes, bool]:
    """The part of a sort key that tells two laws apart."""
    return law.values.tobytes(), b"" if law.angles is None else law.angles.tobytes(), law.linear


def _law(reader: Reader, rows: Sequence[tuple[float, ...]], angles: list[float] | None, kind: str, where: str) -> Law:
    """The law through rows of components; one row without angles is a constant."""
    table = np.array([[reader.number(value, kind, f"{where}.{kind}") for value in row] for row in rows], dtype=float)
    if angles is None:
        if len(table) != 1:
            raise reader.fail(
                f"{where}: expected one value, or angle = [...] with as many angles as values, got {len(table)} values "
                "and no angles; add angle"
            )
        return Law(table[0])
    phi = np.asarray(angles, dtype=float) * reader.scale[reader.coordinate]
    periodic = not reader.is_linear
    if len(table) != len(phi) or len(phi) < 3:
        raise reader.fail(
            f"{where}: expected as many values as angles and at least 3 of each, got {len(table)} values and "
            f"{len(phi)} angles; complete the shorter list"
        )
    if np.any(np.diff(phi) < LEAST_STEP) or (periodic and phi[-1] - phi[0] >= FULL_TURN):
        if not periodic:
            raise reader.fail(
                f"{where}.angle: expected increasing travels of the driver, got steps of {min(np.diff(angles)):g} "
                f"{reader.document.units.length} and more; sort them"
            )
        raise reader.fail(
            f"{where}.angle: expected increasing angles that span less than one turn, since the law repeats with the "
            f"turn, got {angles[0]:g} to {angles[-1]:g} in steps of "
            f"{min(np.diff(angles)):g} and more; sort them, and leave out a last one that repeats the first"
        )
    return Law(table, phi, periodic)


def springs(reader: Reader) -> tuple[Spring, ...]:
    """Springs with their dashpots; an end on a pivot of the ground counts as the ground's."""
    loads = [_spring(reader, table, f"springs.{number}") for number, table in enumerate(reader.document.springs)]
    return tuple(sorted(loads, key=sort_key))


def _spring(reader: Reader, table: doc.SpringTable, where: str) -> Spring:
    """A spring with its dashpot in SI units."""
    ends = zip(table.between, table.links or (None, None), strict=True)
    first, second = (reader.owner(point, link, where) for point, link in ends)
    if first == second:
        raise reader.fail(
            f"{where}: expected ends on two different bodies, got both on '{first}', where nothing stretches; attach "
            "the other end elsewhere"
        )
    stiffness = reader.number(table.stiffness, "stiffness", f"{where}.stiffness")
    length = reader.number(table.length, "length", f"{where}.length")
    damping = reader.number(table.damping, "damping", f"{where}.damping")
    given = "length" in table.model_fields_set
    return Spring(table.between, (first, second), stiffness, length, damping, given)


def dampers(reader: Reader) -> tuple[RotaryDamper, ...]:
    """Dampers of the relative rotation of two bodies."""
    loads = [_damper(reader, table, f"dampers.{number}") for number, table in enumerate(reader.document.dampers)]
    return tuple(sorted(loads, key=sort_key))


def _damper(reader: Reader, table: doc.DamperTable, where: str) -> RotaryDamper:
    """A rotary damper in SI units."""
    first, second = (reader.body(name, where) for name in table.between)
    if first == second:
        raise reader.fail(f"{where}: expected two different bodies, got '{first}' twice; correct one of them")
    return RotaryDamper((first, second), reader.number(table.coefficient, "turn_damping", f"{where}.coefficient"))
