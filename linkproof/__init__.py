"""Torque, power and bearing forces of planar linkages, and the errors of simulations of them: the public names.

Everything else is private and may change with any version. A name is imported when it is first used.
"""

from __future__ import annotations

import os.path
from importlib import import_module
from importlib.util import find_spec
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from importlib.metadata import version

    from analytic.description.linkage import Linkage
    from analytic.description.loading import load
    from analytic.errors import LinkproofError
    from reports.api.designer import check, evaluate, judge, mechanisms, new, optimise, results, sweep, tolerance
    from reports.api.options import Bounds, Motion, SteadyMotion
    from reports.api.trials import bench, check_engine, compare, engines, stress
    from reports.studies.trials import Comparison

    __version__ = version("linkproof")

__all__ = [
    "Bounds", "Comparison", "Linkage", "LinkproofError", "Motion", "SteadyMotion", "__version__", "bench", "check",
    "check_engine", "compare", "engine", "engines", "evaluate", "judge", "load", "mechanisms", "new", "optimise",
    "results", "stress", "sweep", "tolerance",
]  # fmt: skip

_MODULES = {
    "analytic.description.linkage": ("Linkage",),
    "analytic.description.loading": ("load",),
    "analytic.errors": ("LinkproofError",),
    "reports.studies.trials": ("Comparison",),
    "reports.api.trials": ("bench", "check_engine", "compare", "engines", "stress"),
    "reports.api.options": ("Bounds", "Motion", "SteadyMotion"),
    "reports.api.designer": (
        *("check", "evaluate", "judge", "mechanisms", "new", "optimise"),
        *("results", "sweep", "tolerance"),
    ),
}


def refuse_strangers() -> None:
    """Raise ImportError if a package of linkproof would be imported from elsewhere, or is missing.

    All four, analytic, engines, comparisons and reports, have common names.
    """
    home = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
    for name in ("analytic", "engines", "comparisons", "reports"):
        try:
            spec = find_spec(name)
        except ValueError:  # a module without a spec stands in its place
            spec = None
        place = os.path.dirname(spec.origin) if spec and spec.origin else ""
        if os.path.realpath(place) != os.path.realpath(os.path.join(home, name)):
            got = f"another one in '{place}'" if place else "none"
            cure = "rename that one, or take its folder out of sys.path"
            raise ImportError(f"expected linkproof's package '{name}' in '{home}', got {got}: {cure}", name=name)


def _scheme(linkage: Linkage) -> Any:  # noqa: ANN401 - a figure of matplotlib
    """The scheme that ``Linkage.plot`` returns, a figure of matplotlib; raises LinkproofError if it has a fault."""
    return import_module("reports.api.designer").check(linkage).plot()


def _public(name: str, value: Any) -> Any:  # noqa: ANN401 - of any name
    """The value of a public name, unchanged.

    Asked for ``Linkage`` or ``load``, it first sets ``Linkage.drawing`` to ``_scheme``, by which ``plot`` draws.
    """
    if name in ("Linkage", "load"):
        import_module("analytic.description.linkage").Linkage.drawing = staticmethod(_scheme)
    return value


if not TYPE_CHECKING:  # to whom every name would be there

    def __getattr__(name: str) -> object:
        """A public name, imported now; raises AttributeError for another one.

        Raises ImportError as ``refuse_strangers`` does, but not for ``__version__``.
        """
        if name == "__version__":
            return import_module("importlib.metadata").version("linkproof")
        if name == "engine":
            return import_module("linkproof.engine")
        refuse_strangers()
        for module, names in _MODULES.items():
            if name in names:
                return _public(name, getattr(import_module(module), name))
        raise AttributeError(f"module 'linkproof' has no attribute '{name}': it has {', '.join(__all__)}")


def __dir__() -> list[str]:
    """The names that ``dir`` and completion show: the public ones, as ``__all__`` itself."""
    return __all__
