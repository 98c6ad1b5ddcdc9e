"""The signals of a linkage as one list of operations, and that list as machine code and as JavaScript."""

from __future__ import annotations

import importlib.util
import math
import os
import threading
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from math import isfinite, isnan
from typing import Any, Final, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from analytic.description.changes import SPEED, with_numbers
from analytic.errors import LinkproofError, UnknownNameError
from analytic.kinematics.decomposition import find_structure
from analytic.kinematics.dyad_solver import DyadSolver
from analytic.kinematics.group_solver import GroupSolver
from analytic.kinematics.mechanism import Mechanism, once_per_mechanism
from analytic.kinematics.sweep import Sweep
from analytic.numerics.arrays import Array
from analytic.operations import CONSTANT, INPUT, OperationList
from analytic.signals import MovingSweep, signal

# The signals of a linkage as one list of operations: of its crank angle, the crank's motion and numbers that vary.


# No numbers' names; the last is the output's coordinate from which loads over S count, m.
PHI, ACCELERATION, ZERO_OF_S = ("crank angle", "crank acceleration", "zero of S")
OF_DESIGN, OF_PLACE = 1, 2


class TracedSweep(Sweep):
    """A sweep of traced numbers: where its groups can move is noted in ``moves`` in place of being checked.

    ``moves`` is a traced truth value, or True while no group has been solved.
    """

    moves: Any = True

    def _handle_assembly(self, solver: DyadSolver | GroupSolver) -> None:
        """Note in ``moves`` where the group can move, in place of an error."""
        self.moves = solver.moves if self.moves is True else self.moves & solver.moves

    def _check_motion(self, solver: DyadSolver | GroupSolver) -> None:
        """Do nothing: ``_handle_assembly`` has recorded where the group can move."""


@dataclass(frozen=True, eq=False)
class LinkageTrace:
    """Lines of the signals of designs that differ in ``varied`` numbers, and of whether all groups needed can move.

    ``signals``, ``moves`` and ``determinants``, the magnitudes of the dyads', are numbers of lines of the ``trace``.
    Its inputs are the varied numbers by name, ``PHI``, ``SPEED``, ``ACCELERATION``, ``ZERO_OF_S`` and laws over φ,
    which are named (law, order, component).
    """

    trace: OperationList
    varied: frozenset[str]
    signals: tuple[int, ...]
    moves: int
    determinants: tuple[int, ...]

    @property
    def lines(self) -> tuple[int, ...]:
        """Line numbers of the results: the signals, whether it moves, the determinants."""
        return (*self.signals, self.moves, *self.determinants)

    def values(
        self, numbers: Mapping[str, Any], phi: ArrayLike = 0.0, speed: ArrayLike = 0.0, acceleration: ArrayLike = 0.0
    ) -> dict[int, Any]:
        """Values of the inputs by line, SI: ``numbers`` by name, the crank's angle or stroke, speed, acceleration.

        Laws are evaluated at ``phi``; an input without a value is left out. ``numbers`` may have ``ZERO_OF_S``, m.
        """
        known = {**numbers, PHI: phi, SPEED: speed, ACCELERATION: acceleration}
        table: dict[int, Any] = {}
        for name, line in self.trace.inputs.items():
            if isinstance(name, tuple):
                law, order, component = name
                table[line] = law(phi, order)[component]
            elif name in known:
                table[line] = known[name]
        return table

    def split_inputs(self, outputs: Iterable[int]) -> tuple[list[int], list[int]]:
        """Of the lines that ``outputs`` need, those that depend on the design alone, and those on the crank alone.

        Of the design are the varied numbers and the zero of S. The lines are numbers, ascending. Each can be computed
        once and shared; what such lines need themselves is left out, and so are constants.
        """
        parts = dict.fromkeys(range(len(self.trace.operations)), 0)
        for name, line in self.trace.inputs.items():
            parts[line] = OF_DESIGN if name in {*self.varied, ZERO_OF_S} else OF_PLACE
        for line, operation in enumerate(self.trace.operations):
            if operation.name != INPUT:
                for other in operation.operands:
                    parts[line] |= parts[other]
        needed = self.trace.lines_needed(outputs)
        mixed = [line for line in needed if parts[line] == OF_DESIGN | OF_PLACE]
        used = sorted({other for line in mixed for other in self.trace.operations[line].operands} | set(outputs))
        return [line for line in used if parts[line] == OF_DESIGN], [line for line in used if parts[line] == OF_PLACE]


