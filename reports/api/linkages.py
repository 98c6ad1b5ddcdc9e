"""A linkage however it is given: a name of the catalogue, a path, a loaded linkage, a mapping of the form of a file."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, TypeVar

from analytic.description.changes import without
from analytic.description.linkage import Linkage
from analytic.description.loading import LinkageFile, in_variant, read
from analytic.errors import LinkproofError, shortened
from reports.api.options import SteadyMotion

if TYPE_CHECKING:
    from reports.api.options import LinkageLike

Moved = TypeVar("Moved", bound=SteadyMotion)


def linkage_file(given: LinkageLike) -> LinkageFile:
    """The file of a linkage given by name, path, mapping or object; raises LinkproofError for one changed in Python.

    So too for anything else, and for a file that cannot be read.
    """
    if isinstance(given, Mapping):
        import tomlkit  # noqa: PLC0415 - files are read without it

        name = str(given.get("title", "linkage"))
        return LinkageFile(name, f"linkage '{name}'", tomlkit.dumps(given))
    if not isinstance(given, Linkage):
        if not isinstance(given, str | Path):
            raise LinkproofError(
                f"expected a linkage, its name or path, or a mapping of the form of its file, got "
                f"{shortened(repr(given))}; give one of them"
            )
        return read(given)
    file = LinkageFile(given.name, given.name, given.text)
    if file.linkage(given.variant) != given:
        raise LinkproofError(f"'{given.name}' differs from its file: write it to a file, and give that")
    return file


def load_linkage(given: LinkageLike, variant: str | None = None, *, gravity: bool = True) -> Linkage:
    """The linkage in a variant, its own by default, without gravity if that is switched off.

    Raises LinkproofError for one that cannot be read, and for an unknown variant.
    """
    if not isinstance(given, Linkage):
        result = linkage_file(given).linkage(variant)
    else:
        result = given if variant is None else in_variant(given, variant)
    return result if gravity else without(result, "gravity")


def word_of(given: LinkageLike) -> str:
    """The word by which a command names a linkage: the path or name as given, its own name, or a mapping's title."""
    if isinstance(given, Mapping):
        return str(given.get("title", "linkage"))
    return given.name if isinstance(given, Linkage) else str(given)


def resolve(given: LinkageLike, motion: Moved) -> tuple[Linkage, str, Moved]:
    """The linkage in the motion's variant and gravity, the word that names it, and the motion with that variant.

    Of a linkage given by name or path the motion is unchanged; else the variant is None for the first of the file.
    Raises as ``load_linkage``.
    """
    chosen = load_linkage(given, motion.variant, gravity=motion.gravity)
    if isinstance(given, str | Path):
        return chosen, str(given), motion
    variant = None if chosen.variant == chosen.variants[0] else chosen.variant
    return chosen, chosen.name, replace(motion, variant=variant)
