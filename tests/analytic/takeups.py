"""The take-up linkages of articles 000 and 001, which the catalogue has."""

from tests.analytic.linkages import mechanism as takeup

SLOTTED, TWO_CRANK = "slotted-takeup", "two-crank-takeup"

__all__ = ["SLOTTED", "TWO_CRANK", "takeup"]
