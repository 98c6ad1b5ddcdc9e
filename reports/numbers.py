"""How figures are written in a report: the same digits everywhere, so that two reports differ only where results do."""

from __future__ import annotations

import math

ABSENT = "–"


def figure(value: float | None, digits: int = 4) -> str:
    """A value to so many significant digits, its exponent without padding: 8.339e-5, 0.2704, 31.00."""
    if value is None or not math.isfinite(value):
        return ABSENT
    if value == 0.0:
        return "0"
    mantissa, _, exponent = f"{value:#.{digits}g}".partition("e")
    mantissa = mantissa.removesuffix(".")
    return f"{mantissa}e{int(exponent)}" if exponent else mantissa


def printed(value: float) -> str:
    """A figure as a source prints it, without digits it does not have: 8.3e-5, 0.16, 24."""
    mantissa, _, exponent = f"{value:.6g}".partition("e")
    return f"{mantissa}e{int(exponent)}" if exponent else mantissa


def error(value: float | None) -> str:
    """A deviation to two digits, always with an exponent: 1.2e-5."""
    if value is None or not math.isfinite(value):
        return ABSENT
    if value == 0.0:
        return "0"
    mantissa, exponent = f"{value:.1e}".split("e")
    return f"{mantissa}e{int(exponent)}"


def bound(value: float | None) -> str:
    """A limit as it stands in its table: 1e-4, 2.5e-6."""
    if value is None:
        return ABSENT
    mantissa, exponent = f"{value:.3e}".split("e")
    return f"{float(mantissa):g}e{int(exponent)}"


def per_cent(ratio: float) -> str:
    """A signed ratio in per cent to one decimal: +4.2 %."""
    return f"{100.0 * ratio:+.1f} %"


def seconds(value: float) -> str:
    """A time to three significant digits in s or ms."""
    return f"{figure(value, 3)} s" if value >= 1.0 else f"{figure(value * 1e3, 3)} ms"
