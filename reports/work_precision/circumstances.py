"""What a benchmark ran on and how it was measured, in words."""

from __future__ import annotations

from comparisons.work_precision.records import Bench
from reports.facts.environment import environment_facts
from reports.text.numbers import seconds
from reports.text.templates import lines, sentence
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
    return sentence("machine_noise", noise=bench.noise, repeats=bench.document["extent"]["repeats"])


def measured(bench: Bench) -> list[str]:
    """How it was measured, a line to a subject."""
    extent, work = bench.document["extent"], bench.document["noise"]["work"]
    return lines("measurement", extent=extent, noise=bench.noise, work=work, share=noise_share(bench))
