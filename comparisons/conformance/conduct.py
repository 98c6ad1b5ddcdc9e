"""Checks of how an adapter behaves: what it says of itself, what it refuses and how, what it leaves behind."""

from __future__ import annotations

import os
import sys
import tempfile
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager, suppress
from dataclasses import replace
from functools import partial
from typing import Final, get_args

import numpy as np

from comparisons.conformance.channels import completed, finished, obstacle, parts
from comparisons.conformance.findings import Check, NotApplicableError
from comparisons.conformance.mutants import own_run, tuned_run
from comparisons.conformance.samples import PLAIN, SAMPLES, case
from comparisons.runs.failures import AdapterError, blamed_on
from engines.contract import Abilities, Engine, History, Origin, Outcome, ReadOut, Run, Setting
from engines.installed import flush
from engines.mechanics.start_check import ability_obstacle
from engines.scene import (
    GUIDES,
    LOADS,
    Channel,
    Drive,
    Scene,
)


def says_what_it_is(engine: Engine) -> None:
    """Name, version and abilities are what the contract asks for."""
    assert isinstance(engine.name, str), f"expected a name, got {engine.name!r}: set the class attribute name"
    assert engine.name.strip(), "expected a name, got an empty one: set the class attribute name"
    with blamed_on(engine):
        version = engine.version()
    assert version is None or isinstance(version, str), f"expected a version or None, got {version!r}: return a string"
    assert isinstance(engine.is_control, bool), f"expected is_control, got {engine.is_control!r}: False, for an engine"
    can = engine.abilities
    assert isinstance(can, Abilities), f"expected Abilities, got {can!r}: set the class attribute abilities"
    for channel, told in can.readouts.items():
        assert isinstance(channel, Channel), f"expected a Channel, got {channel!r}: name one of engines.scene.Channel"
        sane = isinstance(told, ReadOut) and told.source and told.frame and told.instant
        assert sane, (
            f"expected a ReadOut of {channel.value} with source, frame and instant, got {told!r}: give all of them"
        )
    assert can.readouts, "expected the channels that are offered, got none: say what each is called in the engine"
    for name, known in (
        ("drives", frozenset(get_args(Drive))),
        ("joints", GUIDES),
        ("loads", LOADS),
        ("settings", frozenset(Setting)),
    ):
        surplus = getattr(can, name) - known
        assert not surplus, f"expected {name} of the contract in the abilities, got {surplus}: name none but those"


def is_installed(engine: Engine) -> None:
    """The engine can be used and finishes the plain sample; without it nothing else can be said."""
    completed(_plain_run(engine), PLAIN)


def _available(run: Run) -> None:
    if run.outcome is Outcome.UNAVAILABLE:
        raise NotApplicableError(run.reason)


def _plain_run(engine: Engine, channels: frozenset[Channel] = frozenset(Channel)) -> Run:
    return own_run(engine, case(PLAIN).scene(channels), _setting(engine))


def _setting(engine: Engine) -> Setting:
    settings = engine.abilities.settings
    return Setting.TUNED if Setting.TUNED in settings else min(settings, default=Setting.TUNED)


def refuses_what_it_cannot_hold(engine: Engine) -> None:
    """A scene beyond its abilities is unsupported, with a reason."""
    beyond = {name: case(name).scene(frozenset(Channel)) for name in SAMPLES}
    reasons = {name: ability_obstacle(scene, engine.abilities) for name, scene in beyond.items()}
    asked = [(name, _setting(engine)) for name, reason in reasons.items() if reason is not None]
    asked += [(PLAIN, setting) for setting in Setting if setting not in engine.abilities.settings]
    if not asked:
        raise NotApplicableError("its abilities cover every sample and setting")
    for name, setting in asked:
        with blamed_on(engine):
            run = engine.run(beyond[name], setting)
        _available(run)
        what = f"sample '{name}' in setting '{setting}', which is beyond its abilities"
        assert run.outcome is Outcome.UNSUPPORTED, f"{what}: expected 'unsupported', got '{run.outcome}': refuse it"
        assert run.reason.strip(), f"{what}: expected a reason, got none: state in one sentence what is not supported"
        assert run.history is None, f"{what}: expected no history, got one: a refused scene is not stepped"


def _first(scene: Scene, **changes: object) -> Scene:
    return replace(scene, bodies=(replace(scene.bodies[0], **changes), *scene.bodies[1:]))  # type: ignore[arg-type]


