"""What ``linkproof list``, ``show`` and ``thread`` do: read linkages, print or write what is known of them."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from analytic.description.loading import catalogue, load
from analytic.errors import LinkproofError
from analytic.kinematics.mechanism import Mechanism
from analytic.turn.required_feed import compare_feed, read_required_feed
from reports.command_line.destination import Destination
from reports.facts.mechanism_summary import portrait, thread_facts
from reports.text import terminal


def list_mechanisms(destination: Destination) -> None:
    """Print or write the catalogue."""
    linkages = [load(name) for name in catalogue()]
    rows = [{"mechanism": k.name, "title": k.title, "source": k.source, "variants": list(k.variants)} for k in linkages]
    destination.print(terminal.catalogue(linkages))
    destination.write_json({"records": rows})


def show(name: str, variant: str | None, destination: Destination) -> None:
    """Print or write the structure and figures of a mechanism."""
    facts = portrait(load(name, variant))
    destination.print(terminal.portrait(facts))
    destination.write_json(facts)


def thread(name: str, variant: str | None, required: Path | None, destination: Destination) -> None:
    """Print or write contour and feed of a mechanism's thread, and its difference from a required curve."""
    linkage = load(name, variant)
    if linkage.thread is None:
        raise LinkproofError(f"'{linkage.name}' has no thread: add a [thread] with its stops to its file")
    mechanism = Mechanism(linkage)
    facts = {"mechanism": linkage.name, "variant": linkage.variant, **thread_facts(mechanism, linkage.thread)}
    held = compare_feed(mechanism, linkage.thread, read_required_feed(required)) if required else None
    destination.print(terminal.thread(facts, held))
    if held is not None:
        curves = {name: getattr(held, name).tolist() for name in ("required", "actual", "difference")}
        facts["comparison"] = {"angle": np.degrees(held.angle).tolist(), **curves}
    destination.write_json(facts)
