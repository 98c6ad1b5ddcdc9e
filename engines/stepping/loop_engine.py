"""An engine whose build and steps are a module of their own, which ``compare --script`` can write down as it is.

The module, the adapter's *loop*, imports NumPy and its engine alone and takes plain data: numbers, text, None, and
lists, tuples and dictionaries of these. It has two functions, both of which raise ArithmeticError, with the reason, for
what the engine refuses or gives up:

* ``build(model)``: the engine's own model in its start state, from what the adapter's ``model`` describes;
* ``follow(world, course)``: one pass through it; returns times and values by channel, forces by joint under
  ``"joint_force"``, as :class:`engines.contract.History` has them.

A course has ``parts``, the steps ``ratio`` to a sample, the ``channels`` to record, and ``details`` and ``solver_work``
for what a loop reports. A part has ``start``, ``end``, ``samples``, ``after_jump`` and its ``segment`` of the motion:
when that starts and the polynomial of the driver's coordinate from then on, lowest power first; None for a free driver.
"""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Mapping
from importlib import import_module
from typing import Any, ClassVar

import numpy as np

from analytic.description.law import Law
from engines.contract import History, Signal
from engines.scene import Channel, Scene
from engines.stepping.intervals import DivergedError, UnsupportedError
from engines.stepping.stepped_engine import Course, R, SteppedEngine

# A law over φ in plain data: its components, or its knots, the cubics from each on, and whether it repeats.
PlainLaw = list[float] | tuple[list[float], list[Any], bool]


class LoopEngine(SteppedEngine[Any, R]):
    """An adapter that describes a scene in plain data; ``loop`` names the module that runs it."""

    loop: ClassVar[str]

    @abstractmethod
    def model(self, scene: Scene, recipe: R) -> Mapping[str, Any]:
        """A scene in plain data, arrays of NumPy among them, for the loop's ``build``."""

    def build(self, scene: Scene, recipe: R) -> Any:  # noqa: ANN401 - the loop's
        """The loop's world of a scene."""
        model = plain(self.model(scene, recipe))
        try:
            return import_module(self.loop).build(model)
        except ArithmeticError as error:
            raise _run_error(error, UnsupportedError) from error

    def follow(self, world: Any, course: Course[R]) -> History:  # noqa: ANN401
        """The loop's samples of a pass as a history."""
        given = plain_course(course)
        try:
            samples = import_module(self.loop).follow(world, given)
        except ArithmeticError as error:
            raise _run_error(error, DivergedError) from error
        finally:
            course.cost.solver_work += given["solver_work"]
            course.cost.details.update(given["details"])
        forces = {name: _read_signal(pair) for name, pair in samples.pop(Channel.JOINT_FORCE.value, {}).items()}
        return History(**{name: _read_signal(pair) for name, pair in samples.items()}, joint_force=forces)


def _run_error(error: ArithmeticError, kind: type[Exception]) -> Exception:
    """The error by which a run ends, for a reason that a loop raises; any other error stays what it is."""
    return kind(str(error)) if type(error) is ArithmeticError else error  # a division by zero is an error of the loop


def _read_signal(pair: tuple[Any, Any]) -> Signal:
    time, values = pair
    return Signal(np.asarray(time), np.asarray(values))


def plain_course(course: Course[Any]) -> dict[str, Any]:
    """A course as a loop takes it."""
    parts = [
        {
            "start": part.start,
            "end": part.end,
            "samples": part.samples,
            "after_jump": part.after_jump,
            "segment": part.segment and (part.segment.start, [*map(float, part.segment.coefficients)]),
        }
        for part in course.parts
    ]
    channels = [channel for channel in Channel if channel in course.channels]
    given = {"ratio": course.ratio, "channels": channels, "parts": parts, "details": {}, "solver_work": 0}
    return dict(plain(given))


def plain_law(law: Law) -> PlainLaw:
    """A law as plain data."""
    return law.values.tolist() if law.is_constant else (*law.pieces(), law.periodic)


def plain(value: Any) -> Any:  # noqa: ANN401 - one line for each type
    """Data whose ``repr`` is Python source for the same; raises TypeError for what is none."""
    if isinstance(value, (np.ndarray, np.generic)):
        return plain(value.tolist())
    if isinstance(value, Mapping):
        return {plain(key): plain(each) for key, each in value.items()}
    if isinstance(value, (list, tuple)):
        return (list if isinstance(value, list) else tuple)(map(plain, value))
    if isinstance(value, str):
        return str.__str__(value)  # not what a subclass shows of itself
    if value is None or type(value) in (bool, int, float, complex):
        return value
    raise TypeError(f"expected plain data for a loop, got {type(value).__name__}")
