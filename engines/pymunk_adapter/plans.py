"""How pymunk is stepped: the plans behind the settings, and those behind the methods that are offered for study.

- ``naive`` and ``defaults`` are what a newcomer writes: pymunk's defaults, every read-out at face value.
- ``centred`` is the stepping made second order (see ``passes``); passes with more steps to a sample are
  extrapolated with it.

The plans of ``tuned`` and ``best`` were chosen by error against time over steps, iterations and numbers of passes on
the catalogue: a fourth pass is worth more than the iterations it costs (three passes that leave 0.03 of an impulse's
change take longer than four that leave 0.2, and are off by thirteen times as much), and a fifth adds rounding alone.
``tuned`` has 150 samples to a turn because velocities are read between them.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final

from analytic.errors import LinkproofError, UnknownNameError
from engines.contract import Method, Setting
from engines.scene import Drive, Prescribed
from engines.stepping.driver import check_step

# A joint open by this share of the scene's size is the end of a naive run; less is for its reader to see.
TORN_JOINT = 0.1

NAIVE_STEP = 1e-4  # s

# Share of an impulse's change that a method leaves to the solver where its effort is not given: that of ``best``.
METHOD_REMAINING = 0.1

UNIT: Final = "iterations"


@dataclass(frozen=True)
class Aim:
    """What a setting asks of the steps it is to find by itself.

    ``samples_per_turn`` at the peak speed, ``least_samples`` in all. ``disagreement`` is how far the result may depend
    on the coarsest pass (``stepping.error_estimate``; the angle of a free crank by the end, rad).
    """

    samples_per_turn: int
    least_samples: int
    disagreement: float


@dataclass(frozen=True)
class Plan:
    """Passes to extrapolate: ``ratios`` are their steps to a sample.

    ``pace`` is the aim by which steps are found and passes judged, or the longest step of the coarsest pass, s, which
    is then taken as it is and whatever comes of it. ``iterations`` is the solver's effort in a step; None for as many
    as leave no more than the share ``remaining`` of an impulse's change wrong.
    """

    ratios: tuple[int, ...]
    pace: Aim | float
    remaining: float = METHOD_REMAINING
    iterations: int | None = None


@dataclass(frozen=True)
class PlainPlan:
    """One pass by pymunk's defaults at steps of at most ``step`` seconds; None leaves pymunk's iterations.

    ``torn`` is the share of the scene's size by which a joint may be open at most; None for any.
    """

    step: float
    iterations: int | None = None
    torn: float | None = None


PRESCRIBED: Mapping[Setting, PlainPlan | Plan] = {
    Setting.NAIVE: PlainPlan(NAIVE_STEP, torn=TORN_JOINT),
    Setting.TUNED: Plan((1, 3, 5, 7), Aim(150, 200, 1e-4), 0.2),
    Setting.BEST: Plan((1, 3, 5, 7), Aim(250, 200, 1e-6), 0.1),
}

# A free crank adds up its error of phase over all turns, and a prescribed one has none: it takes smaller steps. Over a
# hundred turns and more, its disagreement was measured to be several hundred times the error of three passes, thirty of
# four.
FREE: Mapping[Setting, PlainPlan | Plan] = {
    Setting.NAIVE: PRESCRIBED[Setting.NAIVE],
    Setting.TUNED: Plan((3, 5, 7), Aim(100, 1000, 0.1), 0.2),
    Setting.BEST: Plan((3, 5, 7, 9), Aim(120, 1000, 3e-5), 0.2),
}


def setting_plan(drive: Drive, setting: Setting) -> PlainPlan | Plan:
    """The plan of a setting."""
    return (PRESCRIBED if isinstance(drive, Prescribed) else FREE)[setting]


_DEFAULTS = Method("defaults", "pymunk's defaults at a fixed step, every read-out at face value", effort_unit=UNIT)
_CENTRED: Mapping[str, tuple[int, ...]] = {
    "centred": (1,),
    "centred x2": (1, 3),
    "centred x3": (1, 3, 5),
    "centred x4": (1, 3, 5, 7),
}

METHODS: tuple[Method, ...] = (
    _DEFAULTS,
    *(
        Method(
            name,
            "second order by unbiased joints, mean crank speeds and centred read-outs"
            + (f", extrapolated from the step over {', '.join(map(str, ratios))}" if len(ratios) > 1 else ""),
            levels=len(ratios),
            effort_unit=UNIT,
        )
        for name, ratios in _CENTRED.items()
    ),
)


def method_plan(method: Method, step: float) -> PlainPlan | Plan:
    """The plan of a method at a longest step, s; raises LinkproofError for a method, step or effort that is none."""
    if method.name not in {known.name for known in METHODS}:
        raise UnknownNameError("method of pymunk", method.name, [known.name for known in METHODS])
    check_step(step)
    iterations = None
    if method.effort is not None:
        if not 1.0 <= method.effort < 2**31:
            raise LinkproofError(
                f"effort of method '{method.name}': expected at least 1 iteration, got {method.effort:g}; give more, "
                "or None for as many as the linkage needs"
            )
        iterations = round(method.effort)
    if method.name == _DEFAULTS.name:
        return PlainPlan(step, iterations)
    return Plan(_CENTRED[method.name], step, iterations=iterations)
