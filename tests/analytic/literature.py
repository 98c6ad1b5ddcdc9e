"""The linkages of the literature as their sources give them, in 50 digits: points at a crank angle.

Typed from the sources, coordinates and lengths as strings, plane vectors as complex numbers in the unit of the source;
nothing is taken from the linkage files or from the code on trial. Pins are met by circles about known ones.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping

from mpmath import mp, mpc, mpf

Points = Mapping[str, mpc]
Formula = Callable[[mpf], Points]

# The position that reference data v1 of PMKS_Verification gives each joint, m.
WATT = {
    **{"A": ("-3.74", "-2.41"), "B": ("-2.72", "0.91"), "C": ("1.58", "0.43"), "D": ("-0.24", "4.01")},
    **{"E": ("5.08", "5.31"), "F": ("8.14", "3.35"), "G": ("7.32", "-3.51")},
}
STEPHENSON = {
    **{"A": ("7", "4"), "B": ("5", "16"), "C": ("25", "25"), "D": ("23", "10")},
    **{"E": ("18", "35"), "F": ("43", "32"), "G": ("45", "17")},
}
TEACHING = {"A": ("0", "0"), "B": ("1.52", "0"), "C": ("4.23", "3.029"), "D": ("4.572", "0"), "G": ("2.053", "3.543")}
STEEP = {
    **{"A": ("0", "0"), "B": ("-1.9965085803955582", "4.001743805943468")},
    **{"C": ("0.010471974182821878", "11.999995430738993"), "D": ("-1.9825459481517957", "20.00173771359546")},
}
# Jansen's thirteen numbers.
JANSEN = {
    **{"a": "38.0", "b": "41.5", "c": "39.3", "d": "40.1", "e": "55.8", "f": "39.4", "g": "36.7", "h": "65.7"},
    **{"i": "49.0", "j": "50.0", "k": "61.9", "l": "7.8", "m": "15.0"},
}


def drawn(joints: Mapping[str, tuple[str, str]]) -> dict[str, mpc]:
    """Joints of a drawing."""
    return {name: mpc(*map(mpf, place)) for name, place in joints.items()}


def meet(first: mpc, reach: mpf, second: mpc, other: mpf, side: int) -> mpc:
    """Where circles about two points meet, to the left (+1) or right (-1) of the way from the first to the second.

    Raises ValueError where they do not.
    """
    gap = second - first
    along = (abs(gap) ** 2 + reach**2 - other**2) / (2 * abs(gap))
    if abs(along) > reach:
        raise ValueError(f"circles of {reach} and {other} about points {abs(gap)} apart do not meet")
    return first + gap / abs(gap) * mpc(along, side * mp.sqrt(reach**2 - along**2))


def carried(old: tuple[mpc, mpc], new: tuple[mpc, mpc], point: mpc) -> mpc:
    """A point of a rigid link, of which two other points went from old to new places."""
    return new[0] + (point - old[0]) * (new[1] - new[0]) / (old[1] - old[0])


def side_of(first: mpc, second: mpc, point: mpc) -> int:
    """On which side of the way from first to second a point lies."""
    return 1 if ((point - first) * mp.conj(second - first)).imag > 0 else -1


def met(old: Mapping[str, mpc], new: Mapping[str, mpc], first: str, second: str, pin: str) -> mpc:
    """The pin of a dyad between two pins that have moved, its lengths and its side those of the drawing."""
    reaches = abs(old[pin] - old[first]), abs(old[pin] - old[second])
    return meet(new[first], reaches[0], new[second], reaches[1], side_of(old[first], old[second], old[pin]))


def watt(phi: mpf) -> Points:
    """The joints with the crank turned by phi from the drawing: A, G fixed; AB, BCD, DE, EF, CFG."""
    old = drawn(WATT)
    new = {"A": old["A"], "G": old["G"], "B": old["A"] + (old["B"] - old["A"]) * mp.expj(phi)}
    new["C"] = met(old, new, "B", "G", "C")
    new["D"] = carried((old["B"], old["C"]), (new["B"], new["C"]), old["D"])
    new["F"] = carried((old["C"], old["G"]), (new["C"], new["G"]), old["F"])
    new["E"] = met(old, new, "D", "F", "E")
    return new


def stephenson(phi: mpf) -> Points:
    """The joints with the crank turned by phi from the drawing: A, D, G fixed; AB, BCE, CD, EF, FG."""
    old = drawn(STEPHENSON)
    new = {name: old[name] for name in "ADG"} | {"B": old["A"] + (old["B"] - old["A"]) * mp.expj(phi)}
    new["C"] = met(old, new, "B", "D", "C")
    new["E"] = carried((old["B"], old["C"]), (new["B"], new["C"]), old["E"])
    new["F"] = met(old, new, "E", "G", "F")
    return new


def jansen(phi: mpf) -> Points:
    """The leg with its crank m at phi: AB = j, AD = k, plate GBC = b, e, d, GD = c, CE = f, plate DEF = g, h, i; mm."""
    x = {name: mpf(length) for name, length in JANSEN.items()}
    g, a = mpc(-x["a"], -x["l"]), x["m"] * mp.expj(phi)
    b = meet(g, x["b"], a, x["j"], 1)
    c = meet(g, x["d"], b, x["e"], 1)
    d = meet(g, x["c"], a, x["k"], -1)
    e = meet(c, x["f"], d, x["g"], -1)
    return {"A": a, "B": b, "C": c, "D": d, "E": e, "F": meet(d, x["i"], e, x["h"], 1)}


def whitworth(phi: mpf) -> Points:
    """Crank OA = 150, centres OC = 100, arm CD = 125 opposite to the slot, rod DR = 500 to the line through C; mm."""
    c, a = mpc(0, -100), 150 * mp.expj(phi)
    d = c - 125 * (a - c) / abs(a - c)
    return {"A": a, "D": d, "R": mpc(d.real + mp.sqrt(mpf(500) ** 2 - (d - c).imag ** 2), -100)}


def andrews(phi: mpf) -> Points:
    """K1 OF = 7, K2 FE = 28, K3 BE = 35 and D, K4 GE = 20, K5 AG = 40, K6 HE = 20, K7 AH = 40; mm."""
    a, b = mpc("-69.34", "-2.27"), mpc("-36.35", "32.73")
    f = 7 * mp.expj(phi)
    e = meet(f, mpf(28), b, mpf(35), 1)
    axis = (e - b) / 35  # K3: D lies 18 along it and 20 to its left
    g, h = meet(a, mpf(40), e, mpf(20), 1), meet(a, mpf(40), e, mpf(20), -1)
    return {"F": f, "E": e, "D": b + axis * mpc(18, 20), "G": g, "H": h}


def shaper(phi: mpf) -> Points:
    """Crank OA = 0.1 from (0, 0.25), coupler TB = 0.53 through A, rocker QB = 0.1 from (-0.1, 0.45), T on y = 0; m.

    T is where a rod from it through A ends on the rocker's circle: a root over its place.
    """
    a, q = mpc(0, mpf("0.25")) + mpf("0.1") * mp.expj(phi), mpc(mpf("-0.1"), mpf("0.45"))

    def end(x: mpf) -> mpc:
        return x + mpf("0.53") * (a - x) / abs(a - x)

    x = mp.findroot(lambda x: abs(end(x) - q) ** 2 - mpf("0.01"), mpf(SHAPER_TOOL[round(mp.degrees(phi))]))
    return {"A": a, "T": mpc(x), "B": end(x)}


def four_bars(phi: mpf) -> Points:
    """Forty windows of four equal links of 1 m: every crank goes on as the first one does; m."""
    return {f"B{number}": number + mp.expj(phi) for number in range(41)}


def teaching(phi: mpf) -> Points:
    """The joints with the crank turned by phi from the drawing: A, D fixed; AB, BCG, CD; m."""
    old = drawn(TEACHING)
    new = {name: old[name] for name in "AD"} | {"B": old["B"] * mp.expj(phi)}
    new["C"] = met(old, new, "B", "D", "C")
    new["G"] = carried((old["B"], old["C"]), (new["B"], new["C"]), old["G"])
    return new


def steep(phi: mpf) -> Points:
    """Crank AB, rod BCD with C on a line through A, on the far side of B's foot; m."""
    old = drawn(STEEP)
    axis, b = mpc(mpf("0.0008726645152351565"), mpf("0.9999996192282494")), old["B"] * mp.expj(phi)
    foot = b / axis
    c = axis * (foot.real + mp.sqrt(abs(old["C"] - old["B"]) ** 2 - foot.imag**2))
    return {"B": b, "C": c, "D": carried((old["B"], old["C"]), (b, c), old["D"])}


