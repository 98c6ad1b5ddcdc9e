"""How figures are written in a report: the same digits everywhere, so that two reports differ only where results do."""

from __future__ import annotations

import codecs
import math
import sys

ABSENT = "–"
SMALLEST, LARGEST = 1e-3, 1e6
ROUND_OFF = 1e-13


def figure(value: float | None, digits: int = 4) -> str:
    """A value as text with so many significant digits: 8.339e-5, 0.2704, 31.00; a dash for None or one not finite.

    It has an exponent below 1e-3 and from 1e6 on.
    """
    if value is None or not math.isfinite(value):
        return ABSENT
    if value == 0.0:
        return "0"
    if not SMALLEST <= abs(value) < LARGEST:
        return _scientific(value, digits)
    return _without_exponent(f"{value:#.{digits}g}")


def printed(value: float) -> str:
    """A finite value as text in at most six digits, without digits it does not have: 8.3e-5, 0.16, 24."""
    if value == 0.0:
        return "0"
    if not SMALLEST <= abs(value) < LARGEST:
        return _scientific(value, 6, trailing=False)
    return _without_exponent(f"{value:.6g}")


def _without_exponent(text: str) -> str:
    """A number's text, given with or without exponent, without one and without a trailing point."""
    return f"{float(text):.0f}" if "e" in text else text.removesuffix(".")


def _scientific(value: float, digits: int, *, trailing: bool = True) -> str:
    """A finite value to so many significant digits, with an exponent that is not padded, as text: 1.20e-5.

    Without ``trailing`` the zeros at the end of its digits go: 1.2e-5.
    """
    mantissa, exponent = f"{value:.{digits - 1}e}".split("e")
    return f"{mantissa if trailing else f'{float(mantissa):g}'}e{int(exponent)}"


def error(value: float | None) -> str:
    """A deviation, 0 or more, as text to two digits: 1.9, and below one or from a hundred on with an exponent, 1.2e-5.

    A dash for None or one not finite.
    """
    if value is None or not math.isfinite(value):
        return ABSENT
    if value == 0.0 or 0.995 <= value < 100.0:
        return f"{value:#.2g}".removesuffix(".") if value else "0"
    return _scientific(value, 2)


def steady_error(value: float | None) -> str:
    """A deviation as text as ``error`` has it; below 1e-13, which is round-off, "< 1e-13".

    Its digits say nothing and differ from machine to machine.
    """
    return f"< {bound(ROUND_OFF)}" if value is not None and value < ROUND_OFF else error(value)


def bound(value: float | None) -> str:
    """A limit as text in at most four digits and an exponent, as in its table: 1e-4, 2.5e-6; a dash for None."""
    return ABSENT if value is None else _scientific(value, 4, trailing=False)


def decade(value: float) -> str:
    """The power of ten at or above a bound as text: 1e-9 for 2.3e-10; for 1e-13, round-off, or less always 1e-13."""
    return f"1e{math.ceil(math.log10(max(value, ROUND_OFF)))}"


def seconds(value: float) -> str:
    """A time, s, as text to three significant digits with its unit, in s or, below 1 s, in ms."""
    return f"{figure(value, 3)} s" if value >= 1.0 else f"{figure(value * 1e3, 3)} ms"


def grouped(count: int, space: str = " ") -> str:
    """A count as text with ``space`` between its thousands."""
    return f"{count:,}".replace(",", space)


def within_turn(angle: float, digits: int = 1) -> str:
    """An angle, given in degrees, within [0°, 360°) as text with ``digits`` decimals: 359.97 is 0.0°, not 360.0°."""
    return f"{round(angle, digits) % 360.0:.{digits}f}°"


# Text for terminals and files of any character set: a sign that a set lacks is replaced by a plain sign.


# Replacements of signs in a character set that lacks them.
PLAIN = {
    "✓": "+", "✗": "x", "≈": "~", "≠": "!=", "○": "o", "−": "-", "²": "2", "φ": "phi", "ω": "omega", "ε": "eps",
}  # fmt: skip


def accept_any_text() -> None:
    """Make stdout and stderr replace characters that they cannot encode by plain signs, not fail.

    Registers "linkproof.plain", a handler of coding errors.
    """
    codecs.register_error("linkproof.plain", _replacement)
    for stream in (sys.stdout, sys.stderr):
        if hasattr(stream, "reconfigure"):
            stream.reconfigure(errors="linkproof.plain")


def _replacement(fault: UnicodeError) -> tuple[str, int]:
    """Plain signs, "?" for those without one, for characters that a stream cannot encode, and the position to go on at.

    It is a handler of coding errors; raises those of decoding.
    """
    if not isinstance(fault, UnicodeEncodeError):
        raise fault
    return "".join(PLAIN.get(sign, "?") for sign in fault.object[fault.start : fault.end]), fault.end
