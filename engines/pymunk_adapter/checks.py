"""What pymunk does not tell: scenes that end the process or run on as nonsense, and motions that are not the scene's.

pymunk's C core aborts the interpreter on masses, moments and iteration counts it does not like, and runs on with nan,
with joints that cannot close and with a crank that does not follow its motor. So data are checked before anything is
built, and the motion after every pass.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from analytic.description.crank_motion import Segment
from engines.pymunk_adapter.layout import PartLayout
from engines.pymunk_adapter.recording import WATCHED, Recording, gaps
from engines.scene import PinJoint
from engines.stepping.driver import DivergedError

Array = NDArray[np.float64]

# A joint open by more than this share of the scene's size, or a crank off by more than this, rad, is another motion.
# The suite has closer limits; these are for motions that no longer are a linkage's.
OPEN_JOINT = 1e-2
LOST_CRANK = 0.05

# Share of the torque added for its sign below which the drive's impulse leaves the sign in doubt.
DOUBT = 0.05


def freedom_obstacle(layout: PartLayout) -> str | None:
    """Whether the joints of a layout leave a linkage's one degree of freedom, by count, in one sentence if not.

    The free turning of parts without inertia does not count.
    """
    coordinates = sum(2 if part.inertia is None else 3 for part in layout.parts)
    freedom = coordinates - sum(2 if isinstance(hold, PinJoint) else 1 for hold in layout.holds)
    return None if freedom == 1 else f"the joints leave {freedom} degrees of freedom by count, where a linkage has one"


def check_finite(times: Array, seen: Array) -> None:
    """Raise DivergedError where the parts' states (n, parts, 2, 3) are not finite."""
    finite = np.isfinite(seen).all(axis=(1, 2, 3))
    if not finite.all():
        raise DivergedError(f"the motion is not finite from {max(0.0, times[np.argmin(finite)]):.4g} s on")


def check_joints(times: Array, seen: Array, layout: PartLayout, share: float = OPEN_JOINT) -> None:
    """Raise DivergedError where a joint is open by more than a share of the scene's size.

    Looks are thinned out: a joint that opens stays open.
    """
    thin = slice(None, None, max(1, len(times) // WATCHED))
    opened = gaps(layout, seen[thin, :, 0])
    look, number = np.unravel_index(np.argmax(opened), opened.shape)
    if opened[look, number] > share * layout.reach:
        joint, gap = layout.equations.joints[number], opened[look, number]
        raise DivergedError(f"joint '{joint}' is open by {gap:.2g} m at {times[thin][look]:.4g} s")


def check_crank(recording: Recording, layout: PartLayout, segment: Segment) -> None:
    """Raise DivergedError where the crank is not where its motion has it."""
    off = np.abs(recording.state[:, layout.crank, 2] - segment.value(recording.times))
    worst = int(np.argmax(off))
    if off[worst] > LOST_CRANK:
        raise DivergedError(f"the crank is {off[worst]:.2g} rad from its motion at {recording.times[worst]:.4g} s")


def check_impulses(recording: Recording, offset: float) -> None:
    """Raise DivergedError where the drive's impulse is too near to zero to tell its sign."""
    left = offset - recording.torque
    worst = int(np.argmin(left))
    if left[worst] < DOUBT * offset:
        torque, time = recording.torque[worst], recording.times[worst]
        raise DivergedError(f"the drive torque grew beyond all bounds: {torque:.3g} N m at {time:.4g} s")
