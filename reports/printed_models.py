"""Printed models put to the engines: what every engine says of them, and the motions the models predict."""

from __future__ import annotations

from dataclasses import replace
from functools import lru_cache
from typing import Any

from analytic.free_motion import FreeMotion
from analytic.linkage import Erratum, OwnRegime
from analytic.loading import parse
from analytic.mechanism import Mechanism
from comparisons.case import own_motion
from reports.views import View


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


def printed_motion(view: View, erratum: Erratum) -> FreeMotion:
    """The crank's motion by a model as printed."""
    linkage = view.linkage
    variant = erratum.variant or linkage.variant
    own = next(own for own in linkage.regimes if own.name == erratum.regime)
    return _printed(view.text, linkage.name, variant, linkage.gravity, own, erratum.half_slope)


@lru_cache(maxsize=32)
def _printed(
    text: str, name: str, variant: str, gravity: tuple[float, float], own: OwnRegime, half_slope: str
) -> FreeMotion:
    linkage = replace(parse(text, name, name, variant), gravity=gravity)
    return own_motion(Mechanism(linkage), own, half_slope)
