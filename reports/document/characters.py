"""Text for terminals and files of any character set: a sign that a set lacks is replaced by a plain sign."""

from __future__ import annotations

import codecs
import sys

# Replacements of signs in a character set that lacks them.
PLAIN = {
    "✓": "+", "✗": "x", "≈": "~", "≠": "!=", "○": "o", "−": "-", "²": "2", "φ": "phi", "ω": "omega", "ε": "eps",
}  # fmt: skip


def accept_any_text() -> None:
    """Let stdout and stderr show a plain sign where their character set lacks one, rather than fail."""
    codecs.register_error("linkproof.plain", _plain)
    for stream in (sys.stdout, sys.stderr):
        if hasattr(stream, "reconfigure"):
            stream.reconfigure(errors="linkproof.plain")


def _plain(fault: UnicodeError) -> tuple[str, int]:
    if not isinstance(fault, UnicodeEncodeError):
        raise fault
    return "".join(PLAIN.get(sign, "?") for sign in fault.object[fault.start : fault.end]), fault.end
