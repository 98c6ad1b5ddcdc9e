"""Figures of a design by name, in the units of its linkage's file."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from analytic.description.file_units import FileUnit, file_unit
from analytic.designs.figure_names import figures_named
from analytic.designs.figures import Figure
from analytic.kinematics.mechanism import Mechanism
from analytic.signals import unit


@dataclass(frozen=True)
class NamedFigure:
    """A figure of a design by its name, with the unit of the file."""

    name: str
    figure: Figure
    unit: FileUnit

    @property
    def shown(self) -> str:
        """The name with the unit, as tables are headed."""
        return f"{self.name} [{self.unit.name}]" if self.unit.name else self.name


def named_figures(mechanism: Mechanism, names: Iterable[str]) -> tuple[NamedFigure, ...]:
    """The figures of these names, each once, in their order; a family stands for all its members.

    Raises LinkproofError as ``analytic.designs.figure_names.figures_named``.
    """
    figures = {name: figure for typed in names for name, figure in figures_named(mechanism, typed).items()}
    linkage = mechanism.linkage
    return tuple(
        NamedFigure(name, figure, file_unit(unit(figure.signal, linkage), linkage)) for name, figure in figures.items()
    )
