"""What is written in blocks, in any order, is read as netCDF by SciPy and xarray."""

import random
import shutil
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.io import netcdf_file

from analytic.errors import LinkproofError
from comparisons.designs.parameters import parameter
from comparisons.designs.sweep import sweep as sweeps
from comparisons.designs.sweep.space import Grid, Listed
from comparisons.designs.sweep.sweep_file import SweepFile, saved_sweep
from tests.comparisons.designs.sweeps import GRID, SIX_BAR, grid, request

ABOUT = {"mechanism": "größe", "variant": "", "angles": 8}
LISTED = Listed((parameter(SIX_BAR, "rod.B.x"), parameter(SIX_BAR, "rod.mass")), np.arange(14.0).reshape(2, 7))


@pytest.mark.parametrize("size", [1, 4, 6, 7, 13, 100])
@pytest.mark.parametrize("space", [grid(*GRID), grid(GRID[0]), grid(GRID[1], GRID[2]), LISTED])
def test_a_file_written_in_blocks_is_read_by_others(tmp_path, monkeypatch, space, size):
    monkeypatch.setattr(sweeps, "PLACES", 8 * size)
    asked = request(space)
    file = SweepFile(tmp_path / "sweep.nc", asked, ABOUT)
    values = np.random.default_rng(1).normal(size=(3, space.count))
    values[:, ::3] = np.nan
    file.create()
    assert file.is_whole
    for first, last in random.Random(size).sample(list(asked.blocks), len(asked.blocks)):
        file.write(first, values[:, first:last])
    assert file.path.stat().st_size == file.size
    for first, last in asked.blocks:
        np.testing.assert_array_equal(file.read(first, last), values[:, first:last])
    with saved_sweep(file.path) as dataset:
        assert dataset.attrs == ABOUT
        for one, row in zip(asked.figures, values, strict=True):
            assert dataset[one.name].dims == space.dimensions
            assert dataset[one.name].attrs["units"] == one.unit.name
            np.testing.assert_array_equal(dataset[one.name].values.ravel(), row)
        shown = [row.reshape(space.shape) for row in space.shown(0, space.count)]
        for one, row in zip(space.parameters, shown, strict=True):
            assert one.name in dataset.coords
            np.testing.assert_array_equal(
                np.broadcast_to(dataset[one.name].broadcast_like(dataset["stroke"]).values, space.shape), row
            )
    with netcdf_file(file.path, mmap=False) as plain:
        np.testing.assert_array_equal(plain.variables["stroke"][:].ravel(), values[2])


def test_names_may_be_of_any_letters_and_have_blanks(tmp_path):
    columns = tuple(replace(one, name=f"forces.ü.{number} #2") for number, one in enumerate(LISTED.parameters))
    asked = request(Listed(columns, LISTED.values))
    asked = replace(asked, figures=(replace(asked.figures[0], name="joint_force:Ω on ground.peak"),))
    file = SweepFile(tmp_path / "sweep.nc", asked, ABOUT)
    file.create()
    file.write(0, np.ones((1, 7)))
    with saved_sweep(file.path) as dataset:
        assert list(dataset.data_vars) == ["joint_force:Ω on ground.peak"]
        assert sorted(dataset.coords) == ["forces.ü.0 #2", "forces.ü.1 #2"]
    plain = grid(GRID[0], GRID[1])
    named = tuple(replace(one, name=f"Ω{number}.x") for number, one in enumerate(plain.parameters))
    file = SweepFile(tmp_path / "grid.nc", replace(asked, space=Grid(named, plain.axes)), ABOUT)
    file.create()
    with saved_sweep(file.path) as dataset:
        assert dict(dataset.sizes) == {"Ω0.x": 5, "Ω1.x": 3}
        np.testing.assert_array_equal(dataset["Ω1.x"], plain.axes[1][np.arange(3)])


def test_more_designs_than_there_is_room_for_are_told(tmp_path, monkeypatch):
    asked = request(grid("rod.B.x=170:180:1000000", "rod.mass=1:2:10000"))
    file = SweepFile(tmp_path / "new" / "sweep.nc", asked, ABOUT)
    monkeypatch.setattr(shutil, "disk_usage", lambda _: SimpleNamespace(free=10**11))
    with pytest.raises(LinkproofError) as told:
        file.check()
    assert f"expected room for {10**10} designs, 240 GB, in '{tmp_path}', got 100 GB" in str(told.value)
    monkeypatch.setattr(shutil, "disk_usage", lambda _: SimpleNamespace(free=10**13))
    file.check()
    with pytest.raises(LinkproofError, match="which is what netCDF holds"):
        SweepFile(file.path, request(grid("rod.B.x=170:180:2", "rod.mass=1:2:600000000")), ABOUT).check()


def test_a_full_disk_is_told(tmp_path):
    with pytest.raises(LinkproofError, match="repeat with --resume"):
        SweepFile(tmp_path / "absent" / "sweep.nc", request(), ABOUT).write(0, np.zeros((3, 30)))
