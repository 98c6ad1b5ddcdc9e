"""Streams of small character sets."""

import io
import sys

from reports.document.numbers import accept_any_text


def test_a_sign_that_a_character_set_lacks_is_shown_by_a_plain_one(monkeypatch):
    written = io.BytesIO()
    monkeypatch.setattr(sys, "stdout", io.TextIOWrapper(written, encoding="cp1252"))
    accept_any_text()
    sys.stdout.write("1e-5 ✓ ✗ φ 90° ½ 机 \udcff")
    sys.stdout.flush()
    assert written.getvalue().decode("cp1252") == "1e-5 + x phi 90° ½ ? ?"
