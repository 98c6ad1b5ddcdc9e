"""Types of the public names, written by tests/linkproof/stub.py from the declared options."""

from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

import xarray
from numpy.typing import ArrayLike

from analytic.description.linkage import Linkage as Linkage
from analytic.description.loading import load as load
from analytic.errors import LinkproofError as LinkproofError
from linkproof import engine as engine
from reports.python.campaign import Comparison as Comparison
from reports.python.checking import JudgedResults
from reports.python.checking import check as check
from reports.python.checking import check_engine as check_engine
from reports.python.evaluation import evaluate as evaluate

__version__: str
Words = str | Iterable[str]
Range = str | float | tuple[float | None, float | None] | None

def refuse_strangers() -> None: ...
def compare(
    *mechanisms: str | Path,
    variant: str | None = ...,
    regime: Words = ...,
    speed: float | None = ...,
    ramp_time: float = ...,
    hold_time: float = ...,
    start_angle: float = ...,
    from_angle: float | None = ...,
    to_angle: float | None = ...,
    clockwise: bool = ...,
    gravity: bool = ...,
    engine: Words = ...,
    setting: Words = ...,
    quantity: Words = ...,
    full: bool = ...,
    limits: str | Path | None = ...,
    against: str | Path | None = ...,
    record: str | Path | None = ...,
    time_limit: float | None = ...,
    memory_limit: float | None = ...,
    jobs: int | None = ...,
    scheduler: str | None = ...,
) -> Comparison: ...
def judge(
    linkage: Linkage | str | Path,
    *results: str | Path,
    variant: str | None = ...,
    regime: Words = ...,
    speed: float | None = ...,
    ramp_time: float = ...,
    hold_time: float = ...,
    start_angle: float = ...,
    from_angle: float | None = ...,
    to_angle: float | None = ...,
    clockwise: bool = ...,
    gravity: bool = ...,
    mapping: str | Path | None = ...,
    limit: float = ...,
) -> JudgedResults: ...
def optimise(
    linkage: Linkage | str | Path,
    *,
    over: Mapping[str, Range],
    keep: Mapping[str, Range] | Sequence[str] = ...,
    step: str | float | None = ...,
    minimise: str | None = ...,
    maximise: str | None = ...,
    variant: str | None = ...,
    speed: float | None = ...,
    from_angle: float | None = ...,
    to_angle: float | None = ...,
    clockwise: bool = ...,
    gravity: bool = ...,
    scale_mass: bool = ...,
    everywhere: bool = ...,
) -> xarray.Dataset: ...
def results(
    linkage: Linkage | str | Path,
    *,
    variant: str | None = ...,
    regime: Words = ...,
    speed: float | None = ...,
    ramp_time: float = ...,
    hold_time: float = ...,
    start_angle: float = ...,
    from_angle: float | None = ...,
    to_angle: float | None = ...,
    clockwise: bool = ...,
    gravity: bool = ...,
    at: ArrayLike | None = ...,
    time: ArrayLike | None = ...,
) -> xarray.Dataset: ...
def sweep(
    linkage: Linkage | str | Path,
    vary: Mapping[str, Any] | None = ...,
    figures: Words = ...,
    *,
    table: object = ...,
    variant: str | None = ...,
    speed: float | None = ...,
    from_angle: float | None = ...,
    to_angle: float | None = ...,
    clockwise: bool = ...,
    gravity: bool = ...,
    scale_mass: bool = ...,
    refine: bool = ...,
) -> xarray.Dataset: ...
def tolerance(
    linkage: Linkage | str | Path,
    tolerances: Mapping[str, Any] | str | Path,
    results: Words | None = ...,
    *,
    variant: str | None = ...,
    speed: float | None = ...,
    from_angle: float | None = ...,
    to_angle: float | None = ...,
    clockwise: bool = ...,
    gravity: bool = ...,
    scale_mass: bool = ...,
    samples: int | None = ...,
) -> xarray.Dataset: ...
