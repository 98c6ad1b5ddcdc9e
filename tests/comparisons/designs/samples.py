"""Samples of designs that are but names and numbers, and records of them."""

from dataclasses import replace
from types import SimpleNamespace

from analytic.description.loading import load
from comparisons.designs.parameters import parameter
from comparisons.designs.trust.sample import DesignSample, SampledDesign
from comparisons.judging.records import Record

RIMOLDI = load("rimoldi-164")
NAMES = ("rod.B.x", "rod.mass")


def made_up(values, transmission=()):
    """A sample of these values, numbered from 1, with linkages that are but names."""
    parameters = tuple(parameter(RIMOLDI, name) for name in NAMES[: values.shape[1]])
    angles = transmission or [50.0] * len(values)
    designs = [
        SampledDesign(number, SimpleNamespace(name="r", variant=str(number)), tuple(row), angle)
        for number, (row, angle) in enumerate(zip(values.tolist(), angles, strict=True), start=1)
    ]
    return DesignSample(parameters, tuple(designs), 0)


def record(design, outcome, error=None, quantity="Mkr"):
    found = Record("r", str(design), "run-up", "", "e", "1", "tuned", quantity, error_max=error, limit=1e-3)
    return replace(found, outcome=outcome.value, detail=outcome.value)
