"""What an engine's runs leave behind in their process: nothing that adds up."""

import gc
import sys
from itertools import pairwise
from pathlib import Path

import pytest

from analytic.description.crank_motion import crank_motion
from comparisons.motion.case import scene
from comparisons.trials.runs.workers import LocalPool
from engines.registry import engine, own_names
from engines.scene import Channel, Prescribed
from tests.analytic.linkages import mechanism
from tests.engines.closed_form import installed

FIRST, MORE, STEP = 40, 100, 2.5e-4
ALLOWED = 20_000  # bytes a run; what the interpreter and the allocator keep comes to less


def left_by(name):
    """Bytes that a run leaves resident, on average over MORE runs after the FIRST: the least of four such averages.

    What runs leave adds up in each; the allocator takes a new stretch of memory now and then, in some of them.
    """
    motion = crank_motion("run-up-quintic", ramp_time=0.002, hold_time=0.001)
    adapter, model = engine(name), scene(mechanism("juki-mf7923d"), Prescribed(motion), frozenset(Channel))
    method = adapter.methods(model)[:2][-1]
    sizes = []
    for count in (FIRST, MORE, MORE, MORE, MORE):
        for _ in range(count):
            assert adapter.run_method(model, method, STEP).history is not None
        gc.collect()
        sizes.append(int(Path("/proc/self/statm").read_text().split()[1]) * 4096)
    return min(after - before for before, after in pairwise(sizes)) / MORE


@pytest.mark.nightly
@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="reads /proc")
@pytest.mark.parametrize("name", own_names())
def test_a_process_does_not_grow_with_the_runs_it_has_made(name):
    installed(name)
    ((_, left),) = LocalPool(1).run(left_by, [(name,)])
    assert left < ALLOWED
