"""The words of the command line that have designs simulated, and what comes of it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final, NamedTuple

from analytic.errors import LinkproofError
from reports.command_line import PASSED
from reports.command_line.requests import named
from reports.document.terminal import Printout

if TYPE_CHECKING:
    from comparisons.designs.trust.trust import SpaceTrust

DESIGNS: Final = 24


@dataclass(frozen=True)
class TrustChoice:
    """Which engines are tried on how many designs, drawn by which seed."""

    engines: tuple[str, ...] = ()
    designs: int = DESIGNS
    seed: int = 0

    def check(self) -> None:
        """Raise LinkproofError, before anything is worked out, for engines that are not there and for no designs."""
        if self.designs < 1:
            raise LinkproofError(f"--designs: expected 1 design or more to simulate, got {self.designs}; give more")
        if self.seed < 0:
            raise LinkproofError(f"--seed: expected a whole number, 0 or more, got {self.seed}; give another")
        if not self.engines and (self.designs, self.seed) != (DESIGNS, 0):
            option = "--designs" if self.designs != DESIGNS else "--seed"
            raise LinkproofError(f"{option} is for designs that are simulated: name an engine with --simulate")
        named(self.engines)

    @property
    def words(self) -> Mapping[str, Sequence[str]]:
        """The options that ask for the same, with their values."""
        numbers = {"designs": (self.designs, DESIGNS), "seed": (self.seed, 0)}
        told = {name: [str(value)] if value != usual else [] for name, (value, usual) in numbers.items()}
        return {"simulate": self.engines, **told}


class Trusted(NamedTuple):
    """How far engines may be trusted, what is printed of it, and the exit code: an engine that fails is a finding."""

    trust: SpaceTrust | None
    printout: Printout
    exit_code: int


NOTHING: Final = Trusted(None, Printout([], []), PASSED)