def _pin(scene: Scene, **changes: object) -> Scene:
    return replace(scene, pins=(replace(scene.pins[-1], **changes), *scene.pins[:-1]))  # type: ignore[arg-type]


# Data that no engine may be given, and what is wrong with them.
BAD: Final[Mapping[str, Callable[[Scene], Scene]]] = {
    "a mass that is nan": partial(_first, mass=float("nan")),
    "a negative mass": partial(_first, mass=-1.0),
    "an infinite mass": partial(_first, mass=float("inf")),
    "a negative inertia": partial(_first, inertia=-1e-3),
    "an inertia that is nan": partial(_first, inertia=float("nan")),
    "a position that is nan": partial(_first, position=(float("nan"), 0.0)),
    "a velocity that is infinite": partial(_first, velocity=(0.0, float("inf"))),
    "an anchor that is nan": partial(_pin, first_anchor=(float("nan"), 0.0)),
    "a pin that is open by half a metre": partial(_pin, first_anchor=(0.5, 0.5)),
    "a pin on a body that is not there": partial(_pin, first="nobody"),
    "a pin of a body with itself": lambda scene: _pin(scene, second=scene.pins[-1].first),
    "gravity that is nan": lambda scene: replace(scene, gravity=(float("nan"), 0.0)),
    "a crank that is not there": lambda scene: replace(scene, crank="nobody"),
    "two bodies of one name": lambda scene: _first(scene, name=scene.bodies[1].name),
}


def survives_bad_data(engine: Engine) -> None:
    """Data that cannot be run with come back as an outcome with a reason; nothing is raised and no process dies."""
    for words, spoil in BAD.items():
        scene = spoil(case(PLAIN).scene(frozenset(Channel)))
        run = own_run(engine, scene, _setting(engine))
        _available(run)
        assert run.outcome is not Outcome.FINISHED, (
            f"{words}: expected an outcome with a reason, got a finished run: look at the data before the engine does "
            "(engines.mechanics.start_check.data_obstacle)"
        )
        assert run.reason.strip(), f"{words}: expected a reason, got none: state in one sentence what is wrong"


def records_what_is_asked(engine: Engine) -> None:
    """Only channels that are requested and offered are recorded; the choice changes no step."""
    whole = finished(engine, PLAIN)
    scene = case(PLAIN).scene(frozenset(Channel))
    assert whole.history is not None
    for channel in Channel:
        run = _plain_run(engine, frozenset({channel}))
        if run.history is None:
            raise AssertionError(
                f"only {channel.value} requested: expected a finished run, got {run.outcome.value}: {run.reason}"
            )
        for other in Channel:
            there = bool(list(parts(run.history, scene, other)))
            wanted = other is channel and channel in engine.abilities.readouts
            got, cure = ("it", "leave it out") if there else ("none", "record it")
            assert there == wanted, (
                f"only {channel.value} requested: expected {'a' if wanted else 'no'} {other.value}, got {got}: {cure}"
            )
        assert run.steps == whole.steps, (
            f"only {channel.value} requested: expected the {whole.steps} steps of a run with every channel, got "
            f"{run.steps}: choose the steps by the scene alone"
        )


def repeats_itself(engine: Engine) -> None:
    """Two runs of one scene are the same to the last bit."""
    first, second = finished(engine, PLAIN).history, tuned_run(engine, PLAIN).history
    assert first is not None
    assert second is not None
    scene = case(PLAIN).scene(frozenset(Channel))
    for channel in Channel:
        pairs = zip(parts(first, scene, channel), parts(second, scene, channel), strict=True)
        for one, other in ((a.signal, b.signal) for a, b in pairs):
            same = np.array_equal(one.time, other.time) and np.array_equal(one.values, other.values)
            assert same, (
                f"{channel.value}: expected the same values from a second run, got others: build the world anew, "
                "without random numbers, threads or what a former run left"
            )


def settings_run(engine: Engine) -> None:
    """Every setting that is claimed runs, under every drive that is claimed."""
    claimed = [name for name in (PLAIN, "released") if obstacle_of_drive(engine, name) is None]
    for name in claimed:
        for setting in sorted(engine.abilities.settings):
            run = own_run(engine, case(name).scene(frozenset(Channel)), setting)
            _available(run)
            assert run.outcome is Outcome.FINISHED, (
                f"setting '{setting}' of sample '{name}': expected a finished run, got {run.outcome.value}: "
                f"{run.reason}; mend it, or leave it out of the abilities"
            )


