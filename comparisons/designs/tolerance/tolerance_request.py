"""The request of a tolerance study: results of a linkage whose numbers deviate from nominal, under a motion."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Final

import numpy as np
from numpy.typing import NDArray

from analytic.description.changes import SPEED, numbers
from analytic.designs.derivatives import is_exact
from analytic.errors import LinkproofError
from analytic.kinematics.mechanism import Mechanism
from comparisons.designs.named_figures import NamedFigure, named_figures
from comparisons.designs.parameters import mass_words
from comparisons.designs.steady_motion import SteadyMotion
from comparisons.designs.tolerance.tolerances import ANGLE, LENGTH, Tolerance, Tolerances, tolerances

Array = NDArray[np.float64]
Announce = Callable[[str, int, int], None]  # name of the stage, count done, count of all

FEWEST, MOST = 2, 10**7
SAMPLES: Final = 10_000
FEW_SAMPLES: Final = 200  # of a linkage whose groups are followed anew for every design, which takes a second or so
TOGETHER, ALONE = 1000, 5  # designs worked out between two announcements


@dataclass(frozen=True)
class ToleranceRequest:
    """Tolerances of a mechanism, the results they may move, its motion, the random designs, and conditions in words."""

    mechanism: Mechanism
    tolerances: tuple[Tolerance, ...]
    figures: tuple[NamedFigure, ...]
    motion: SteadyMotion
    samples: int
    seed: int = 0
    conditions: str = ""

    @property
    def _own(self) -> dict[str, float]:
        """The nominal numbers, SI, the speed among them."""
        return numbers(self.mechanism.linkage) | {SPEED: abs(self.motion.speed)}

    @property
    def names(self) -> list[str]:
        """The numbers of the description in which the designs differ."""
        return list(self.designs(np.zeros((len(self.tolerances), 1))))

    def designs(self, offsets: Array) -> dict[str, Array]:
        """Numbers of the description (designs,) by name, at offsets (tolerances, designs) from the nominal; SI.

        Masses and inertias that a wide normal distribution makes negative are zero.
        """
        nominal, table = self._own, {}
        polar: dict[str, dict[str, Array]] = {}
        for tolerance, offset in zip(self.tolerances, offsets, strict=True):
            if tolerance.point:
                polar.setdefault(tolerance.point, {})[tolerance.name.removeprefix(tolerance.point)] = offset
            else:
                least = 0.0 if tolerance.parameter.kind in ("mass", "inertia") else -math.inf
                table[tolerance.name] = np.maximum(nominal[tolerance.name] + offset, least)
        for point, moved in polar.items():
            x, y = nominal[f"{point}.x"], nominal[f"{point}.y"]
            length, angle = math.hypot(x, y) + moved.get(LENGTH, 0.0), moved.get(ANGLE, np.zeros(offsets.shape[1]))
            c, s = (length / math.hypot(x, y) * part for part in (np.cos(angle), np.sin(angle)))
            table |= {f"{point}.x": c * x - s * y, f"{point}.y": s * x + c * y}
        return table

    def results(self, offsets: Array, announce: Announce = lambda *_: None) -> Array:
        """The results of designs, (results, designs)."""
        designs, count, parts = self.designs(offsets), offsets.shape[1], []
        size = TOGETHER if is_exact(self.mechanism) else ALONE
        for start in range(0, count, size):
            announce("designs", start, count)
            some = {name: values[start : start + size] for name, values in designs.items()}
            parts.append(self.motion.figures(self.mechanism, some, [figure.figure for figure in self.figures]))
        return np.concatenate(parts, axis=1)

    def derivatives(self) -> Array:
        """Derivatives of the results by what has a tolerance, (results, tolerances)."""
        nominal = self._own
        figures = [figure.figure for figure in self.figures]
        _, gradients = self.motion.gradients(self.mechanism, {name: nominal[name] for name in self.names}, figures)
        by = dict(zip(self.names, gradients.T, strict=True))
        columns = []
        for tolerance in self.tolerances:
            if not tolerance.point:
                columns.append(by[tolerance.name])
                continue
            (x, y), (over_x, over_y) = ([of[f"{tolerance.point}.{part}"] for part in "xy"] for of in (nominal, by))
            turns = tolerance.name.endswith(ANGLE)
            columns.append(x * over_y - y * over_x if turns else (x * over_x + y * over_y) / math.hypot(x, y))
        return np.stack(columns, axis=1)


def tolerance_request(
    mechanism: Mechanism,
    motion: SteadyMotion,
    requested: Tolerances,
    *,
    samples: int | None = None,
    seed: int = 0,
    conditions: str = "",
) -> ToleranceRequest:
    """The checked request of a tolerance study; ``conditions`` describes the motion in words.

    Without ``samples`` there are 10 000 random designs, or 200 of a linkage that is computed design by design. Raises
    LinkproofError for an unknown name, no results, too few or too many samples, or a negative seed.
    """
    result = tolerances(mechanism.linkage, requested.table, f"{requested.origin}tolerances.", motion.speed)
    if not requested.results:
        raise LinkproofError(f'{requested.origin}results: expected a figure, as "Mkr.peak", got none; name one')
    try:
        figures = named_figures(mechanism, requested.results)
    except LinkproofError as error:
        raise LinkproofError(f"{requested.origin}{error}") from error
    if samples is None:
        samples = SAMPLES if is_exact(mechanism) else FEW_SAMPLES
    if samples < FEWEST:
        raise LinkproofError(f"--samples: expected {FEWEST} or more random designs, got {samples}; draw more")
    if samples > MOST:
        raise LinkproofError(f"--samples: expected {MOST} random designs or fewer, got {samples}; draw fewer")
    if seed < 0:
        raise LinkproofError(f"--seed: expected a number from 0 on, got {seed}; give another")
    request = ToleranceRequest(mechanism, result, figures, motion, samples, seed)
    return replace(request, conditions=conditions + mass_words(mechanism.linkage, request.names))
