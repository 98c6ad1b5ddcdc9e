"""Counters of work: calls of functions of the product, and operations on its arrays."""

from __future__ import annotations

from collections import Counter
from typing import Any

import numpy as np


def calls(monkeypatch, owner: object, name: str) -> list[tuple[Any, ...]]:
    """Every call of ``owner.name`` from here on, as its arguments; the call itself is unchanged."""
    whole, seen = getattr(owner, name), []

    def counting(*args, **named):
        seen.append(args)
        return whole(*args, **named)

    monkeypatch.setattr(owner, name, counting)
    return seen


class Counted(np.ndarray):
    """An array all of whose descendants count the operations on them, by ufunc."""

    tally: Counter

    def __array_finalize__(self, other):
        self.tally = getattr(other, "tally", None)

    def __array_ufunc__(self, ufunc, method, *inputs, out=None, **named):
        plain = [part.view(np.ndarray) if isinstance(part, Counted) else part for part in inputs]
        into = {} if out is None else {"out": tuple(p.view(np.ndarray) if isinstance(p, Counted) else p for p in out)}
        self.tally[ufunc.__name__] += 1
        found = getattr(ufunc, method)(*plain, **into, **named)
        return counted(found, self.tally) if isinstance(found, np.ndarray) else found


def counted(values: np.ndarray, tally: Counter) -> Counted:
    """The array as one that counts into ``tally``."""
    result = np.asarray(values).view(Counted)
    result.tally = tally
    return result
