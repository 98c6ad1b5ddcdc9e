"""The run-up of the source's validation and its smooth relatives, and constant speed, as exact polynomials of time."""

from __future__ import annotations

from analytic.description.crank_motion.prescribed import LARGEST, RPM, CrankMotion, Segment, check_number
from analytic.errors import UnknownNameError

# ω over its final value as a polynomial of x = t / ramp time, lowest power first.
RAMPS: dict[str, tuple[float, ...]] = {
    "run-up": (0.0, 1.0),
    "run-up-cubic": (0.0, 0.0, 3.0, -2.0),
    "run-up-quintic": (0.0, 0.0, 0.0, 10.0, -15.0, 6.0),
}
CONSTANT_SPEED = "constant-speed"
REGIMES = (*RAMPS, CONSTANT_SPEED)


def crank_motion(
    regime: str = "run-up",
    *,
    speed: float = 1000.0 * RPM,
    ramp_time: float = 0.6,
    hold_time: float = 0.1,
    clockwise: bool = False,
    start_angle: float = 0.0,
) -> CrankMotion:
    """Build a regime by name.

    ``run-up`` brings the crank from rest to ``speed`` (rad/s) linearly in ``ramp_time`` (s) and continues at
    it for ``hold_time``; ``run-up-cubic`` and ``run-up-quintic`` do so with continuous acceleration; ``constant-speed``
    turns at ``speed`` for ``ramp_time + hold_time``. ``start_angle`` is φ at t = 0, rad.
    """
    if regime not in REGIMES:
        raise UnknownNameError("regime", regime, REGIMES)
    check_number("speed", speed, "rad/s", 1.0 / LARGEST)
    steady = regime == CONSTANT_SPEED
    check_number("ramp time", ramp_time, "s", 0.0 if steady else 1.0 / LARGEST)
    check_number("hold time", hold_time, "s", 0.0)
    check_number("ramp and hold time together", ramp_time + hold_time, "s", 1.0 / LARGEST)
    check_number("start angle", start_angle, "rad", -LARGEST)
    signed = -speed if clockwise else speed
    if steady:
        return CrankMotion(regime, (Segment(0.0, ramp_time + hold_time, (start_angle, signed)),))
    scaled = [signed * c / ramp_time**k for k, c in enumerate(RAMPS[regime])]
    ramp = Segment(0.0, ramp_time, (start_angle, *(float(c) / (k + 1) for k, c in enumerate(scaled))))
    if hold_time <= 0.0:
        return CrankMotion(regime, (ramp,))
    hold = Segment(ramp_time, ramp_time + hold_time, (float(ramp.value(ramp_time)), signed))
    return CrankMotion(regime, (ramp, hold))
