"""The promised figure of the benchmark, measured by itself: what ``best`` saves against a newcomer's fixed steps."""

from __future__ import annotations

from collections.abc import Sequence

from comparisons.reference.case import Case
from comparisons.work_precision.analysis import by_engine
from comparisons.work_precision.points import Extent
from comparisons.work_precision.saving import Saving, saving
from comparisons.work_precision.study import Announce, BenchRequest, bench
from engines.contract import Setting
from engines.registry import engine
from engines.scene import Channel

# The plain steps are followed for as long as a point takes no more than ten seconds, or two refinements bring nothing.
PATIENT = Extent(tuple(12.0 * 2.0**k for k in range(16)), budget=10.0, repeats=3, patience=2.0)


def plain_savings(
    case: Case,
    engines: Sequence[str],
    wanted: float = 1e-6,
    *,
    quantity: str = "Mkr",
    extent: Extent = PATIENT,
    announce: Announce = lambda *_: None,
) -> dict[str, Saving]:
    """What each engine's ``best`` saves against its first method at an error, ``wanted`` of the quantity's peak.

    Engines that are not installed, or whose ``best`` misses the error, are left out. Takes seconds to a minute.
    """
    scene = case.scene([Channel.POSITION])
    installed = {name: engine(name) for name in engines}
    installed = {name: adapter for name, adapter in installed.items() if adapter.version() is not None}
    found = {}
    for name, adapter in installed.items():
        plain = adapter.methods(scene)[0].name
        request = BenchRequest((case,), (name,), (quantity,), (Setting.BEST,), (plain,), extent)
        for records in by_engine(bench(request, announce).records).values():
            told = saving(records, Setting.BEST.value, wanted)
            if told is not None:
                found[name] = told
    return found
