"""Datasets as sweeps give them."""

import numpy as np
import xarray

FIGURES = {
    "Mkr.peak": "N*m",
    "joint_force:needle_bar on ground.peak": "N",
    "transmission_angle:rocker + rod (RRR).peak": "deg",
    "stroke": "mm",
    **{f"point:D:y@{n}": "mm" for n in range(7)},
}
PARAMETERS = ("rod.B.x", "links.coupler_upper.centre.y", "crank.mass")
CONDITIONS = "4000 rpm, sampled at 180 crank angles"
ABOUT = {"mechanism": "made-up", "variant": "as-printed", "conditions": f"made-up (as-printed): {CONDITIONS}"}


def sweep(*counts, figures=1, fails=0.0, table=False, change=lambda values: values):
    """A grid, or a table of as many designs; the upper share ``fails`` of the first parameter does not assemble."""
    names = PARAMETERS[: len(counts)]
    places = [np.linspace(10.0 * n + 170.0, 10.0 * n + 180.0, count) for n, count in enumerate(counts)]
    mesh = np.meshgrid(*places, indexing="ij")
    failing = mesh[0] > 180.0 - 10.0 * fails
    data = {}
    for number, (name, unit) in enumerate(list(FIGURES.items())[:figures]):
        values = change(sum((one - 173.0) ** 2 for one in mesh) * 10.0 ** (3 * number - 6) + 1e-7)
        values = np.where(failing, np.nan, values)
        data[name] = ("design" if table else names, values.ravel() if table else values, {"units": unit})
    columns = {
        name: ("design" if table else name, whole.ravel() if table else place, {"units": "mm"})
        for name, place, whole in zip(names, places, mesh, strict=True)
    }
    return xarray.Dataset(data, columns, ABOUT)
