"""Scenes that end the process or run on as nonsense, and that the checks of data common to all engines let pass.

pymunk's C core aborts the interpreter on masses, moments and iteration counts it does not like: the common checks and
those of an effort keep these away.
"""

from __future__ import annotations

from engines.pymunk_adapter.layout import PartLayout
from engines.scene import PinJoint


def freedom_obstacle(layout: PartLayout) -> str | None:
    """Whether the joints of a layout leave a linkage's one degree of freedom, by count, in one sentence if not.

    The free turning of parts without inertia does not count.
    """
    coordinates = sum(2 if part.inertia is None else 3 for part in layout.parts)
    freedom = coordinates - sum(2 if isinstance(hold, PinJoint) else 1 for hold in layout.holds)
    return None if freedom == 1 else f"the joints leave {freedom} degrees of freedom by count, where a linkage has one"
