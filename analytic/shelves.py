"""Linkages of other packages: each announces a folder of linkage files under the entry points ``linkproof.linkages``.

An entry's value names the folder as Python names a package, ``mill.linkages``; the package is not imported.
"""

from __future__ import annotations

from functools import cache
from importlib.metadata import EntryPoint, entry_points
from importlib.util import find_spec
from pathlib import Path

from analytic.errors import LinkproofError

GROUP = "linkproof.linkages"


@cache
def announced() -> dict[str, tuple[Path, str]]:
    """The announced linkages by name, sorted: each file, and the package that announces it.

    Raises LinkproofError where a folder does not exist or is empty, and where two packages have files of one name.
    """
    files: dict[str, tuple[Path, str]] = {}
    for entry in sorted(entry_points(group=GROUP), key=lambda entry: (_package_name(entry), entry.value)):
        package = _package_name(entry)
        for path in _linkage_files(entry, package):
            other, owner = files.setdefault(path.stem, (path, package))
            if other.resolve() != path.resolve():
                raise LinkproofError(
                    f"mechanism '{path.stem}': expected one package that announces it, got {owner} and {package}; "
                    "uninstall one of them, or have one rename its file"
                )
    return dict(sorted(files.items()))


def _package_name(entry: EntryPoint) -> str:
    return entry.dist.name if entry.dist else entry.name


def _linkage_files(entry: EntryPoint, package: str) -> list[Path]:
    """The linkage files of the folder that an entry point names; raises LinkproofError where there are none."""
    first, *below = entry.value.split(".")
    spec = find_spec(first)
    places = (spec.submodule_search_locations if spec else None) or ()
    paths = [path for place in places for path in sorted(Path(place, *below).glob("*.toml"))]
    if not paths:
        raise LinkproofError(
            f"{package}: expected linkage files in the folder '{entry.value}' that it announces under {GROUP}, got "
            "none; correct its entry point or uninstall it"
        )
    return paths
