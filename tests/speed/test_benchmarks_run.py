"""Every benchmark of the speed history does its work once, here, on the tree at hand; nothing is timed."""

import importlib
import inspect
import itertools
import pkgutil

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


@pytest.mark.parametrize(("benchmark_class", "method", "arguments"), list(_benchmarks()))
def test_a_benchmark_runs_on_this_tree(benchmark_class, method, arguments):
    one = benchmark_class()
    try:
        getattr(one, "setup", lambda *_: None)(*arguments)
    except NotImplementedError as missing:
        pytest.skip(str(missing))
    getattr(one, method)(*arguments)
