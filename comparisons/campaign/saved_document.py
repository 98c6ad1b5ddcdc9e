"""The form of a campaign's saved document, by which it is checked when it is read back."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any, Final, NotRequired

from pydantic import Field, TypeAdapter
from typing_extensions import TypedDict

from comparisons.campaign.errata import ErratumRecord
from comparisons.campaign.key_figures import KeyFigure
from engines.contract import ReadOut


class MotionRow(TypedDict):
    """A crank motion: its pieces from one instant to another, s, each a polynomial of the angle, rad."""

    regime: str
    segments: Annotated[list[tuple[float, float, Annotated[list[float], Field(min_length=1)]]], Field(min_length=1)]


class LimitData(TypedDict):
    """A row of the table of limits, as its file has it."""

    quantities: list[str]
    settings: list[str]
    regimes: list[str]
    mechanisms: list[str]
    value: float
    reason: str


class DescriptionRow(TypedDict):
    """A linkage as it was described, under a gravity, m/s²."""

    name: str
    variant: str
    gravity: tuple[float, float]
    text: str
    checksum: str


class SavedCampaign(TypedDict):
    """All but the runs."""

    command: str
    conditions: str
    environment: Mapping[str, str]
    errata: list[ErratumRecord]
    readouts: Mapping[str, Mapping[str, ReadOut]]  # by engine and channel
    motions: list[MotionRow]
    descriptions: list[DescriptionRow]
    limits: NotRequired[list[LimitData]]
    figures: NotRequired[list[KeyFigure]]
    notes: NotRequired[list[str]]
    departures: NotRequired[list[str]]
    judgement: NotRequired[list[str]]


FORM: Final[TypeAdapter[Any]] = TypeAdapter(SavedCampaign)
