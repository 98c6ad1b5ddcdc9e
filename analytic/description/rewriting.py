"""A linkage file written anew with other numbers: another design of the linkage, in the units of its file.

The text stays as it was written, comments included, wherever nothing changes. The file's own values become those of the
variant chosen, and published figures and variants, which belong to the original design,
are left out.
"""

from __future__ import annotations

import math
import tomllib
from collections.abc import Callable, Mapping, MutableMapping, MutableSequence, Sequence
from dataclasses import replace
from typing import Any, Final, cast

from analytic.description import load_tables, loading
from analytic.description.changes import Place, named_numbers, with_numbers
from analytic.description.changes import numbers as numbers_of
from analytic.description.file_units import in_unit
from analytic.description.linkage import Linkage, LinkTorque, PointForce, RotaryDamper, Spring
from analytic.description.lookup import Reader, reader_of
from analytic.errors import LinkproofError, UnknownNameError, printable, shortened

DESIGN: Final = "design"
MARK: Final = "# Made by linkproof from "
NOT_OF_DESIGNS: Final = ("published",)
Load = PointForce | LinkTorque | Spring | RotaryDamper
LOADS: Final[Mapping[str, Callable[[Reader], Sequence[Load]]]] = {
    "forces": load_tables.forces,
    "torques": load_tables.torques,
    "springs": load_tables.springs,
    "dampers": load_tables.dampers,
}
ROUNDING: Final = 4 * 2.0**-52  # relative; what a number may lose on its way through the file's units and unit vectors
MOST_NAMED: Final = 12  # changed numbers in the first line


def with_variant_written(text: str, name: str, variant: str | None) -> str:
    """A linkage file's text with the numbers of a variant as its own values, defaults written in it too.

    Printed figures, which belong to the file as it was, are left out. Raises as ``rewritten`` does.
    """
    linkage = loading.parse(text, name, name, variant)
    raw, _, source = loading.document(text, name, name, variant)
    raw = {key: part for key, part in raw.items() if key not in NOT_OF_DESIGNS}
    file = WrittenNumbers(raw, reader_of(loading.validated(raw, source), source), linkage)
    for number, value in numbers_of(linkage).items():
        if not math.isfinite(value) or ".along." in number:
            continue
        file.set(number, value)
    result = _toml_text(text, raw)
    _check(result, name, linkage)
    return result


def written_numbers(text: str, name: str, variant: str | None) -> WrittenNumbers:
    """Where a file in a variant has its numbers, and in which units."""
    raw, _, source = loading.document(text, name, name, variant)
    return WrittenNumbers(
        raw, reader_of(loading.validated(raw, source), source), loading.parse(text, name, name, variant)
    )


def rewritten(
    text: str, name: str, variant: str | None, numbers: Mapping[str, float], *, new_variant: str = DESIGN
) -> str:
    """The text of a linkage file whose own values are those of a variant, with other numbers in place.

    Args:
        text: The file as it is.
        name: Its mechanism's name, for messages and for the first line of the new file, which says how it was made.
        variant: The variant to begin with, the file's own values if None.
        numbers: SI values by name, as in ``analytic.description.changes``; those not named stay. A component of a
            direction takes the other one with it, as it does in ``changed``.
        new_variant: What the new file calls its values, in the key ``variant``.

    Raises:
        UnknownNameError: For a number or a variant that the file does not have.
        LinkproofError: Where the numbers describe no linkage, or cannot be written in the units of the file.

    """
    old = loading.parse(text, name, name, variant)
    known = numbers_of(old)
    for number, value in numbers.items():
        if number not in known:
            raise UnknownNameError(f"parameter of '{name}'", number, known)
        if not math.isfinite(value):
            raise LinkproofError(f"{number}: expected a finite number, got {value:g}; correct it")
    changed = {number: value for number, value in numbers.items() if value != known[number]}
    try:
        target = with_numbers(old, changed)
    except ZeroDivisionError:
        raise LinkproofError(
            f"{', '.join(key for key in changed if '.along.' in key)}: expected a direction, got [0, 0]; give another"
        ) from None
    raw, _, source = loading.document(text, name, name, variant)
    raw = {"variant": new_variant} | {key: part for key, part in raw.items() if key not in NOT_OF_DESIGNS}
    raw["variant"] = new_variant
    file = WrittenNumbers(raw, reader_of(loading.validated(raw, source), source), old)
    sentences = [file.set(number, value) for number, value in changed.items()]
    if target.output and any(".along." in number for number in changed):
        raw["output"]["along"] = list(target.output.along)  # where it followed a guide, S stays what it was
    result = f"{_first_line(name, old.variant, sentences)}\n{_toml_text(text, raw)}"
    _check(result, name, target)
    return result


