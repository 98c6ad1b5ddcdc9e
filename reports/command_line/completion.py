"""Completion in a shell: names of mechanisms, engines, settings, regimes, quantities and stability maps."""

from __future__ import annotations

import contextlib
import os
import tomllib
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

from analytic.errors import LinkproofError
from analytic.files import read_file

if TYPE_CHECKING:
    from analytic.description.linkage import Linkage

CATALOGUE = Path(__file__).parents[2] / "analytic" / "catalogue"


def mechanisms(incomplete: str) -> list[str]:
    """The catalogue, and linkage files that lie where the words point."""
    files = Path().glob(f"{incomplete}*.toml") if incomplete and not Path(incomplete).is_absolute() else []
    return [*_completions(_files_by_name(), incomplete), *sorted(map(str, files))]


def variants(incomplete: str) -> list[str]:
    """The variants of the mechanisms on the command line."""
    named = [name for table in _linkage_tables() for name in (table.get("variant", "base"), *table.get("variants", {}))]
    return _completions(named, incomplete)


def regimes(incomplete: str) -> list[str]:
    """The motions that every linkage can be given, and those of the files on the command line."""
    from analytic.description.crank_motion import LAWS, REGIMES

    own = [name for table in _linkage_tables() for name in table.get("regimes", {})]
    return _completions([*REGIMES, *LAWS, *own, "own", "all"], incomplete)


def engines(incomplete: str) -> list[str]:
    """Every engine that has an adapter."""
    from engines.registry import engine_names

    return _completions(engine_names(), incomplete)


def settings(incomplete: str) -> list[str]:
    """The settings of an engine."""
    from engines.contract import Setting

    return _completions([*Setting, "all"], incomplete)


def quantities(incomplete: str) -> list[str]:
    """Everything that can be compared."""
    from comparisons.trials.judging.quantities import QUANTITIES

    return _completions(QUANTITIES, incomplete)


def parameters(incomplete: str) -> list[str]:
    """The numbers of the mechanism on the command line that designs may differ in."""
    from analytic.description.changes import SPEED
    from comparisons.designer.parameters import parameters as known

    return _completions([f"{name}=" for linkage in _linkages() for name in (*known(linkage), SPEED)], incomplete)


def figures(incomplete: str) -> list[str]:
    """The figures of a design of the mechanism on the command line."""
    from analytic.designs.figures import figure_names
    from analytic.kinematics.mechanism import Mechanism

    return _completions([name for linkage in _linkages() for name in figure_names(Mechanism(linkage))], incomplete)


def axes(incomplete: str) -> list[str]:
    """The stability maps."""
    from comparisons.trials.stress.cells import axes as known

    return _completions(known(), incomplete)


def _files_by_name() -> dict[str, Path]:
    """The files of the mechanisms that are known by name."""
    return {path.stem: path for path in CATALOGUE.rglob("*.toml")}


def _completions(names: Iterable[str], incomplete: str) -> list[str]:
    return sorted({str(name) for name in names if str(name).startswith(incomplete)})


def _linkages() -> Iterator[Linkage]:
    """The linkages among the words typed so far, as far as they can be read."""
    from analytic.description.loading import load

    known = _files_by_name()
    for word in _typed_words():
        if word in known or word.endswith(".toml"):
            with contextlib.suppress(LinkproofError):
                yield load(word)


def _typed_words() -> list[str]:
    return (os.environ.get("_TYPER_COMPLETE_ARGS") or os.environ.get("COMP_WORDS", "")).split()[2:]


def _linkage_tables() -> list[dict[str, Any]]:
    """The linkage files among the words typed so far, as far as they can be read."""
    tables, known = [], _files_by_name()
    for word in _typed_words():
        with contextlib.suppress(LinkproofError, ValueError, RecursionError):
            content = read_file(known.get(word, Path(word)), "a linkage file")
            tables.append(tomllib.loads(content.decode("utf-8-sig")))
    return tables