def obstacle_of_drive(engine: Engine, sample: str) -> str | None:
    """Why an engine does not take a sample, whatever its settings."""
    return ability_obstacle(case(sample).scene(frozenset()), engine.abilities)


def origins_are_true(engine: Engine) -> None:
    """``naive`` and ``tuned`` are one run; what is made of several runs is not said to be read."""
    for setting in sorted(engine.abilities.settings):
        run = own_run(engine, case(PLAIN).scene(frozenset(Channel)), setting)
        if run.history is None:
            continue
        single = setting is not Setting.BEST
        assert not single or len(run.passes) <= 1, (
            f"setting '{setting}': expected one run of the engine, got {len(run.passes)}: extrapolate in 'best' alone"
        )
        for words, origin in _origins(run.history):
            assert not single or origin is not Origin.EXTRAPOLATED, (
                f"{words} in setting '{setting}': expected 'read' or 'computed', got '{origin}': nothing can be "
                "extrapolated from one run"
            )
            assert len(run.passes) <= 1 or origin is not Origin.READ, (
                f"{words} in setting '{setting}': expected 'extrapolated' of what {len(run.passes)} runs "
                "make, got 'read': say so"
            )


def _origins(history: History) -> Iterator[tuple[str, Origin]]:
    scene = case(PLAIN).scene(frozenset(Channel))
    for channel in Channel:
        for part in parts(history, scene, channel):
            origin = part.signal.origin
            assert isinstance(origin, Origin), (
                f"{part.words}: expected an Origin, got {origin!r}: name one of its values"
            )
            yield part.words, origin


def keeps_silent(engine: Engine) -> None:
    """Nothing is written to standard output or error, by Python or by C, in a run that is made or refused."""
    with _listening() as written:
        _plain_run(engine)
        with suppress(AdapterError):  # which another check names
            own_run(engine, _first(case(PLAIN).scene(frozenset(Channel)), mass=float("nan")), _setting(engine))
    text = b"".join(written).decode(errors="replace").strip()
    assert not text, f"expected silence, got {text[:80]!r}: chatters = True has a SteppedEngine's C output sent nowhere"


@contextmanager
def _listening() -> Iterator[list[bytes]]:
    """What is written to the process's standard output and error inside, when it is over."""
    written: list[bytes] = []
    flush()
    kept = [(stream, os.dup(stream)) for stream in (1, 2)]
    streams = sys.stdout, sys.stderr
    with tempfile.TemporaryFile() as heard:
        try:
            for stream, _ in kept:
                os.dup2(heard.fileno(), stream)
            with open(os.dup(1), "w", encoding="utf-8") as out:
                sys.stdout = sys.stderr = out
                yield written
                flush()
        finally:
            sys.stdout, sys.stderr = streams
            for stream, copy in kept:
                os.dup2(copy, stream)
                os.close(copy)
        heard.seek(0)
        written.append(heard.read())


def holds_all_it_claims(engine: Engine) -> None:
    """Every sample within its abilities is run, or refused with a reason that its abilities cannot say."""
    refused = []
    for sample in SAMPLES:
        if obstacle(engine, sample) is None:
            try:
                finished(engine, sample)
            except NotApplicableError as reason:
                refused.append(str(reason))
    if refused:
        raise NotApplicableError("; ".join(refused))


CHECKS = (
    Check("identity", "name, version and abilities", says_what_it_is, needs_engine=False),
    Check("installed", "the engine can be used, and finishes a run", is_installed),
    Check("bad data", "an outcome with a reason, nothing raised, no process dead", survives_bad_data, alone=True),
    Check("refusals", "a scene beyond its abilities is unsupported, with a reason", refuses_what_it_cannot_hold),
    Check("claims", "every sample within its abilities is run", holds_all_it_claims),
    Check("settings", "every setting it claims runs", settings_run),
    Check(
        "origins", "naive and tuned are one run; a value from several runs is not labelled as read", origins_are_true
    ),
    Check("recording", "only the requested channels are recorded; recording changes no step", records_what_is_asked),
    Check("repetition", "two runs are the same", repeats_itself),
    Check("silence", "nothing is written to the terminal", keeps_silent),
)
