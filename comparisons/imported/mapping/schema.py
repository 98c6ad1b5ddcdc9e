"""The mapping file as a validated document (TOML)."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from analytic.description.schema import Finite, Tables, TomlTable

Sign = Literal[1, -1]
Text = Annotated[str, Field(min_length=1)]


class MappedColumn(TomlTable):
    """A column by its ``header``, where that does not tell it by its ``file`` and the number of its ``table`` there.

    What it is: a ``signal`` in a ``unit``; what its header says where they are left out. What is agreed to:
    ``sign * factor * value + offset`` (in the column's unit) at the file's time + ``time_shift`` (s).
    """

    header: Text
    file: Text | None = None
    table: Annotated[int, Field(ge=1, strict=True)] | None = None
    signal: Text | None = None
    unit: Text | None = None
    sign: Sign = 1
    factor: Annotated[float, Field(gt=0.0, allow_inf_nan=False, strict=True)] = 1.0
    time_shift: Finite = 0.0
    offset: Finite = 0.0


class MappingDocument(TomlTable):
    """A whole mapping: the ``axis`` where a file has both, headers to ``ignore``, and the columns."""

    axis: Literal["time", "phi"] | None = None
    ignore: list[Text] = Field(default_factory=list)
    column: Tables[MappedColumn] = Field(default_factory=list)
