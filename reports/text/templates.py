"""The page templates: one environment for all pages and sections; everything that is not markup is escaped."""

from __future__ import annotations

from functools import cache
from pathlib import Path

import jinja2
from markupsafe import Markup

from reports.text import numbers

FOLDER = Path(__file__).parents[1] / "templates"


def render(template: str, **values: object) -> Markup:
    """A template of ``reports/templates``, filled in."""
    return Markup(_environment().get_template(template).render(**values))


@cache
def _environment() -> jinja2.Environment:
    environment = jinja2.Environment(
        loader=jinja2.FileSystemLoader(FOLDER),
        autoescape=True,
        undefined=jinja2.StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
    )
    filters = (numbers.figure, numbers.bound, numbers.printed, numbers.error, numbers.per_cent, plain, worded)
    environment.filters.update({one.__name__: one for one in filters})
    return environment


def plain(name: str) -> str:
    """A name for a reader: "joint_force" is "joint force"."""
    return name.replace("_", " ")


def worded(quantity: str) -> str:
    """A quantity's name for a reader: "Jeq:needle_bar.mean" is "Jeq of needle bar, mean"."""
    return plain(quantity.replace(":", " of ").replace(".", ", "))