def is_traceable(mechanism: Mechanism) -> bool:
    """Whether a linkage can have a list of operations: it has dyads alone, without change points, and no friction."""
    has_list = not (mechanism.is_numerical or mechanism.linkage.friction)
    return has_list and not any(dyad.changes for dyad in mechanism.structure.dyads)


@once_per_mechanism
def _traces_by_request(_: Mechanism) -> dict[object, LinkageTrace]:
    """The cache of a mechanism, at first {}: its lists of operations by the request they were made for.

    The caller fills it.
    """
    return {}


def linkage_trace(
    mechanism: Mechanism,
    varied: Iterable[str],
    signals: Sequence[str],
    *,
    zero: Iterable[str] = (),
    accelerates: bool = False,
    all_groups: bool = True,
) -> LinkageTrace:
    """The list of a linkage's signals in which ``varied`` numbers are inputs, ``zero`` ones 0, others constants.

    Numbers are by name. The list is made once for a mechanism and a request. ``signals`` are names of
    ``analytic.signals``, magnitudes of vectors and the output's coordinate. ``accelerates`` makes the crank's
    acceleration an input, else it is 0; its speed always is one. ``all_groups`` takes the groups that no signal needs
    as well. Raises LinkproofError for a linkage that is not traceable, and for the output's coordinate of one without
    an output, UnknownNameError for a signal that it does not have.
    """
    if not is_traceable(mechanism):
        raise LinkproofError(
            f"'{mechanism.linkage.name}': expected groups of two links without change points and friction"
        )
    varied, zero, known = frozenset(varied), frozenset(zero), _traces_by_request(mechanism)
    key = (varied, tuple(signals), zero, accelerates, all_groups)
    if key in known:
        return known[key]
    trace = OperationList()
    linkage = with_numbers(
        mechanism.linkage, {name: trace.input(name) for name in sorted(varied)} | dict.fromkeys(zero, 0.0)
    )
    signs = tuple(dyad.sign for dyad in mechanism.structure.dyads)
    structure = find_structure(linkage).with_signs(signs)
    sweep = TracedSweep(linkage, structure, trace.input(PHI), zero_of_s=lambda: trace.input(ZERO_OF_S))  # type: ignore[arg-type]
    at = MovingSweep(mechanism, sweep, trace.input(SPEED), trace.input(ACCELERATION) if accelerates else 0.0)  # type: ignore[arg-type]
    lines = tuple(trace.line(signal(at, name)) for name in signals)
    dyads = sweep.structure.dyads if all_groups else ()
    determinants = tuple(trace.line(abs(sweep.determinant(dyad))) for dyad in dyads)
    return known.setdefault(key, LinkageTrace(trace, varied, lines, trace.line(sweep.moves), determinants))


# Printed functions as machine code, by numba where it is installed.
#
# A function takes 1 to 3 s to compile and serves this process only, so it is compiled where that saves time.


# A list of operations as the source of one straight Python function, laid out for a processor's vector registers.
#
#     def straight(lanes, rows, results): ...
#
# goes through chunks of ``LANES`` lanes, such as designs, and in each through rows, such as crank angles, with the
# lanes innermost. The k-th number of a chunk's lane d is ``lanes[chunk, k * LANES + d]``, the same in every row; the
# j-th of a row is ``rows[row, j]``, the same in every lane; ``results[chunk, m * LANES + d]`` is the m-th result.
# Constant offsets let the compiler see that no two of them overlap, and compute several lanes in one instruction.
# Sines and cosines of what is given, which a library computes lane by lane, come first in a loop of their own, and
# lie behind the numbers of the lanes (``sines_and_cosines``).


LANES: Final = 64
FUNCTION: Final = "straight"