class WrittenNumbers:
    """A linkage file as nested dictionaries, in which numbers are set by name: ``places`` has keys and indices."""

    def __init__(self, raw: dict[str, Any], reader: Reader, linkage: Linkage) -> None:
        self.raw = raw
        self.units = reader.document.units.model_dump()
        self.scale = reader.scale
        numbers, indices = named_numbers(linkage), _indices_in_file(linkage, reader)
        self.places = {name: _place_in_file(number.place, indices, reader) for name, number in numbers.items()}
        self.kinds = {self.places[name]: number.kind for name, number in numbers.items()}
        self.values = {self.places[name]: number.value for name, number in numbers.items()}

    def set(self, number: str, value: float) -> str:
        """Put an SI value in its place; gives the number as the file has it, for a reader."""
        place = self.places[number]
        self.values[place] = value
        table: Any = self.raw
        for depth, key in enumerate(place[:-1], start=1):
            if isinstance(key, str):
                is_pair = place[depth:] in ((0,), (1,)) and place[0] not in LOADS
                if is_pair and (not isinstance(table.get(key), list) or self.kinds[place] == "direction"):
                    # left out, given by radius and angle, or of any length
                    table[key] = [self._written((*place[:depth], component)) for component in (0, 1)]
                table.setdefault(key, {})
            table = table[key]
        table[place[-1]] = self._written(place)
        return f"{number} = {table[place[-1]]!r} {self.units.get(self.kinds[place], '')}".rstrip()

    def _written(self, place: Place) -> float:
        """The number in the file's unit that gives the SI value."""
        return in_unit(self.values[place], self.scale.get(self.kinds[place], 1.0))


def _indices_in_file(linkage: Linkage, reader: Reader) -> dict[str, list[int]]:
    """For slots and each kind of load, the index in the file of each that a linkage has, in its order."""
    slots = {(table.point, table.on): number for number, table in enumerate(reader.document.slots)}
    order = {kind: _order_in_file(kind, reader) for kind in LOADS}
    return {"slots": [slots[slot.point, slot.guide.host] for slot in linkage.slots], **order}


def _place_in_file(place: Place, indices: Mapping[str, Sequence[int]], reader: Reader) -> Place:
    """The keys and indices in the file of a number, from its place in a linkage, whose loads are sorted."""
    kind, index, *rest = place
    if kind not in indices or not isinstance(index, int):
        return place
    index = indices[str(kind)][index]
    if kind in ("forces", "torques"):
        key, row, component = rest
        written = getattr(getattr(reader.document, kind)[index], str(key))
        rows = (row,) if isinstance(written, list) else ()
        rest = [key, *rows, *((component,) if kind == "forces" else ())]
    return (kind, index, *rest)


def _order_in_file(kind: str, reader: Reader) -> list[int]:
    """The indices of the file's loads of a kind, in the order in which a linkage has them."""
    placed = []
    for index, table in enumerate(getattr(reader.document, kind)):
        alone = replace(reader, document=reader.document.model_copy(update={kind: [table]}))
        placed += [(load_tables.sort_key(load), index) for load in LOADS[kind](alone)]
    return [index for _, index in sorted(placed)]


def _first_line(name: str, variant: str, sentences: list[str]) -> str:
    """The comment that says how the file was made: from which file, and which numbers were changed."""
    more = [f"{len(sentences) - MOST_NAMED} more numbers"] if len(sentences) > MOST_NAMED else []
    numbers = ", ".join([*sentences[:MOST_NAMED], *more]) or "no number changed"
    return f"{MARK}{printable(name)}, variant {shortened(printable(variant))}: {printable(numbers)}"


def _toml_text(text: str, raw: Mapping[str, Any]) -> str:
    """The file with the values ``raw``, its text changed as little as possible; written afresh where that fails."""
    import tomlkit  # noqa: PLC0415 - only what writes a file pays for it
    from tomlkit.exceptions import TOMLKitError  # noqa: PLC0415

    text = text.removeprefix(loading.BYTE_ORDER_MARK)
    if text.startswith(MARK):
        text = text.partition("\n")[2]
    try:
        document = tomlkit.parse(text)
        _update(document, raw)
        result = f"{tomlkit.dumps(document).rstrip()}\n"
        if tomllib.loads(result) == raw:
            return result
    except (TOMLKitError, tomllib.TOMLDecodeError):
        pass
    return tomlkit.dumps(raw)


def _update(old: Any, new: Any) -> None:  # noqa: ANN401 - TOML values
    """Give a table or a list of a parsed file other values, touching only what differs, so that comments stay."""
    if isinstance(old, MutableMapping):
        for key in [key for key in old if key not in new]:
            del old[key]
    pairs = new.items() if isinstance(old, MutableMapping) else enumerate(new)
    for key, value in pairs:
        inner = old.get(key) if isinstance(old, MutableMapping) else old[key]
        if inner == value:
            continue
        if _is_alike(inner, value):
            _update(inner, value)
        else:
            old[key] = value


def _is_alike(old: object, new: object) -> bool:
    if isinstance(old, MutableSequence):
        return isinstance(new, list) and len(old) == len(new)
    return isinstance(old, MutableMapping) and isinstance(new, dict)


def _check(result: str, name: str, target: Linkage) -> None:
    """Check every number of the new file against its intended value, to the rounding of the file's units."""
    new = loading.parse(result, name, f"{name} with other numbers")
    loads = {kind: tuple(sorted(getattr(target, kind), key=load_tables.sort_key)) for kind in LOADS}
    meant, got = numbers_of(replace(target, **cast("Any", loads))), numbers_of(new)
    for number in [*meant, *got]:
        if number not in got or number not in meant or not _is_near(number, got, meant):
            raise LinkproofError(
                f"{number}: expected a number that can be written in the units of '{name}', got "
                f"{meant.get(number, math.nan)!r}; correct it"
            )


def _is_near(number: str, got: Mapping[str, float], meant: Mapping[str, float]) -> bool:
    size = 1.0 if ".along." in number else max(abs(meant[number]), math.ulp(0.0))
    return abs(got[number] - meant[number]) <= ROUNDING * size
