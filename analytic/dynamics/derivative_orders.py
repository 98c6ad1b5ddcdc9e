"""What has to be known of which link for the quantities asked for: the compiled path computes this much and no more.

The plain path finds the same out as it goes along (``analytic.kinematics.sweep``, ``analytic.dynamics.reduced``).
"""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass
from typing import Final

from analytic.description.linkage import Link, Linkage
from analytic.kinematics.sweep import output_of

OUTPUT_ORDERS: Final[Mapping[str, int]] = {"S": 0, "v": 1, "a": 2}
NO_OUTPUT: Final = -1


@dataclass(frozen=True)
class Needs:
    """Order of the derivatives needed of bodies by name, and which sums over the linkage.

    ``forces`` stands for Q and b, ``output`` is the order of the output's derivative or ``NO_OUTPUT``.
    """

    orders: Mapping[str, int]
    inertia: bool
    half_derivative: bool
    forces: bool
    output: int


def needs(linkage: Linkage, quantities: Collection[str], *, turns: bool, accelerates: bool = True) -> Needs:
    """Needs of ``analytic.evaluation.QUANTITIES`` by name, of a crank that stands still unless it ``turns``.

    Its torque needs Jeq only where it ``accelerates``. Raises LinkproofError where a quantity of the output is among
    them and the linkage names none.
    """
    torque = not {"Mkr", "Peq"}.isdisjoint(quantities)
    inertia = (torque and accelerates) or not {"Jeq", "Teq"}.isdisjoint(quantities)
    half_derivative = "half_slope" in quantities or (torque and turns)
    forces = torque or "Q" in quantities
    output = max((order for name, order in OUTPUT_ORDERS.items() if name in quantities), default=NO_OUTPUT)
    orders: dict[str, int] = {}

    def ask(body: str, order: int) -> None:
        orders[body] = max(order, orders.get(body, order))

    for name, link in linkage.links.items():
        if name != linkage.crank and _is_felt(link) and (inertia or half_derivative):
            ask(name, 2 if half_derivative else 1)
    if forces:
        for name in _loaded(linkage):
            ask(name, 1)
    if torque and turns:
        for name in (body for damper in linkage.dampers for body in damper.links):
            ask(name, 1)
    if output != NO_OUTPUT:
        ask(output_of(linkage).link, output)
    return Needs(orders, inertia, half_derivative, forces, output)


def _is_felt(link: Link) -> bool:
    return bool(link.mass or link.inertia)


def _loaded(linkage: Linkage) -> list[str]:
    """Bodies that weight, forces, torques and springs act on."""
    falls = linkage.gravity != (0.0, 0.0)
    bodies = [name for name, link in linkage.links.items() if falls and link.mass]
    bodies += [force.link for force in linkage.forces]
    bodies += [torque.link for torque in linkage.torques]
    return bodies + [body for spring in linkage.springs for body in spring.links]
