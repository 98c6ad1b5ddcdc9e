"""Search for Assur groups of any class: the smallest sets of links that their joints place, by bipartite matching.

Bodies not yet placed have three unknowns each, pins not yet placed two; a body on a pin, a slide, a cylinder are two
equations, two, and one between them. A matching gives every equation an unknown of its own; what depends on what
through it falls into strongly connected components, and one that depends on no other is a group of the least size. The
division does not depend on the matching (A. L. Dulmage, N. S. Mendelsohn, Canadian Journal of Mathematics 10, 1958).
"""

from __future__ import annotations

import itertools
from collections import deque
from collections.abc import Iterable, Sequence

import numpy as np
from scipy.sparse import csr_matrix
from scipy.sparse.csgraph import connected_components, maximum_bipartite_matching

from analytic.description.linkage import GROUND, Linkage, Pin, Slider
from analytic.kinematics.structure import DrivenDistance, Group, GroupJoint, prismatic_joint, revolute_joint

Edge = tuple[int, tuple[str, ...]]  # a number of equations, and the unplaced bodies and pins they are between


def find_group(
    linkage: Linkage, placed: set[str], holders: dict[str, str], cylinder: DrivenDistance | None
) -> Group | None:
    """The first group of the remaining links by name; None where the joints do not fit the unknowns.

    ``holders`` are placed bodies of pins; a slot's pin is a slider of the linkage.
    """
    left = sorted(set(linkage.links) - placed)
    sizes = {**dict.fromkeys(left, 3), **{_pin_node(p): 2 for p in linkage.pins if p.point not in holders}}
    edges = [*_edges(linkage, placed, holders), *_cylinder_edge(cylinder, placed)]
    components = _components(sizes, edges)
    if components is None:
        return None
    links = min(tuple(sorted(set(names) & {*left})) for names in components)
    joints = tuple(_joints(linkage, links, placed, holders, cylinder))
    return Group(links, joints, _class_of_group(links, joints))


def _pin_node(pin: Pin) -> str:
    return f"pin {pin.point}\0"  # no body can be called so


def _edges(linkage: Linkage, placed: set[str], holders: dict[str, str]) -> Iterable[Edge]:
    """Joints as edges between the unplaced bodies and pins, each with the number of coordinates that it fixes."""
    for pin in linkage.pins:
        node = () if pin.point in holders else (_pin_node(pin),)
        yield from ((2, (body, *node)) for body in pin.links if body not in placed)
    for slider in linkage.sliders:
        ends = tuple(body for body in (slider.link, slider.guide.host) if body not in placed)
        if ends:
            yield 2, ends


def _cylinder_edge(cylinder: DrivenDistance | None, placed: set[str]) -> Iterable[Edge]:
    """The driving cylinder as an edge, if one of its bodies is not placed."""
    if cylinder is not None:
        yield 1, tuple(body for body in (cylinder.near, cylinder.far) if body not in placed)


def _components(sizes: dict[str, int], edges: Sequence[Edge]) -> list[tuple[str, ...]] | None:
    """The sets of bodies and pins that depend on no other set and hold a body; None where there is no matching."""
    names, starts = list(sizes), dict(zip(sizes, itertools.accumulate([0, *sizes.values()]), strict=False))
    equations = [ends for count, ends in edges for _ in range(count)]
    unknowns = sum(sizes.values())
    if len(equations) != unknowns:
        return None
    entries = [(row, starts[end] + k) for row, ends in enumerate(equations) for end in ends for k in range(sizes[end])]
    rows, columns = np.array(entries).T
    graph = csr_matrix((np.ones(len(entries), dtype=np.int8), (rows, columns)), shape=(unknowns, unknowns))
    matched = maximum_bipartite_matching(graph, perm_type="column")  # of each equation
    if np.any(matched < 0):
        return None
    owners = np.repeat(np.arange(len(names)), list(sizes.values()))[matched]
    number = {name: at for at, name in enumerate(names)}
    needs = {(int(owner), number[end]) for owner, ends in zip(owners, equations, strict=True) for end in ends}
    needs = {(first, other) for first, other in needs if first != other}
    values, other = np.array(sorted(needs)).reshape(-1, 2).T
    graph = csr_matrix((np.ones(len(values), dtype=np.int8), (values, other)), shape=(len(names), len(names)))
    count, labels = connected_components(graph, directed=True, connection="strong")
    waiting = {int(labels[a]) for a, b in needs if labels[a] != labels[b]}
    free = [
        tuple(name for name, label in zip(names, labels, strict=True) if label == part)
        for part in range(count) if part not in waiting
    ]  # fmt: skip
    return [part for part in free if any(sizes[name] == 3 for name in part)] or None


def _joints(
    linkage: Linkage, links: Sequence[str], placed: set[str], holders: dict[str, str], cylinder: DrivenDistance | None
) -> Iterable[GroupJoint]:
    """Outer joints seen from placed bodies, and inner ones."""
    for pin in linkage.pins:
        members = [body for body in pin.links if body in links]
        near = holders.get(pin.point) or (members[0] if members else GROUND)
        yield from (revolute_joint(linkage, pin.point, near, body) for body in members if body != near)
    for slider in linkage.sliders:
        yield from _slider_joint(linkage, slider, links, placed)
    if cylinder is not None and {cylinder.near, cylinder.far} & {*links}:
        yield cylinder


def _slider_joint(linkage: Linkage, slider: Slider, links: Sequence[str], placed: set[str]) -> Iterable[GroupJoint]:
    """A slider's joint if it is in the group or between the group and a placed body."""
    ends = (slider.link, slider.guide.host)
    known = {*links} | placed
    if {*ends} & {*links} and {*ends} <= known:
        near = slider.link if slider.link in placed else slider.guide.host
        yield prismatic_joint(slider, linkage.local(slider.point, slider.link), near)


def _class_of_group(links: Sequence[str], joints: Sequence[GroupJoint]) -> int:
    """The sides of the largest of the shortest closed contours through each joint between links of the group, or 3."""
    pairs = {(j.near, j.far) for j in joints if j.near in links and j.far in links}
    return max([3, *(_contour_length(pair, pairs) for pair in pairs)])


def _contour_length(pair: tuple[str, str], pairs: set[tuple[str, str]]) -> int:
    """Links in the shortest closed contour with a joint; 0 if there is none."""
    start, end = pair
    steps, queue = {start: 1}, deque([start])
    while queue:
        here = queue.popleft()
        for a, b in pairs - {pair}:
            neighbour = b if a == here else a if b == here else None
            if neighbour is not None and neighbour not in steps:
                steps[neighbour] = steps[here] + 1
                queue.append(neighbour)
    return steps.get(end, 0)
