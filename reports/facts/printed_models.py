"""Printed models put to the engines: what every engine says of them, and the motions the models predict."""

from __future__ import annotations

from functools import lru_cache
from typing import Any

from analytic.description.schema import Erratum
from comparisons.campaign.results import described
from comparisons.reference.case import Spin
from comparisons.reference.printed_models import printed_motion as by_erratum
from reports.records.views import View


def judgements(view: View) -> list[dict[str, Any]]:
    """What the engines said of this mechanism's printed models: fields of ``ErratumRecord``, and ``sentence``."""
    if view.linkage.variant != view.linkage.variants[0]:
        return []  # printed models are held against the file's own values
    every = view.results.document.get("errata", [])
    return [row for row in every if row["mechanism"] == view.linkage.name]


def judged(view: View) -> list[Erratum]:
    """The printed models that some engine was asked about."""
    asked = {row["erratum"] for row in judgements(view)}
    return [erratum for erratum in view.linkage.errata if erratum.name in asked]


def printed_motion(view: View, erratum: Erratum) -> Spin:
    """The crank's motion by a model as printed, of the description that the campaign was run with."""
    return _printed(view.linkage.text, view.linkage.name, view.linkage.gravity, erratum)


@lru_cache(maxsize=32)
def _printed(text: str, name: str, gravity: tuple[float, float], erratum: Erratum) -> Spin:
    """A variant is taken from the text, so that nothing is looked up that has changed since the campaign."""
    return by_erratum(described(text, name, None, gravity), erratum)
