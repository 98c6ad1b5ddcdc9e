"""The articles' own formulas, in 50 digits: points and links of every catalogue mechanism at a crank angle.

Typed as they stand in articles 000 to 004, with the readings that the catalogue's notes give; plane vectors as complex
numbers in mm. Nothing is taken from the code on trial. A link is (mass kg, inertia kg m², mass centre mm, a vector that
is fixed in it, or None where it does not turn).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from mpmath import mp, mpc, mpf

STEP = mpf(10) ** -12


@dataclass(frozen=True)
class Drawn:
    """A mechanism at one crank angle."""

    points: dict[str, mpc]
    links: dict[str, tuple[mpf, mpf, mpc, mpc | None]]


Formula = Callable[[mpf], Drawn]


def n(text: str) -> mpf:
    """A printed number, all its digits."""
    return mpf(text)


def rot(vector: mpc, degrees: str | mpf) -> mpc:
    """A vector turned by an angle in degrees."""
    return vector * mp.expj(mp.radians(mpf(degrees)))


def rho(vector: mpc, angle: mpf, length: mpf) -> mpc:
    """The articles' rho: turned by an angle in rad and scaled to a length."""
    return vector * mp.expj(angle) * length / abs(vector)


def dyad(two: mpc, four: mpc, lengths: tuple[mpf, mpf], w: int) -> mpc:
    """The inner pin of a dyad RRR by the cosine theorem from P4, l43 and l23, with the sign W."""
    l43, l23 = lengths
    v = two - four
    u = mp.acos((abs(v) ** 2 + l43**2 - l23**2) / (2 * abs(v) * l43))
    return four + rho(v, w * u, l43)


def juki(towards: int) -> Formula:
    """Section 1; ``towards`` is +1 for the coupler's centre on the needle's side, -1 as printed."""

    def drawn(phi: mpf) -> Drawn:
        a = n("15.5") * mp.expj(phi)
        d = mpc(0, a.imag - mp.sqrt(n("54.5") ** 2 - a.real**2))
        along = (d - a) / abs(d - a)
        links = {
            "crank": (n("0.64"), n("0.64e-4"), n("0.5") * mp.expj(phi), a),
            "coupler": (n("0.03"), n("0.19e-4"), a + towards * n("12.9") * along, d - a),
            "needle_bar": (n("0.076"), mpf(0), d, None),
        }
        return Drawn({"A": a, "D": d}, links)

    return drawn


def rimoldi(rod: str, link: str) -> Formula:
    """Section 2, with the distances of the rod's and the link's mass centres from their first joints."""

    def drawn(phi: mpf) -> Drawn:
        a, o2 = 12 * mp.expj(phi), mpc(16, 175)
        b = dyad(a, o2, (n("21.3"), mpf(175)), -1)
        c = o2 - (b - o2) * n("27.5") / n("21.3")
        d = mpc(38, c.imag - mp.sqrt(mpf(19) ** 2 - (38 - c.real) ** 2))
        along, down = (b - a) / abs(b - a), (d - c) / abs(d - c)
        links = {
            "crank": (n("0.51"), n("0.72e-4"), -1j * a / abs(a), a),
            "rod": (n("0.17"), n("6.13e-4"), a + n(rod) * along, b - a),
            "rocker": (n("0.662"), n("0.48e-4"), o2 + n("0.3") * (b - o2) / abs(b - o2), b - o2),
            "link": (n("0.016"), n("0.013e-4"), c + n(link) * down, d - c),
            "needle_bar": (n("0.041"), mpf(0), d, None),
        }
        return Drawn({"A": a, "B": b, "C": c, "D": d}, links)

    return drawn


def slotted(eye: str) -> Formula:
    """Section 3, the eye at an angle to the slot line (0 in article 000)."""

    def drawn(phi: mpf) -> Drawn:
        p5, l2 = mpc(n("11.7"), n("35.69")), n("44.2")
        p2 = n("16.3") * mp.expj(phi)
        p3 = mpc(0, p2.imag - mp.sqrt(l2**2 - p2.real**2))
        p4 = p2 + rot(p3 - p2, "-90") * 10 / l2
        slot = p4 - p5
        links = {
            "crank": (n("0.2"), n("325e-6"), 5 * mp.expj(phi + mp.pi), p2),
            "coupler": (n("0.055"), n("70e-6"), p2 + rot(p3 - p2, "30") * 10 / l2, p3 - p2),
            "needle_bar": (n("0.1"), mpf(0), p3 + 10j, None),
            "slot_slider": (n("0.02"), n("25e-6"), p4, slot),
            "rocker": (n("0.06"), n("50e-6"), p5 + rot(slot, "45") * 15 / abs(slot), slot),
        }
        return Drawn({"P2": p2, "P3": p3, "P4": p4, "P7": p5 + rot(slot, eye) * 55 / abs(slot)}, links)

    return drawn


def two_crank(w: int, us1: str) -> Formula:
    """Section 4, with the sign W and the angle US1 of the crank's mass centre."""

    def drawn(phi: mpf) -> Drawn:
        p4 = mpc(n("9.66"), n("2.59"))
        p2 = 30 * mp.expj(phi)
        p3 = dyad(p2, p4, (mpf(19), mpf(22)), w)
        links = {
            "crank": (n("0.01"), n("35e-6"), rot(5 * mp.expj(phi), us1), p2),
            "coupler": (n("0.0065"), n("25e-6"), p2 + rot(p3 - p2, "-30") * 5 / 22, p3 - p2),
            "rocker": (n("0.0085"), n("8.5e-6"), p4 + (p3 - p4) * 15 / 19, p3 - p4),
        }
        return Drawn({"P2": p2, "P3": p3, "P5": p3 + rot(p2 - p3, "-95") * 47 / 22}, links)

    return drawn


def fork(phi: mpf) -> Drawn:
    """Section 5: points only, the masses are ours."""
    p4 = mpc(-18, 14)
    p2 = 10 * mp.expj(phi)
    p3 = dyad(p2, p4, (mpf(22), mpf(26)), 1)
    p5 = p3 + rot(p2 - p3, "170") * 60 / 26
    return Drawn({"P2": p2, "P3": p3, "P5": p5, "P6": p3 + rot(p4 - p3, "-165") * 58 / 22}, {})


FORMULAS: dict[tuple[str, str], Formula] = {
    ("juki-mf7923d", "as-built"): juki(1),
    ("juki-mf7923d", "as-printed"): juki(-1),
    ("rimoldi-164", "as-built"): rimoldi("69", "9.5"),
    ("rimoldi-164", "as-printed"): rimoldi("0.069", "-9.5"),
    ("slotted-takeup", "corrected"): slotted("0"),
    ("slotted-takeup", "inverted"): slotted("150"),
    ("two-crank-takeup", "corrected"): two_crank(-1, "180"),
    ("two-crank-takeup", "as-printed"): two_crank(-1, "0"),
    ("two-crank-takeup", "W+1"): two_crank(1, "180"),
    ("fork-takeup", "representative"): fork,
}


def reduced_inertia(formula: Formula, phi: mpf) -> mpf:
    """Jeq, kg m², from differences of the drawing over a tiny angle."""
    before, after = formula(phi - STEP), formula(phi + STEP)
    total = mpf(0)
    for name, (mass, inertia, centre, turning) in after.links.items():
        _, _, old_centre, old_turning = before.links[name]
        total += mass * (abs(centre - old_centre) / (2 * STEP) / 1000) ** 2
        if turning is not None:
            total += inertia * (mp.arg(turning / old_turning) / (2 * STEP)) ** 2
    return total
