"""Jeq split into parts is Jeq."""

import numpy as np
import pytest

from analytic.description.loading import load
from analytic.dynamics.reduced import reduced_inertia
from reports.charts import inertia
from reports.records.views import View, views
from tests.reports.made_up_results import made_up_results


def test_links_add_up_and_the_crank_alone_is_constant():
    view = View(None, load("rimoldi-164"))
    angle = np.linspace(0.0, 6.0, 13)
    parts = inertia.links_inertia(view, angle)
    np.testing.assert_allclose(sum(parts.values()), reduced_inertia(view.mechanism.sweep(angle)), rtol=1e-14)
    assert [name for name, values in parts.items() if not inertia.varies(values)] == ["crank"]
    assert next(iter(parts)) == "crank"


@pytest.mark.parametrize(("largest", "expected"), [(9.1e-5, (1e5, "10⁻⁵ ")), (3.0, (1.0, "")), (0.0, (1.0, ""))])
def test_axes_count_in_powers_of_ten(largest, expected):
    factor, prefix = inertia.power_for(largest)
    assert (pytest.approx(factor), prefix) == expected


def test_methods_show_the_closed_form_and_every_engine():
    (view,) = views(made_up_results(samples=201))
    upper, lower = inertia.methods_figure(view).axes
    assert [text.get_text() for text in upper.get_legend().get_texts()] == ["closed form", "alpha", "beta"]
    named = {text.get_text() for text in lower.texts}
    assert {"alpha naive", "alpha tuned", "alpha best", "limit 1e-5"} <= named