# How each operation is written, of {0}, {1} and {2}. NumPy's maximum and minimum are nan where one number is.
PYTHON_FORMS: Final[Mapping[str, str]] = {
    **{"add": "{0} + {1}", "subtract": "{0} - {1}", "multiply": "{0} * {1}", "divide": "{0} / {1}"},
    **{"negative": "-{0}", "absolute": "abs({0})", "sign": "({0} > 0.0) - ({0} < 0.0)", "sqrt": "math.sqrt({0})"},
    "hypot": "math.sqrt({0} * {0} + {1} * {1})",  # a library's function would leave the vector registers
    **{"sin": "math.sin({0})", "cos": "math.cos({0})", "arctan2": "math.atan2({0}, {1})"},
    "maximum": "{0} if ({0} >= {1}) | ({0} != {0}) else {1}",
    "minimum": "{0} if ({0} <= {1}) | ({0} != {0}) else {1}",
    **{"less": "{0} < {1}", "less_equal": "{0} <= {1}", "greater": "{0} > {1}", "greater_equal": "{0} >= {1}"},
    **{"and": "{0} & {1}", "or": "{0} | {1}", "not": "not {0}", "where": "{1} if {0} else {2}"},
}
LOGICAL: Final = frozenset({"less", "less_equal", "greater", "greater_equal", "and", "or", "not"})
LATEST: Final = "{value}"  # a result that is the last row's


class Result(NamedTuple):
    """A result of each lane, from its ``start``: its value after the latest row that has been computed.

    The ``formula``, Python text, is of the ``line``'s value as {value}, of the result up to here as {so_far}, and of
    the next result in the list as {next}, as the row before has left it.
    """

    line: int
    formula: str = LATEST
    start: float = 0.0


def sines_and_cosines(trace: OperationList, lanes: Sequence[int], results: Sequence[Result]) -> list[int]:
    """Numbers, ascending, of the lines of sines and cosines of lanes' numbers, which are computed once before the rows.

    ``lanes`` are the lines that a lane is given; only what the ``results`` need counts.
    """
    rows = trace.operations
    needed = trace.lines_needed([result.line for result in results], lanes)
    return [line for line in needed if rows[line].name in {"sin", "cos"} and rows[line].operands[0] in lanes]


def python_source(trace: OperationList, lanes: Sequence[int], rows: Sequence[int], results: Sequence[Result]) -> str:
    """The Python source of ``FUNCTION``; ``lanes`` and ``rows`` are the lines that it is given for each.

    ``straight(lanes, rows, results)`` fills ``results`` in place, for chunks of 64 lanes. The k-th number of a chunk's
    lane d is lanes[chunk, k·64 + d], with the sines and cosines last, the j-th of a row is rows[row, j], and the m-th
    result is results[chunk, m·64 + d].
    """
    names: dict[int, str] = {}
    first = sines_and_cosines(trace, lanes, results)
    places = {line: f"given[{number * LANES} + d]" for number, line in enumerate([*lanes, *first])}
    outs = [f"out[{number * LANES} + d]" for number in range(len(results) + 1)]
    over_lanes = f"for d in range({LANES}):"
    begun = [f"{out} = {_python_number(result.start)}" for out, result in zip(outs, results, strict=False)]
    if all(result.formula == LATEST for result in results):
        begun = []  # no result is of what it was
    for line in first:  # side by side, so that a sine and a cosine of one number are one call
        operation = trace.operations[line]
        begun.append(f"{places[line]} = {PYTHON_FORMS[operation.name].format(places[operation.operands[0]])}")
    text = [
        f"def {FUNCTION}(lanes, rows, results):",
        "    for chunk in range(len(results)):",
        "        given, out = lanes[chunk], results[chunk]",
        f"        {over_lanes}",
        *(f"            {name}" for name in begun or ["pass"]),
        "        for row in range(len(rows)):",
    ]

    def take(depth: int, line: int, expression: str, *, is_given: bool = False) -> None:
        """Append to the source the statement that assigns an expression to the variable of the line numbered ``line``.

        It is indented by ``depth`` steps. ``is_given`` says that the expression reads an array of numbers, so that a
        truth value is compared with 0. The variable is noted in ``names``.
        """
        names[line] = f"v{line}"
        if is_given and trace.operations[line].name in LOGICAL:  # truth values are given as numbers
            expression = f"{expression} != 0.0"
        text.append(f"{' ' * 4 * depth}v{line} = {expression}")

    for number, line in enumerate(rows):
        take(3, line, f"rows[row, {number}]", is_given=True)
    text.append(f"            {over_lanes}")
    for line, place in places.items():
        take(4, line, place, is_given=True)
    for line in trace.lines_needed([result.line for result in results], names):
        operation = trace.operations[line]
        if operation.name == CONSTANT:
            names[line] = _python_number(operation.value)
        elif line not in names:
            take(4, line, PYTHON_FORMS[operation.name].format(*(names[other] for other in operation.operands)))
    for number, result in enumerate(results):
        value = result.formula.format(value=names[result.line], so_far=outs[number], next=outs[number + 1])
        text.append(f"{' ' * 16}{outs[number]} = {value}")
    return "\n".join(text) + "\n"


