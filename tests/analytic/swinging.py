"""A double rocker, whose crank can only swing, as a user writes it."""

from analytic.description.loading import parse
from tests.analytic.linkages import file_text

# Its file as a template for ``str.format``: the direction of the output is left open.
DOUBLE_ROCKER = (
    file_text("swung-double-rocker").replace("{", "{{").replace("}", "}}").replace("[1, 0] }}", "[{0}, {1}] }}")
)


def double_rocker_text(along=(1.0, 0.0), regimes=""):
    """Its file; the crank reaches -74.4° to 74.4°."""
    return DOUBLE_ROCKER.format(*along) + regimes


def double_rocker(along=(1.0, 0.0), regimes=""):
    """The linkage."""
    return parse(double_rocker_text(along, regimes), "double-rocker", "double-rocker.toml", None)
