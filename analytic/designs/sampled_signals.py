"""Signals of many designs of one linkage at crank angles: by a list of operations, or design by design.

Designs of a linkage of dyads share one list (``analytic.machine_code``), which NumPy computes, or machine code where
that saves time. With a group of class III, a cylinder or change points the configuration is followed for every design
anew.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, Final, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from analytic.description.changes import SPEED, design_numbers, with_numbers
from analytic.description.law import FULL_TURN
from analytic.description.linkage import Linkage
from analytic.errors import AssemblyError, LinkproofError, StructureError, UnknownNameError
from analytic.kinematics.mechanism import Mechanism
from analytic.kinematics.sweep import Sweep
from analytic.machine_code import (
    ZERO_OF_S,
    LinkageTrace,
    Result,
    StraightFunction,
    in_threads,
    is_traceable,
    is_worthwhile,
    linkage_trace,
)
from analytic.numerics.arrays import Array, Booleans
from analytic.numerics.roots import roots
from analytic.signals import OUTPUT_COORDINATE, THREAD_FEED, MovingSweep, check_signals, is_wrapped, signal

Integers = NDArray[np.int64]

# Designs times crank angles computed at once. Measured on the six-bar: from 6144 to 18 432 the cost is the same within
# a tenth, 3072 cost half as much again.
BLOCK: Final = 9216
ONE_ROW: Final = np.empty((1, 0))
TURN: Final = 720  # crank angles at which the top dead centre is looked for


class DesignSamples(NamedTuple):
    """Signals of designs at crank angles, by name, (designs, angles).

    ``moves`` (designs, angles) tells where a design can be assembled and moved; elsewhere the signals are nan or
    meaningless. ``determinants`` (dyads, designs, angles) are magnitudes, zero in dead positions.
    """

    signals: Mapping[str, Array]
    moves: Booleans
    determinants: Array


# Samples of the designs of some rows (n,) at crank angles, rad, (n, m), and which of the signals.
Sampler = Callable[[Integers, Array, tuple[str, ...]], DesignSamples]


@dataclass(frozen=True)
class Designs:
    """Designs that differ in ``arrays`` (designs,) of numbers by name, SI, in the assembly modes as described.

    The crank has a ``speed``, rad/s, or one among the arrays, turned as it, and an ``acceleration``, rad/s², numbers or
    (angles,). With ``all_groups`` a design moves only if all its links do, else if those do that the signals need.
    ``path`` is "numpy", "compiled" or "auto"; ``poses`` is the number of all poses to compute, by which "auto" decides
    whether to compile.
    """

    mechanism: Mechanism
    arrays: Mapping[str, Array]
    signals: tuple[str, ...]
    speed: ArrayLike
    acceleration: ArrayLike = 0.0
    all_groups: bool = True
    path: str = "auto"
    poses: float = 0.0

    @property
    def count(self) -> int:
        """The number of designs."""
        return len(next(iter(self.arrays.values())))

    @cached_property
    def trace(self) -> LinkageTrace | None:
        """The signals as a list of operations; None where the designs have none.

        That is with groups of a higher class, change points or friction, and for a thread's feed, whose reference
        position is looked for in each design. Raises errors as ``linkage_trace`` does.
        """
        if not is_traceable(self.mechanism) or THREAD_FEED in self.signals:
            return None
        return linkage_trace(
            self.mechanism,
            [name for name, values in self.arrays.items() if np.any(values)],
            self.signals,
            zero=[name for name, values in self.arrays.items() if not np.any(values)],
            accelerates=bool(np.any(self.acceleration)),
            all_groups=self.all_groups,
        )

    def in_blocks(self, size: int, work: Callable[[Integers, Sampler], None]) -> None:
        """Call ``work(rows, sampler)`` for block after block of up to ``size`` designs, on all cores.

        ``rows`` are the numbers of the block's designs, ``sampler`` computes their signals. Several threads call it at
        a time. Without a list of operations a block is one design, and one that cannot be assembled as its sketch shows
        it is left out. An error of ``work`` is raised again.
        """
        self.zero_of_s  # noqa: B018 - known before threads ask for it

        def part(start: int) -> None:
            """Call ``work`` with the block that begins at design number ``start``, without NumPy's warnings."""
            with np.errstate(all="ignore"):
                if self.trace is not None:
                    work(np.arange(start, min(start + size, self.count)), self._traced_samples)
                elif (design := self._single_design(start)) is not None:
                    work(np.array([start]), lambda rows, phi, names: self._swept_samples(design, rows, phi, names))

        in_threads(part, range(0, self.count, size if self.trace else 1))

    def _traced_samples(self, rows: Integers, phi: Array, names: tuple[str, ...]) -> DesignSamples:
        """Samples of the designs ``rows`` at ``phi``, rad, (rows, angles), computed from the list of operations.

        ``names`` are some of ``signals``.
        """
        trace = self.trace
        assert trace is not None
        places = phi[:1] if phi.strides[0] == 0 else phi  # every design's own
        numbers = {name: values[rows, None] for name, values in {**self.arrays, **self.zero_of_s}.items()}
        known = trace.values(numbers, places, speed_of(numbers, self.speed), self.acceleration)
        function = self._machine_code
        if function is None:
            lines = [trace.signals[self.signals.index(name)] for name in names]
            *values, moves = trace.trace.evaluate([*lines, *trace.determinants, trace.moves], known)
        else:
            given = trace.trace.evaluate(function.lanes, known)
            lanes = [np.broadcast_to(entry, phi.shape).reshape(-1) for entry in given]
            computed = function(lanes, ONE_ROW, phi.size).reshape(-1, *phi.shape)
            count = len(self.signals)
            values, moves = (
                [computed[self.signals.index(name)] for name in names] + [*computed[count + 1 :]],
                computed[count],
            )
        full = [np.broadcast_to(value, phi.shape) for value in values]
        return DesignSamples(
            {name: self._unwrapped(name, entry) for name, entry in zip(names, full, strict=False)},
            np.broadcast_to(np.asarray(moves, dtype=bool), phi.shape),
            np.reshape(full[len(names) :], (-1, *phi.shape)),
        )

    @cached_property
    def zero_of_s(self) -> Mapping[str, Array]:
        """The output's top coordinate (designs,), m, from which S counts in loads, by ``ZERO_OF_S``.

        {} without loads over S.
        """
        if self.trace is None or ZERO_OF_S not in self.trace.trace.inputs:
            return {}
        turn, step = np.arange(TURN) * (FULL_TURN / TURN), FULL_TURN / TURN
        result = np.full(self.count, np.nan)
        outputs = replace(self, signals=(OUTPUT_COORDINATE, "v"), speed=-1.0, acceleration=0.0)  # v is its derivative

        def work(rows: Integers, sampler: Sampler) -> None:
            """Fill in the output's highest coordinate, m, of the designs numbered ``rows``."""

            def seen(name: str, phi: Array) -> Array:
                """The signal of this name (designs, angles) of the block at crank angles (designs, angles), rad."""
                return sampler(rows, phi, (name,)).signals[name]

            heights = seen(OUTPUT_COORDINATE, np.broadcast_to(turn, (len(rows), TURN)))
            near = turn[np.argmax(heights, axis=1)]
            top = roots(lambda phi: seen("v", phi[:, None])[:, 0], near - step, near, near + step)
            result[rows] = seen(OUTPUT_COORDINATE, top[:, None])[:, 0]

        outputs.in_blocks(max(1, BLOCK // TURN), work)
        return {ZERO_OF_S: result}

    def _unwrapped(self, name: str, values: Array) -> Array:
        """An angle of a link unwrapped along the crank angles, the last axis; any other signal as it is."""
        return np.unwrap(values) if is_wrapped(name, self.mechanism.linkage) else values

    @property
    def is_compiled(self) -> bool:
        """Whether machine code computes the list.

        Raises UnknownNameError for an unknown path, LinkproofError where numba is missing for "compiled".
        """
        operations = len(self.trace.trace.lines_needed(self.trace.lines)) if self.trace else 0
        return is_worthwhile(self.path, operations, self.poses) and self.trace is not None

    @cached_property
    def _machine_code(self) -> StraightFunction | None:
        """The list of operations as machine code, compiled at the first use; None where NumPy computes it."""
        assert self.trace is not None
        trace, lines = self.trace.trace, self.trace.lines
        if not self.is_compiled:
            return None
        given = sorted(line for border in self.trace.split_inputs(lines) for line in border)
        return StraightFunction(trace, given, (), [Result(line) for line in lines])

    def _single_design(self, row: int) -> Mechanism | None:
        """The mechanism of one design; None where it cannot be assembled as its sketch shows it."""
        numbers = {name: float(values[row]) for name, values in self.arrays.items()}
        try:
            return self.mechanism.redesigned(with_numbers(self.mechanism.linkage, numbers))
        except (AssemblyError, StructureError):
            return None

    def _swept_samples(self, design: Mechanism, rows: Integers, phi: Array, names: tuple[str, ...]) -> DesignSamples:
        """Samples of one design, posed by its own mechanism ``design``, at ``phi``, rad, (rows, angles).

        All of ``rows`` are this design's number.
        """
        faults = np.zeros(phi.shape, dtype=bool)
        sweep = Sweep(design.linkage, design.structure, phi, faults, zero_of_s=design.zero_of_s)
        for body in design.structure.bodies if self.all_groups else ():
            sweep.rates(body)
        speed = speed_of({name: values[rows[0]] for name, values in self.arrays.items()}, self.speed)
        at = MovingSweep(design, sweep, speed, np.asarray(self.acceleration))
        values = {name: _signal_or_nan(at, name) for name in names}
        dyads = [dyad for dyad in design.structure.dyads if self.all_groups and not dyad.changes]
        sizes = [np.broadcast_to(abs(sweep.determinant(dyad)), phi.shape) for dyad in dyads]
        return DesignSamples(values, ~faults, np.reshape(sizes, (-1, *phi.shape)))


def _signal_or_nan(at: MovingSweep, name: str) -> Array:
    """A signal of one design; nan for a thread's feed that has no zero, since this design cannot turn fully."""
    try:
        return signal(at, name)
    except UnknownNameError:
        return np.full(at.sweep.angle.shape, np.nan)


# Signals of many designs of one linkage over crank angles, with all of their curves.

ASSEMBLED: Final = "assembled"


def evaluate_designs(
    mechanism: Mechanism,
    parameters: Mapping[str, ArrayLike],
    angle: ArrayLike,
    names: Iterable[str],
    *,
    speed: ArrayLike | None = None,
    acceleration: ArrayLike = 0.0,
    path: str = "auto",
) -> dict[str, NDArray[Any]]:
    """Signals by name for every design and crank angle, (designs, angles), SI; S counts from the ground's origin.

    ``parameters`` are arrays (designs,) of numbers of the description, SI, by the names of
    ``analytic.description.changes``; all else is as described, and the assembly modes are those that its sketch picks.
    ``angle`` (angles,) is in rad; ``speed`` (rad/s) and ``acceleration`` (rad/s²) are scalar or one per angle. Where a
    design cannot be assembled or stands in a dead position its values are nan, and False in ``assembled``, which is
    returned besides; that counts for the links that the signals need. ``path`` is "numpy", "compiled" or "auto", which
    compiles where that saves time. Raises UnknownNameError for an unknown parameter, signal or path, LinkproofError for
    wrong values, for signals that need a ``speed`` or an output that is missing, and where numba is missing for
    "compiled".
    """
    places = np.asarray(angle, dtype=float)
    arrays = checked_parameters(mechanism.linkage, parameters)
    chosen = check_signals(mechanism, names, has_speed=speed is not None)
    count = len(next(iter(arrays.values())))
    designs = Designs(
        mechanism, arrays, chosen, 0.0 if speed is None else speed, acceleration,
        all_groups=False, path=path, poses=count * len(places),
    )  # fmt: skip
    values = np.full((len(chosen), count, len(places)), np.nan)
    moves = np.zeros(values.shape[1:], dtype=np.bool_)

    def work(rows: Integers, sampler: Sampler) -> None:
        """Fill in the signals of the designs numbered ``rows``, NaN where a design cannot move."""
        samples = sampler(rows, np.broadcast_to(places, (len(rows), len(places))), chosen)
        moves[rows] = samples.moves
        for row, name in zip(values, chosen, strict=True):
            row[rows] = np.where(samples.moves, samples.signals[name], np.nan)

    designs.in_blocks(max(1, BLOCK // max(1, len(places))), work)
    return {**dict(zip(chosen, values, strict=True)), ASSEMBLED: moves}


# Designs that stand in a dead position between two crank angles, where samples alone do not show it.


# A dyad's determinant is zero in a dead position and goes there as the distance or faster: of the two samples on one of
# its sides the nearer has no more than half of the farther one's.
LEAST_RATIO: Final = 0.6
PARTS: Final = 8  # of a step that is looked into
FINEST: Final = 1e-8  # of all crank angles: two assembly modes that are not apart there meet


def are_steep(determinants: Array) -> Booleans:
    """Which steps between crank angles, (designs, angles - 1), a dead position may lie next to.

    There a dyad's determinant is at one end less than 0.6 of that at the other. The dyads' ``determinants`` (dyads,
    designs, angles) are magnitudes; a step beside one that is nan is marked too.
    """
    before, after = determinants[..., :-1], determinants[..., 1:]
    return np.asarray(np.any(~(np.minimum(before, after) >= LEAST_RATIO * np.maximum(before, after)), axis=0))


def with_neighbours(steps: Booleans) -> Booleans:
    """A copy of ``steps`` (designs, steps) in which the neighbours of marked ones are marked as well."""
    near = steps.copy()
    near[:, 1:] |= steps[:, :-1]
    near[:, :-1] |= steps[:, 1:]
    return near


def divided_steps(phi: Array, row: Integers, step: Integers, parts: int) -> Array:
    """Crank angles (n, parts + 1), rad, that divide steps of the designs' angles ``phi`` (designs, angles) evenly.

    Step ``step[i]`` of design ``row[i]`` makes row i.
    """
    low, high = phi[row, step, None], phi[row, step + 1, None]
    return np.asarray(low + (high - low) * np.linspace(0.0, 1.0, parts + 1))


def designs_stuck(sampler: Sampler, rows: Integers, angles: Array) -> Booleans:
    """Which designs of some rows (n,) cannot move from one of the crank angles (angles,) to the next.

    ``rows`` are the designs' numbers; the angles, rad, ascend. Also those that pass a change point, at which two
    assembly modes meet, unless the linkage as described does.
    """
    result = np.zeros(len(rows), dtype=bool)
    size = max(1, BLOCK // len(angles))
    for start in range(0, len(rows), size):
        designs = np.arange(start, min(start + size, len(rows)))
        phi = np.broadcast_to(angles, (len(designs), len(angles)))
        finest = FINEST * (angles[-1] - angles[0])
        while len(designs):
            samples = sampler(rows[designs], phi, ())
            result[designs[~samples.moves.all(axis=1)]] = True
            steep = are_steep(samples.determinants) & ~result[designs, None]
            if phi[0, 1] - phi[0, 0] < finest:
                result[designs[steep.any(axis=1)]] = True
                break
            row, step = np.nonzero(with_neighbours(steep))
            designs, phi = designs[row], divided_steps(phi, row, step, PARTS)
    return result


# Parameters of designs: known names, equal lengths, possible values.


def speed_of(numbers: Mapping[str, Any], speed: ArrayLike) -> Any:  # noqa: ANN401 - plain or arrays
    """The driver's signed speed, rad/s or m/s: the designs' own, with the sign of ``speed``, or ``speed`` itself.

    The own one is ``SPEED`` among ``numbers`` by name.
    """
    return numbers[SPEED] * np.sign(speed) if SPEED in numbers else np.asarray(speed)


def checked_parameters(
    linkage: Linkage, parameters: Mapping[str, ArrayLike], *, has_speed: bool = False
) -> dict[str, Array]:
    """The parameters as arrays (designs,) by name: numbers of a description but the sketch's, and ``SPEED``.

    This is known only with ``has_speed``. Raises UnknownNameError for another name, LinkproofError for none, for arrays
    that are not of one length or not flat, numbers that are not finite, negative masses or inertias, directions of no
    length and speeds of zero.
    """
    numbers = design_numbers(linkage)
    kinds: dict[str, str] = {name: kind for name, (kind, _) in numbers.items()} | ({SPEED: SPEED} if has_speed else {})
    for name in parameters:
        if name not in kinds:
            raise UnknownNameError(f"parameter of '{linkage.name}'", name, kinds)
    arrays = {name: np.asarray(values, dtype=float) for name, values in parameters.items()}
    shapes = {values.shape for values in arrays.values()}
    if len(shapes) != 1 or len(next(iter(shapes))) != 1 or next(iter(shapes)) == (0,):
        raise LinkproofError(
            "parameters: expected one or more flat arrays of one length, a value per design, got "
            f"{', '.join(f'{name} of shape {values.shape}' for name, values in arrays.items()) or 'none'}; "
            "give every parameter a value per design"
        )
    for name, values in arrays.items():
        _check_values(name, kinds[name], values)
    directions = [name for name, (kind, _) in numbers.items() if kind == "direction"]
    for x, y in zip(directions[::2], directions[1::2], strict=True):
        if x in arrays or y in arrays:
            _check_direction(x.removesuffix(".x"), *(arrays.get(name, np.asarray(numbers[name][1])) for name in (x, y)))
    return arrays


def _check_values(name: str, kind: str, values: Array) -> None:
    """Raise LinkproofError for numbers that are not finite, negative masses or inertias, and a speed of zero.

    ``kind`` is that of ``Kind``, or ``SPEED``; ``name`` is for the message.
    """
    wrong = ~np.isfinite(values)
    expected = "finite numbers"
    if kind in ("mass", "inertia"):
        wrong |= values < 0.0
        expected = "finite numbers, none negative"
    if kind == SPEED:
        wrong |= values == 0.0
        expected = "finite numbers other than 0"
    if np.any(wrong):
        first = int(np.argmax(wrong))
        raise LinkproofError(f"{name}: expected {expected}, got {values[first]:g} in design {first}; correct it")


def _check_direction(name: str, x: Array, y: Array) -> None:
    """Raise LinkproofError for a direction (x, y) of length zero in any design; ``name`` is for the message."""
    size = np.hypot(x, y)
    if not np.all(size):
        first = int(np.argmin(size != 0.0))
        raise LinkproofError(f"{name}: expected a direction, got (0, 0) in design {first}; correct it")