def _python_number(value: float) -> str:
    """A number as Python source; NaN and infinity as calls of ``float``."""
    return repr(value) if isfinite(value) else f"float('{value!r}')"


# A list of operations as plain data, which a page computes: no code, so that it may come out of an address.


Program = dict[str, Any]


def plain_program(trace: OperationList, given: Sequence[int], rows: Sequence[int], results: Sequence[int]) -> Program:
    """The list that leads from ``given`` numbers of a design and those of a row to results, JSON-ready; all are lines.

    The keys are given and rows, with how many numbers each has, constants, names, operations and results. Values have
    numbers: those ``given`` first, then those of the ``rows``, ``constants``, and one of each of the ``operations``,
    which have the place of their name among ``names`` and the numbers of their operands; ``results`` are such numbers.
    A constant that is not finite is text, its name in JavaScript.
    """
    known = (*given, *rows)
    needed = [line for line in trace.lines_needed(results, known) if line not in known]
    constants = [line for line in needed if trace.operations[line].name == CONSTANT]
    others = [line for line in needed if trace.operations[line].name != CONSTANT]
    number = {line: place for place, line in enumerate((*known, *constants, *others))}
    names = sorted({trace.operations[line].name for line in others})
    values = [trace.operations[line].value for line in constants]
    return {
        "given": len(given),
        "rows": len(rows),
        "constants": [value if isfinite(value) else _number_of_javascript(value) for value in values],
        "names": names,
        "operations": [
            [names.index(trace.operations[line].name), *(number[other] for other in trace.operations[line].operands)]
            for line in others
        ],
        "results": [number[line] for line in results],
    }


def _number_of_javascript(value: float) -> str:
    """The name that NaN or an infinity has in JavaScript."""
    return "NaN" if isnan(value) else "Infinity" if value > 0.0 else "-Infinity"


PATHS: Final = ("auto", "numpy", "compiled")
# s per operation of a list: what compiling it takes, above a second, and what NumPy takes for each lane and row.
COMPILING, LEAST_COMPILING, BY_NUMPY = 2.5e-3, 1.0, 1e-9
MOST_OPERATIONS: Final = 3000  # compiling a longer list takes longer than it saves


def is_worthwhile(path: str, operations: int, poses: float) -> bool:
    """Whether to compile a list of so many operations for so many ``poses``, lanes times rows.

    ``path`` is ``numpy``, never, ``compiled``, always, or ``auto``: where NumPy would take longer than compiling does
    and numba is installed. Raises UnknownNameError for another, LinkproofError where numba is missing for "compiled".
    """
    if path not in PATHS:
        raise UnknownNameError("path", path, PATHS)
    if path == "compiled" and not is_installed():
        raise LinkproofError(
            "compiled path: expected numba, which compiles it, got an installation without; pip install "
            "'linkproof[compiled]', or choose the path 'numpy'"
        )
    if path != "auto":
        return path == "compiled"
    seconds = BY_NUMPY * operations * poses
    return operations <= MOST_OPERATIONS and seconds > LEAST_COMPILING + COMPILING * operations and is_installed()


