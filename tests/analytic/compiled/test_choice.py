"""Which path is taken, and where the kernels' machine code lies: NumPy serves wherever the kernels do not pay."""

import math
import os
import shutil
import sys
from pathlib import Path

import pytest

import analytic
from analytic import compiled
from analytic.compiled import choice
from analytic.compiled import kernels as kernels_package
from analytic.errors import LinkproofError, UnknownNameError
from analytic.evaluation import evaluate
from analytic.motion.released import free_motion
from tests.analytic.linkages import mechanism

CODE = f"py{sys.version_info.major}{sys.version_info.minor}.nbi"
ROOT = Path(analytic.__file__).parents[1]


def _forget_kernels(monkeypatch):
    for name in [name for name in sys.modules if name.startswith("analytic.compiled.kernels.")]:
        monkeypatch.delitem(sys.modules, name)
        monkeypatch.delattr(kernels_package, name.rpartition(".")[2], raising=False)


@pytest.fixture
def without_numba(monkeypatch):
    """Numba not installed, and none of its kernels in memory."""
    _forget_kernels(monkeypatch)
    monkeypatch.setitem(sys.modules, "numba", None)


@pytest.mark.usefixtures("without_numba")
def test_without_numba_numpy_serves_and_the_cure_is_named():
    sample = mechanism("juki-mf7923d")
    assert not choice.is_installed()
    assert not choice.is_compiled("auto", "evaluation", 1e9)
    assert free_motion(sample, duration=0.01).path == "numpy"
    for compute in (
        lambda: evaluate(sample, 0.3, ["Jeq"], path="compiled"),
        lambda: free_motion(sample, duration=0.01, path="compiled"),
    ):
        with pytest.raises(LinkproofError, match=r"pip install 'linkproof\[compiled\]'"):
            compute()


def test_an_error_inside_is_not_taken_for_an_absent_numba(monkeypatch):
    class Broken:
        def find_spec(self, wanted, path=None, target=None):
            if wanted == "numba":
                raise ModuleNotFoundError("No module named 'slip_of_the_pen'", name="slip_of_the_pen")

    _forget_kernels(monkeypatch)
    for name in [name for name in sys.modules if name == "numba" or name.startswith("numba.")]:
        monkeypatch.delitem(sys.modules, name)
    monkeypatch.setattr(sys, "meta_path", [Broken(), *sys.meta_path])
    with pytest.raises(ModuleNotFoundError, match="slip_of_the_pen"):
        choice.kernels("evaluation")


@pytest.mark.parametrize(
    ("state", "cost"),
    [
        ({"loaded", "kept", "installed", "folder"}, choice.CALLING),
        ({"kept", "installed", "folder"}, choice.LOADING),
        ({"installed", "folder"}, choice.COMPILING),
        ({"installed"}, math.inf),
        ({"folder"}, math.inf),
    ],
)
def test_the_compiled_path_is_taken_where_it_pays(monkeypatch, state, cost):
    for name in ("loaded", "kept"):
        monkeypatch.setattr(choice, f"is_{name}", lambda _, name=name: name in state)
    monkeypatch.setattr(choice, "is_installed", lambda: "installed" in state)
    monkeypatch.setattr(choice, "folder", lambda: Path() if "folder" in state else None)
    assert choice.cost_of_start("evaluation") == cost
    assert choice.is_compiled("auto", "evaluation", min(cost, 1e9)) is (cost < math.inf)
    assert not choice.is_compiled("auto", "evaluation", 0.99 * min(cost, 1e9))
    assert choice.is_compiled("compiled", "evaluation", 0.0)
    assert not choice.is_compiled("numpy", "evaluation", 1e9)


def test_an_unknown_path_is_named():
    sample = mechanism("juki-mf7923d")
    with pytest.raises(UnknownNameError, match="path 'numby': did you mean 'numpy'"):
        evaluate(sample, 0.3, ["Jeq"], path="numby")
    with pytest.raises(UnknownNameError, match="did you mean 'compiled'"):
        free_motion(sample, duration=1.0, path="compile")


def test_used_kernels_are_loaded():
    pytest.importorskip("numba")
    evaluate(mechanism("juki-mf7923d"), 0.3, ["Jeq"], path="compiled")
    assert choice.is_loaded("evaluation")


