"""Every benchmark of the speed history does its work once, at a small size; nothing is timed."""

import importlib
import inspect
import itertools
import pkgutil

import numpy as np
import pytest

from tests.speed import benchmarks
from tests.speed.benchmarks import forward, reference


def _benchmarks():
    """Class, method and first parameters of each benchmark."""
    for found in pkgutil.iter_modules(benchmarks.__path__):
        module = importlib.import_module(f"{benchmarks.__name__}.{found.name}")
        for name, benchmark in inspect.getmembers(module, inspect.isclass):
            if benchmark.__module__ == module.__name__:
                methods = [method for method in vars(benchmark) if method.startswith("time_")]
                for method, parameter in itertools.product(methods, getattr(benchmark, "params", (None,))[:1]):
                    arguments = () if parameter is None else (parameter,)
                    yield pytest.param(benchmark, method, arguments, id=f"{name}.{method}")


@pytest.fixture(autouse=True)
def _small(monkeypatch):
    monkeypatch.setattr(forward, "DURATION", 0.2)
    for name, size in (("SWEEP", 100), ("DESIGNS", 4), ("ANGLES", 8)):
        monkeypatch.setattr(reference, name, size)


@pytest.mark.parametrize(("benchmark_class", "method", "arguments"), list(_benchmarks()))
def test_a_benchmark_runs_on_this_tree(benchmark_class, method, arguments):
    """Its result is finite; it is skipped only where a package is not installed."""
    benchmark = benchmark_class()
    try:
        getattr(benchmark, "setup", lambda *_: None)(*arguments)
    except NotImplementedError as reason:
        if "numba" not in str(reason) and "exudyn" not in str(reason):
            raise
        pytest.skip(str(reason))
    result = getattr(benchmark, method)(*arguments)
    values = list(result.values()) if isinstance(result, dict) else result if isinstance(result, list) else [result]
    assert values
    assert all(np.all(np.isfinite(numbers)) for numbers in values)
