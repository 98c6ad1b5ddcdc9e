"""What a benchmark ran on and how it was measured, in words."""

from __future__ import annotations

from collections.abc import Iterator

from comparisons.work_precision.records import Bench
from reports.facts.environment import environment_facts
from reports.text.numbers import seconds
from reports.work_precision.words import noise_share


def facts(bench: Bench) -> list[tuple[str, str]]:
    """Name and value of everything that decides a figure or a time."""
    return [
        ("Command", bench.document["command"]),
        ("Conditions", bench.document["conditions"]),
        *environment_facts(bench.document["environment"]),
        ("Points", f"{len(bench.points)}, timed {sum(len(point.repeats) for point in bench.points)} times in all"),
        ("First use", _first_use(bench)),
    ]


def _first_use(bench: Bench) -> str:
    """What an engine's import costs, once for each process."""
    told = [f"{one['engine']} {seconds(min(one['seconds']))}" for one in bench.document["first_use"] if one["seconds"]]
    return (
        f"{', '.join(told) or 'not measured'}: what the first run of a process costs beyond the second, import included"
    )


def note(bench: Bench) -> str:
    """How the times were measured, in small print."""
    noise = bench.noise
    return (
        f"Times are the shortest of up to {bench.document['extent']['repeats']} repeats, all points in turn, one run "
        f"at a time. A fixed piece of work beside every run took {seconds(noise.least)} at best, "
        f"{100.0 * noise.median_excess:.0f} % longer in the median and up to {100.0 * noise.spread:.0f} % longer in "
        "nine cases of ten: that is the machine's noise."
    )


def measured(bench: Bench) -> Iterator[str]:
    """How it was measured, a sentence to a line."""
    extent, noise = bench.document["extent"], bench.noise
    yield (
        "Every run is made by one worker process, one at a time; an engine that aborts or hangs costs its own point. "
        "Before its first run on a mechanism an engine makes one that is thrown away."
    )
    yield (
        "A first round goes down all sweeps at once, coarse steps first, until two refinements in a row improve "
        f"nothing or the next point would take longer than {extent['budget']:g} s; rounds after it repeat all points "
        f"in turn, up to {extent['repeats']} times, fewer for points that have taken {extent['patience']:g} s in all. "
        "Every repeat is kept in the records; times shown are the shortest."
    )
    yield (
        "Stepping alone is timed, as the adapter reports it, recording what the quantities need; set-up and read-out "
        "(all else of the call) stand beside it at every point, and what an engine's first use costs is given above."
    )
    yield (
        f"The machine's noise: {bench.document['noise']['work']}, beside each of {len(noise.samples)} runs, took "
        f"{seconds(noise.least)} at best, {100.0 * noise.median_excess:.0f} % longer in the median, up to "
        f"{100.0 * noise.spread:.0f} % longer in nine cases of ten. Settings within "
        f"{100.0 * noise_share(bench):.0f} % of the front are said to be on it."
    )
    yield (
        "Steps a turn are those of a turn at the crank's peak speed; a method exact at every instant only takes "
        "its samples there, and is the cheaper the fewer it takes. Errors are over the peak of the closed form over "
        "the run; samples at jumps of the acceleration are left out, and Jeq near standstill."
    )
    yield (
        "The observed order is the slope of the longest steady stretch above the floor, none where fewer than three "
        "points share one. The price of an error between two measured steps is read on logarithmic scales."
    )
