"""Numbers of a linkage by name: each can be changed alone, moved, scaled by its dimension, left out."""

import pytest

from analytic.description import changes
from analytic.description.loading import load
from tests.analytic.linkages import MADE_UP, mechanism

SPRUNG, LOADED = (load(f"tests/linkages/{name}.toml") for name in ("spring-and-damper", "force-over-angle"))


def with_number(linkage, path, number):
    return changes.changed(linkage, lambda name, kind, value: number if name == path else value)


@pytest.mark.parametrize("name", MADE_UP)
def test_every_number_can_be_set_alone(name):
    linkage = mechanism(name).linkage
    assert changes.changed(linkage, lambda path, kind, value: value) == linkage
    before = changes.numbers(linkage)
    assert len(before) > 10
    for path, value in before.items():
        if ".along." not in path:  # a component of a unit vector takes the other one with it
            after = changes.numbers(with_number(linkage, path, value + 1.0))
            assert after == {**before, path: value + 1.0}


@pytest.mark.parametrize("part", changes.EMPTY_PARTS)
def test_a_part_left_out_is_gone_and_no_other(part):
    linkage = load("slotted-takeup") if part == "thread" else SPRUNG
    bare = changes.without(linkage, part)
    assert getattr(bare, part) == changes.EMPTY_PARTS[part]
    assert {name for name in vars(bare) if getattr(bare, name) != getattr(linkage, name)} <= {part}
