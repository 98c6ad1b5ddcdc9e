"""Every benchmark of the speed history does its work once, here, on the tree at hand; nothing is timed."""

import importlib
import inspect
import itertools
import pkgutil

import numpy as np
import pytest

from tests.speed import benchmarks


def _benchmarks():
    """Class, method and first parameters of each benchmark."""
    for found in pkgutil.iter_modules(benchmarks.__path__):
        module = importlib.import_module(f"{benchmarks.__name__}.{found.name}")
        for name, benchmark in inspect.getmembers(module, inspect.isclass):
            if benchmark.__module__ == module.__name__:
                methods = [method for method in vars(benchmark) if method.startswith("time_")]
                for method, parameter in itertools.product(methods, getattr(benchmark, "params", (None,))):
                    arguments = () if parameter is None else (parameter,)
                    yield pytest.param(benchmark, method, arguments, id=f"{name}.{method}-{parameter}")


def _numbers(result):
    """The arrays and numbers in what a benchmark returns."""
    if isinstance(result, dict):
        return list(result.values())
    return result if isinstance(result, list) else [result]


@pytest.mark.parametrize(("benchmark_class", "method", "arguments"), list(_benchmarks()))
def test_a_benchmark_runs_on_this_tree(benchmark_class, method, arguments):
    """What it did is done, and done right: nothing is skipped for a module of ours, and no number is undefined."""
    benchmark = benchmark_class()
    try:
        getattr(benchmark, "setup", lambda *_: None)(*arguments)
    except NotImplementedError as reason:
        missing = str(reason)
        if "numba" not in missing and "is not installed" not in missing:
            raise
        pytest.skip(missing)
    result = getattr(benchmark, method)(*arguments)
    assert result is not None
    assert all(np.all(np.isfinite(numbers)) for numbers in _numbers(result))