def slotted_lever(phi: mpf) -> Points:
    """Crank AB = 0.15, lever through B about C = (-0.30, 0), CD = 0.20, CF = 0.50, DE = 0.14, E on x = -0.55; m."""
    c, b = mpc(mpf("-0.30"), 0), mpf("0.15") * mp.expj(phi)
    axis, x = (b - c) / abs(b - c), mpf("-0.55")
    d = c - mpf("0.20") * axis
    e = mpc(x, d.imag + mp.sqrt(mpf("0.14") ** 2 - (x - d.real) ** 2))
    return {"B": b, "D": d, "F": c + mpf("0.50") * axis, "E": e}


# Rough places of the tool, m, by crank angle, degrees: the source's at 90, from which the others were followed.
SHAPER_TOOL = {30: "0.25", 90: "0.06", 150: "-0.2", 270: "0.02"}

# By name: the formula, its unit in m, and the crank angles to look at, degrees.
FORMULAS: Mapping[str, tuple[Formula, str, tuple[float, ...]]] = {
    "andrews-squeezer": (andrews, "1e-3", (-3.5, 100.0, 905.9)),
    "jansen-leg": (jansen, "1e-3", (0.0, 77.0, 180.0, 256.9)),
    "n-four-bar": (four_bars, "1", (-179.0, 0.0, 0.1, 90.0, 180.0, 400.0)),
    "shaper-quick-return": (shaper, "1", (30.0, 90.0, 150.0, 270.0)),
    "slotted-lever": (slotted_lever, "1", (0.0, 60.0, 200.0, 333.3)),
    "steep-slider-crank": (steep, "1", (0.0, 60.0, 200.0, 300.0)),
    "stephenson-six-bar": (stephenson, "1", (-58.89, -20.0, 0.0, 41.3)),
    "teaching-four-bar": (teaching, "1", (0.0, 60.0, 200.0, 300.0)),
    "watt-six-bar": (watt, "1", (-5.63, 0.0, 2.0, 5.33)),
    "whitworth-quick-return": (whitworth, "1e-3", (0.0, 90.0, 221.81, 300.0)),
}