@pytest.mark.parametrize("kernels", choice.ENTRIES)
def test_machine_code_older_than_its_sources_is_none(monkeypatch, tmp_path, kernels):
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path))
    assert not choice.is_kept(kernels)
    code = choice.folder() / f"{kernels}.{choice.ENTRIES[kernels]}-1.{CODE}"
    code.parent.mkdir()
    code.touch()
    assert choice.is_kept(kernels)
    os.utime(code, (0, 0))
    assert not choice.is_kept(kernels)


def test_machine_code_is_kept_where_numba_keeps_it(monkeypatch, tmp_path):
    caching = pytest.importorskip("numba.core.caching")
    source = Path(compiled.__file__).parent / "kernels" / "evaluation.py"
    ours = list(choice._folders())
    theirs = [caching.InTreeCacheLocator(_locate, str(source)), caching.UserWideCacheLocator(_locate, str(source))]
    assert [Path(locator.get_cache_path()) for locator in theirs] == ours[-2:]
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path))
    monkeypatch.setattr(caching.config, "CACHE_DIR", str(tmp_path))
    given = caching.UserProvidedCacheLocator(_locate, str(source)).get_cache_path()
    assert choice.folder() == Path(given)


def _locate():
    """A function for numba's locators."""


def test_a_change_of_any_formula_or_kernel_counts(tmp_path):
    jit = pytest.importorskip("analytic.compiled.kernels.jit", exc_type=ModuleNotFoundError)
    assert jit.checksum(choice.sources()) == jit.SOURCES
    names = {path.relative_to(ROOT / "analytic").as_posix() for path in choice.sources()}
    assert {"kinematics/dyads/rrr.py", "kinematics/frames.py", "dynamics/link_sums.py"} <= names
    assert {"kinematics/transmission.py", "dynamics/force_formulas.py", "compiled/kernels/statics.py"} <= names
    copies = [Path(shutil.copy(path, tmp_path / f"{at}.py")) for at, path in enumerate(choice.sources())]
    for path in copies:
        before = jit.checksum(copies)
        path.write_bytes(path.read_bytes() + b"\n")
        assert jit.checksum(copies) != before


def test_no_two_kernels_have_one_name():
    """What processes have kept is told apart by name alone where another loads it."""
    dispatcher = pytest.importorskip("numba.core.dispatcher").Dispatcher
    modules = [choice.kernels(path.stem) for path in Path(kernels_package.__file__).parent.glob("[!_]*.py")]
    todo, known = [thing for module in modules for thing in vars(module).values()], {}
    while todo:
        thing = todo.pop()
        if isinstance(thing, dispatcher):
            function = thing.py_func
            assert known.setdefault((function.__module__, function.__qualname__), function) is function
            todo += [cell.cell_contents for cell in function.__closure__ or ()]
    assert len(known) > 100


def test_a_folder_that_cannot_be_made_is_not_numbas_choice(monkeypatch, tmp_path):
    in_the_way = tmp_path / "file"
    in_the_way.touch()
    monkeypatch.setattr(choice, "_folders", lambda: iter([in_the_way / "caches", tmp_path / "made" / "later"]))
    assert choice.folder() == tmp_path / "made" / "later"
    monkeypatch.setattr(choice, "_folders", lambda: iter([in_the_way / "caches"]))
    assert choice.folder() is None
    assert not choice.is_kept("evaluation")


def test_where_nothing_can_be_kept_numpy_serves_and_kernels_compile_on_request(monkeypatch):
    caching = pytest.importorskip("numba.core.caching")
    jit = choice.kernels("jit")
    monkeypatch.setattr(choice, "folder", lambda: None)
    monkeypatch.setattr(choice, "is_loaded", lambda _: False)
    monkeypatch.setattr(caching.CacheImpl, "_locator_classes", [])
    assert free_motion(mechanism("slotted-takeup"), start_speed=100.0, duration=0.05).path == "numpy"
    assert not choice.is_compiled("auto", "integration", 1e9)
    twice = jit.entry(lambda number: 2.0 * number)
    assert twice(2.0) == 4.0