@lru_cache(maxsize=1)
def is_installed() -> bool:
    """Whether numba is installed; it is not imported for the answer, which is kept."""
    return importlib.util.find_spec("numba") is not None


class StraightFunction:
    """Lines of a trace as machine code: ``results`` of lanes, from ``lanes`` and ``rows``, lines that are given.

    Lanes, such as designs, are computed side by side; each goes through the rows, such as crank angles, one after
    another. The compiled code releases the interpreter's lock.
    """

    def __init__(
        self, trace: OperationList, lanes: Sequence[int], rows: Sequence[int], results: Sequence[Result]
    ) -> None:
        """Compile the results of a list, in a second or more; ``lanes`` and ``rows`` are the lines that it is given.

        Raises ImportError where numba is missing.
        """
        self.lanes, self.rows = tuple(lanes), tuple(rows)
        self._widths = len(lanes) + len(sines_and_cosines(trace, lanes, results)), len(results)
        self._straight = compile_source(python_source(trace, lanes, rows, results))
        self._scratch = threading.local()

    def __call__(self, lanes: Sequence[Any], rows: Array, count: int) -> Array:
        """Results (results, count) of ``count`` lanes, as a new array.

        ``lanes`` has, for each line of a lane, a number or an array (count,); ``rows`` (rows, k) has the numbers of
        each row for the k lines of a row, contiguous.
        """
        given, out = self._memory(-(-count // LANES))
        full = count - count % LANES
        for number, values in enumerate(lanes):
            flat = np.broadcast_to(values, count)
            given[: full // LANES, number] = flat[:full].reshape(-1, LANES)
            if full < count:
                given[-1, number, : count - full] = flat[full:]
                given[-1, number, count - full :] = flat[-1]
        self._straight(given.reshape(len(given), -1), rows, out.reshape(len(out), -1))
        results = np.empty((len(out[0]), count))
        results[:, :full].reshape(len(results), full // LANES, LANES)[:] = out[: full // LANES].swapaxes(0, 1)
        if full < count:
            results[:, full:] = out[-1, :, : count - full]
        return results

    def _memory(self, chunks: int) -> tuple[Array, Array]:
        """This thread's arrays, of numbers given and of results, (chunks, numbers, 64); they keep what was in them.

        Reused, since new memory costs more than computing.
        """
        values: tuple[Array, Array] | None = getattr(self._scratch, "arrays", None)
        if values is None or len(values[0]) < chunks:
            values = self._scratch.arrays = tuple(np.empty((chunks, width, LANES)) for width in self._widths)
        return values[0][:chunks], values[1][:chunks]


@lru_cache(maxsize=32)
def compile_source(source: str) -> Callable[[Array, Array, Array], None]:
    """The compiled function of a source that ``python_source`` has made; the latest 32 are kept.

    It takes lanes, rows and results, float arrays of two axes, and fills the last. Raises ImportError without numba.
    """
    import numba  # noqa: PLC0415 - optional, and slow to import

    space: dict[str, Any] = {"math": math}
    exec(source, space)
    numbers = numba.float64[:, ::1]
    signature = numba.void(numbers, numbers, numbers)
    function: Callable[[Array, Array, Array], None] = numba.njit(signature, nogil=True, error_model="numpy")(
        space[FUNCTION]
    )
    return function


def cores() -> int:
    """Number of processor cores that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def in_threads(function: Callable[[Any], object], parts: Sequence[Any]) -> None:
    """Call the function with every part, in threads on all cores, and return when all are done.

    What it returns is dropped. With one part or core it is called in this thread. The first error is raised again.
    """
    threads = min(len(parts), cores())
    if threads <= 1:
        for part in parts:
            function(part)
        return
    from concurrent.futures import ThreadPoolExecutor  # noqa: PLC0415 - one linkage needs none

    with ThreadPoolExecutor(threads) as pool:
        list(pool.map(function, parts))
