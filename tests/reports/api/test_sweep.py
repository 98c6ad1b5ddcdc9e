"""``linkproof.sweep`` gives what the command writes, from arrays of any kind."""

import numpy as np
import pytest
import xarray

import linkproof

da = pytest.importorskip("dask.array")

X, MASS = np.linspace(160.0, 180.0, 5), np.array([0.1, 0.15, 0.2])
FIGURES = ("Mkr.peak", "stroke")


def grid(**options):
    values = {"rod.B.x": X, "rod.mass": MASS}
    return linkproof.sweep(
        "rimoldi-164", {**values, **options}, FIGURES, motion=linkproof.SteadyMotion(speed=500)
    ).dataset


def test_tables_of_any_kind_list_designs():
    whole = grid()
    places = np.array([[2, 0], [4, 2], [0, 1], [3, 0]]).T
    columns = {"rod.B.x": X[places[0]], "rod.mass": MASS[places[1]]}
    truth = whole["Mkr.peak"].values[tuple(places)]
    tables = [
        columns,
        xarray.Dataset({name: ("design", values) for name, values in columns.items()}),
        {name: da.from_array(values, chunks=3) for name, values in columns.items()},
    ]
    for table in tables:
        found = linkproof.sweep(
            "rimoldi-164", None, FIGURES, motion=linkproof.SteadyMotion(speed=500), table=table
        ).dataset
        assert found["Mkr.peak"].dims == ("design",)
        np.testing.assert_allclose(found["Mkr.peak"], truth, rtol=1e-12)
        np.testing.assert_array_equal(found["rod.B.x"], columns["rod.B.x"])


def test_dask_arrays_are_computed_on_request():
    found = grid(**{"rod.B.x": da.from_array(X, chunks=2)})
    assert found["stroke"].chunks == ((2, 2, 1), (3,))
    xarray.testing.assert_allclose(found.compute(), grid(), rtol=1e-12)


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ({}, "got neither"),
        ({"vary": {"rod.B.x": X}, "table": {"rod.B.x": X}}, "got both"),
        ({"vary": {}}, "got neither"),
        ({"vary": {"rod.B.x": [[1.0]]}}, "rod.B.x: expected a flat list of finite numbers"),
        ({"table": {"rod.B.x": X, "rod.mass": MASS}}, "columns of one length"),
        ({"vary": {"rod.mass": np.linspace(1.0, 2.0, 4_000_000)}}, "with Dask arrays, whose chunks"),
    ],
)
def test_bad_input_is_a_sentence(arguments, words):
    with pytest.raises(linkproof.LinkproofError) as error:
        linkproof.sweep("rimoldi-164", **arguments)
    assert words in str(error.value)
