"""The data sheet as plain data: written beside a campaign's curves, read back without the closed form."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from analytic.description.linkage import Linkage, Vector

Array = NDArray[np.float64]

FILE = "mechanisms.json"


@dataclass(frozen=True)
class Positions:
    """Where the bodies are at n instants, evenly spaced in the axis of the sheet: over one turn, or the whole motion.

    ``axis`` is φ, rad, or the time, s, (n,); ``angle`` φ or the travel, (n,). ``bodies`` has of each link, by name, the
    origin of its frame x, y, m, and its angle, rad, unwrapped, (3, n). ``carriers`` names the link that carries each
    point of a slot. ``closed``: the last instant is the first again.
    """

    axis: Array
    angle: Array
    bodies: Mapping[str, Array]
    carriers: Mapping[str, str]
    closed: bool


@dataclass(frozen=True)
class ThreadSheet:
    """The thread over a turn: φ, rad, feed and contour length, m, (n,); contour (stops, 3) at the reference angle, m.

    ``stops`` names the guides and eyes along the contour; ``eyes`` has of each eye its path (3, m), and the angles at
    which it is highest and lowest, rad. ``figures`` are ``mechanism_summary``'s of the thread.
    """

    angle: Array
    feed: Array
    length: Array
    contour: Array
    stops: tuple[str, ...]
    eyes: Mapping[str, Mapping[str, Any]]
    reference_angle: float
    figures: Mapping[str, Any]


@dataclass(frozen=True)
class Sheet:
    """All that a mechanism's page shows of the closed form, SI, angles in rad.

    ``conditions``, ``axis``, ``units``, ``values``, ``peaks`` and ``figures`` are what ``linkproof results --json``
    writes, values as arrays (n,), not a number where there is none. ``shares`` has Jeq by Assur group ("groups") and by
    link ("links") over the same instants, kg m². ``facts`` are those of ``linkproof show --json``. ``normalised`` has
    the unit functions S, v, a over a turn, the harmonics, and their mean differences. ``published`` are the printed
    figures of all variants (``PublishedRecord`` as dictionaries), ``released`` what there is to say of each released
    regime, in sentences, and its curves; ``printed`` the motions of models as printed. ``missing`` says of a part why
    it cannot be derived.
    """

    name: str
    variant: str
    text: str
    gravity: Vector
    formula: str
    conditions: str
    axis: str
    units: Mapping[str, str]
    values: Mapping[str, Array]
    peaks: Mapping[str, Mapping[str, float | None]]
    figures: Mapping[str, Any]
    facts: Mapping[str, Any]
    positions: Positions | None = None
    shares: Mapping[str, Mapping[str, Array]] = field(default_factory=dict)
    normalised: Mapping[str, Any] = field(default_factory=dict)
    thread: ThreadSheet | None = None
    published: tuple[Mapping[str, Any], ...] = ()
    released: Mapping[str, Mapping[str, Any]] = field(default_factory=dict)
    printed: tuple[Mapping[str, Any], ...] = ()
    missing: Mapping[str, str] = field(default_factory=dict)

    @cached_property
    def linkage(self) -> Linkage:
        """The linkage as it was described."""
        raise NotImplementedError
