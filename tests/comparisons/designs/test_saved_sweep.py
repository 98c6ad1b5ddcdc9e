"""A sweep that is killed and resumed leaves the figures of one that was not, and a file that xarray opens."""

import shutil
import subprocess
import sys
from types import SimpleNamespace

import numpy as np
import pytest
import xarray

from analytic.errors import LinkproofError
from comparisons.designs import sweep as sweeps
from comparisons.designs.parameters import parameter
from comparisons.designs.saved_sweep import SavedSweep
from comparisons.designs.space import Listed
from comparisons.designs.sweep import sweep
from comparisons.runs.study import Journal
from tests.comparisons.designs.sweeps import GRID, SIX_BAR, grid, request

# Runs one sweep after the other, each killed at the next call that touches a file, until one ends by itself.
KILLED = """
import os, signal, sys
from pathlib import Path
from comparisons.designs import sweep as sweeps
from comparisons.designs.saved_sweep import SavedSweep
from comparisons.runs.study import Journal
from tests.comparisons.designs.sweeps import request
sweeps.PLACES = 8 * 7
folder, wanted, kills = Path(sys.argv[1]), request(), 0
def work(folder):
    saved = SavedSweep(wanted, folder, {})
    sweeps.sweep(wanted, keep=saved.keep, done=saved.begin(Journal(folder, "linkproof sweep")))
    saved.finish(keeps=True)
work(folder.with_name("first"))  # from here on nothing is imported
while True:
    child = os.fork()
    if not child:
        left = kills % int(sys.argv[2]) + 1
        def count(event, _):
            global left
            if event in ("open", "os.rename", "os.remove", "os.mkdir", "os.rmdir", "os.truncate", "os.chmod"):
                left -= 1
                if not left:
                    os.kill(os.getpid(), signal.SIGKILL)
        sys.addaudithook(count)
        work(folder)
        os._exit(0)
    if os.waitpid(child, 0)[1] == 0:
        break
    kills += 1
print(kills)
"""
LISTED = Listed((parameter(SIX_BAR, "rod.B.x"), parameter(SIX_BAR, "rod.mass")), tuple(np.arange(14.0).reshape(2, 7)))


def made(folder):
    """The dataset of an uninterrupted sweep."""
    saved = SavedSweep(request(), folder, {})
    assert saved.begin(Journal(folder, "linkproof sweep")) == set()
    sweep(saved.request, keep=saved.keep)
    saved.finish(keeps=True)
    assert [path.name for path in folder.iterdir()] == ["sweep.nc"]
    return xarray.load_dataset(folder / "sweep.nc")


@pytest.mark.nightly
@pytest.mark.skipif(sys.platform == "win32", reason="forks")
def test_a_sweep_killed_again_and_again_leaves_the_same_figures(tmp_path, monkeypatch):
    monkeypatch.setattr(sweeps, "PLACES", 8 * 7)
    command = [sys.executable, "-c", KILLED, str(tmp_path / "killed"), "400"]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    assert int(done.stdout) > 10
    xarray.testing.assert_identical(xarray.load_dataset(tmp_path / "killed" / "sweep.nc"), made(tmp_path / "whole"))
    assert [path.name for path in (tmp_path / "killed").iterdir()] == ["sweep.nc"]


@pytest.mark.parametrize(("size", "space"), [(7, grid(*GRID)), (1, grid(GRID[0])), (3, LISTED)])
def test_blocks_written_in_any_order_are_read_by_others(tmp_path, monkeypatch, size, space):
    monkeypatch.setattr(sweeps, "PLACES", 8 * size)
    about = {"mechanism": "größe", "variant": "", "angles": 8}
    saved = SavedSweep(request(space), tmp_path, about)
    values = np.random.default_rng(1).normal(size=(3, space.count))
    values[:, ::3] = np.nan
    saved.begin(Journal(tmp_path, "linkproof sweep"))
    for number in np.random.default_rng(size).permutation(len(saved.request.blocks)).tolist():
        saved.keep(number, values[:, slice(*saved.request.block(number))])
        np.testing.assert_array_equal(saved.read(number), values[:, slice(*saved.request.block(number))])
    saved.finish(keeps=True)
    with xarray.open_dataset(tmp_path / "sweep.nc") as dataset:
        assert dataset.attrs == about
        for one, row in zip(saved.request.figures, values, strict=True):
            assert (dataset[one.name].dims, dataset[one.name].attrs) == (space.dimensions, {"units": one.unit.name})
            np.testing.assert_array_equal(dataset[one.name].values.ravel(), row)
        for one, column in zip(space.parameters, space.columns, strict=True):
            assert one.name in dataset.coords
            assert dataset[one.name].attrs == {"units": one.unit.name}
            np.testing.assert_array_equal(dataset[one.name].values, column)


def test_unfinished_work_of_another_command_or_request_is_left_alone(tmp_path):
    saved = SavedSweep(request(), tmp_path / "two", {"command": "linkproof sweep two"})
    saved.begin(Journal(tmp_path / "two", "linkproof sweep one"))
    saved.keep(0, np.zeros((3, 30)))
    saved.check()
    with pytest.raises(LinkproofError, match="expected the request that was begun"):
        SavedSweep(request(), tmp_path / "two", {}).begin(Journal(tmp_path / "two", "linkproof sweep two"))
    Journal(tmp_path, "linkproof compare juki-mf7923d").keep("run", {})
    saved = SavedSweep(request(), tmp_path, {"command": "linkproof sweep rimoldi-164"})
    with pytest.raises(LinkproofError, match="unfinished work of `linkproof compare juki-mf7923d`"):
        saved.check()


def test_what_is_forgotten_leaves_nothing(tmp_path):
    for folder in (tmp_path / "new", tmp_path):
        saved = SavedSweep(request(), folder, {})
        saved.begin(Journal(folder, "linkproof sweep"))
        saved.forget()
    assert list(tmp_path.iterdir()) == []


@pytest.mark.skipif(not shutil.os.path.exists("/dev/full"), reason="no /dev/full")
def test_a_full_disk_is_a_sentence(tmp_path, monkeypatch):
    monkeypatch.setattr(shutil, "disk_usage", lambda _: SimpleNamespace(free=100))
    saved = SavedSweep(request(), tmp_path / "out", {"command": "linkproof sweep"})
    with pytest.raises(LinkproofError, match="expected room for 30 designs"):
        saved.check()
    saved.begin(Journal(tmp_path / "out", "linkproof sweep"))
    saved._path.parent.mkdir(parents=True)
    saved._path.symlink_to("/dev/full")
    with pytest.raises(LinkproofError, match="No space left on device; finished designs are saved"):
        saved.keep(0, np.zeros((3, 30)))
