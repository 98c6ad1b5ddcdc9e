"""Pinned records: everything the commands say of mechanisms and engines, taken once and held after every change.

``python tests/pins/pins.py hold [PART ...] [only=TEXT]`` makes the records anew and prints those that moved; ``take``
renews the pins. Parts: figures (list, check, printed), designer (results, check, sweep, optimise, tolerance
and judge, of the catalogue, the literature and the linkages of the tests), bench, stress; tests/baseline.csv holds
the errors of compare. Times, dates and borders are left out, and bench and stress are held where both trees finished.
Engines' last digits belong to the machine and the versions that took them, so this is run by hand and not by the tests.
"""

from __future__ import annotations

import gzip
import json
import math
import os
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

from analytic.description.changes import design_numbers
from analytic.description.loading import catalogue, load
from comparisons.designer.figures import compare_published

HERE = Path(__file__).parent
ROOT = HERE.parents[1]
COMMAND = [sys.executable, "-c", "from reports.command_line.main import main; main()"]
PARTS = ("figures", "designer", "bench", "stress")

MOST = 24  # numbers of a list that are pinned, evenly among them
CLOSED_FORM = 1e-13  # of the peak
EXACT = 1e-14  # of the peak: closed form and `direct`, whose operations may move
ENGINE_SHARE = 0.01  # of an engine's error
ENGINE_FLOOR = 1e-9  # of the peak
LOCATION = 1e-6  # degrees or seconds: where a smooth extreme lies is known to the root of the rounding error
LOCATIONS = ("_at", ".at", ".phi", ".time", "worst", "direction", "angle", "top", "bottom", "dead_centre", "shift")
BOUNDS = ("closure_error", "error_bound")  # rounding errors themselves: held to their size
# What identifies a record, and what is held of it; everything else is a time, a text or derived.
KEYS = {
    "bench": ("mechanism", "variant", "regime", "engine", "kind", "setting", "runs", "effort", "step", "quantity"),
    "stress": ("axis", "row", "value", "engine", "setting"),
}
HELD = {
    "bench": ("outcome", "error_max", "error_rms", "peak", "steps"),
    "stress": ("verdict", "quantity", "deviation", "invariant"),
}
GONE = {"host", "baseline"}  # names of a record that pins still have
ONLY: list[str] = []  # parts of names: mechanisms of the figures that are made, all if empty
UNSTEADY = {"timed-out", "crashed"}  # what a slower machine may make of a run


def said(*words: str, files: dict[str, str] | None = None, before: tuple[str, ...] = ()) -> Any:
    """The JSON of a command in a folder with ``files``, after another one; its exit code where it refuses."""
    with tempfile.TemporaryDirectory() as folder:
        for name, text in (files or {}).items():
            (Path(folder) / name).write_text(text, encoding="utf-8")
        how = {"env": os.environ | {"PYTHONPATH": str(ROOT)}, "cwd": folder, "capture_output": True}
        if before:
            subprocess.run([*COMMAND, *before], check=False, **how)
        run = subprocess.run([*COMMAND, *words, "--json"], check=False, **how)
        return json.loads(run.stdout) if run.stdout else {"exit": run.returncode}


def variants() -> list[tuple[str, str]]:
    """Every sewing mechanism of the catalogue with each of its variants."""
    shelf = [row for row in said("list")["records"] if row["shelf"] == "catalogue"]
    names = [(row["mechanism"], variant) for row in shelf for variant in row["variants"]]
    return [name for name in names if not ONLY or any(part in " ".join(name) for part in ONLY)]


def figures() -> dict[str, Any]:
    """What list and check say, and the figures that the sources print."""
    every = [[load(name, variant) for variant in load(name).variants] for name in catalogue()]
    published = [vars(record) for variants in every for record in compare_published(variants)]
    pins = {"list": said("list")["records"], "published": published}
    for mechanism, variant in variants():
        pins[f"check {mechanism} {variant}"] = said("check", mechanism, "--variant", variant)
    return pins


def designer() -> dict[str, Any]:
    """What a designer is told of every linkage, and of one length and one mass of it."""
    shelves = [row["mechanism"] for row in said("list")["records"]]
    own = sorted(str(path) for path in (ROOT / "tests" / "linkages").rglob("*.toml"))
    pins: dict[str, Any] = {}
    for name in [*shelves, *own]:
        short = Path(name).stem
        if ONLY and not any(part in short for part in ONLY):
            continue
        pins[f"results {short}"] = thinned(said("results", name, "--at", "0,40,100,220,310"))
        pins[f"check {short}"] = thinned(said("check", name))
        vary = length_and_mass(name)
        if vary and short in DESIGNED:
            near = {number: value for number, (_, value) in design_numbers(load(name)).items() if number in vary}
            units = {number: "kg" if number.endswith(".mass") else "m" for number in vary}
            ranges = [f"{n}={0.98 * value!r}{units[n]}:{1.02 * value!r}{units[n]}:3" for n, value in near.items()]
            over = [word for spread in ranges for word in ("--vary", spread)]
            figures = ["--quantity", "Mkr.peak", "--quantity", "Mkr.rms", "--quantity", "joint_force.peak"]
            pins[f"sweep {short}"] = thinned(said("sweep", name, *over, *figures, "--refine"))
            best = ["--minimise", "Mkr.peak", "--over", f"{vary[0]}=±2%"]
            pins[f"optimise {short}"] = thinned(said("optimise", name, *best))
            pins[f"tolerance {short}"] = thinned(tolerance(name, vary))
            pins |= judgements(name)
    return pins


DESIGNED = ("juki-mf7923d", "rimoldi-164", "slotted-takeup", "two-crank-takeup", "spring-and-damper")  # with designs
SLIPS = (["--no-gravity"], ["--speed", "950"], ["--speed", "-1000"], [])  # of the curves that are judged


def length_and_mass(name: str) -> list[str]:
    """A length and a mass of a link that is not the crank, by name."""
    link = load(name)
    numbers = design_numbers(link)
    others = [
        number for number in numbers if number.partition(".")[0] not in (link.crank, "ground", "gravity", "output")
    ]
    lengths = [
        number for number in others if numbers[number][0] == "length" and numbers[number][1] > 0.01 * link.extent()
    ]
    masses = [number for number in others if number.endswith(".mass") and numbers[number][1]]
    return [*lengths[:1], *masses[:1]]


def tolerance(name: str, numbers: list[str]) -> Any:
    """Tolerances of a length and a mass."""
    rows = "".join(f'"{number}" = "{"1g" if number.endswith(".mass") else "0.05mm"}"\n' for number in numbers)
    files = {"tolerances.toml": f'results = ["Mkr.peak"]\n[tolerances]\n{rows}'}
    return said("tolerance", name, "tolerances.toml", "--samples", "100", files=files)


def judgements(name: str) -> dict[str, Any]:
    """What is said of curves of the closed form with a slip."""
    found = {}
    for slip in SLIPS:
        curves = ("results", name, "--regime", "run-up", *slip, "--save", "curves.csv")
        found[f"judge {name} {' '.join(slip)}"] = thinned(said("judge", name, "curves.csv", before=curves))
    return found


def thinned(data: Any) -> Any:
    """Long lists of numbers by some of them."""
    if isinstance(data, dict):
        return {name: thinned(value) for name, value in data.items()}
    if isinstance(data, list):
        step = -(-len(data) // MOST) if data and isinstance(data[0], (int, float)) else 1
        return [thinned(value) for value in data[::step]]
    return data


def bench() -> dict[str, Any]:
    """The points of the quick work-precision study, each in all its quantities."""
    names = ("quantity", "error_max", "error_rms", "peak")
    records = said("bench", "--quick")["records"]
    rows = [
        {**record, **{name: error[name] for name in names}}
        for record in records
        for error in record["errors"] or [dict.fromkeys(names)]
    ]
    return _by_key("bench", rows)


def stress() -> dict[str, Any]:
    """The cells of the quick stability maps, with their worst deviation and their worst invariant."""
    rows = [
        {
            **cell,
            **_worst(cell["errors"], "quantity", "deviation"),
            **_worst(cell["invariants"], "invariant", "invariant_error"),
        }
        for cell in said("stress", "--quick")["cells"]
    ]
    return _by_key("stress", rows)


def _worst(errors: list[dict[str, Any]], name: str, size: str) -> dict[str, Any]:
    return {name: errors[0]["quantity"], size: errors[0]["error_max"]} if errors else {name: None, size: None}


def _by_key(part: str, rows: list[dict[str, Any]]) -> dict[str, Any]:
    return {" | ".join(str(row[name]) for name in KEYS[part]): {name: row[name] for name in HELD[part]} for row in rows}


def moved(part: str, old: dict[str, Any], new: dict[str, Any]) -> list[str]:
    """One line for each record that moved."""
    lines = []
    for key in sorted(old.keys() | new.keys()):
        if key not in old or key not in new:
            if part in ("figures", "designer") and not ONLY:
                lines.append(f"{key}: {'is new' if key in new else 'is gone'}")
        elif part in ("figures", "designer"):
            lines += _figures_moved(key, old[key], new[key], "")
        else:
            lines += _record_moved(key, old[key], new[key])
    return lines


def _record_moved(key: str, old: dict[str, Any], new: dict[str, Any]) -> list[str]:
    if {old.get("outcome", old.get("verdict")), new.get("outcome", new.get("verdict"))} & UNSTEADY:
        return []
    exact = "| direct |" in key
    lines = []
    for name, was in old.items():
        now = new[name]
        if isinstance(was, float) and isinstance(now, float) and name != "limit":
            if name == "peak":
                allowed = EXACT * abs(was)
            else:
                allowed = EXACT if exact else max(ENGINE_FLOOR, ENGINE_SHARE * abs(was))
            same = abs(was - now) <= allowed or (math.isnan(was) and math.isnan(now))
        elif name in ("quantity", "invariant"):  # which one is worst may change where two are equally good
            same = True
        else:
            same = was == now
        if not same:
            lines.append(f"{key}: {name} {was} -> {now}")
    return lines


def _figures_moved(key: str, old: Any, new: Any, where: str, scale: float = 0.0) -> list[str]:
    """Leaf by leaf; ``scale`` is the largest number beside a leaf."""
    if isinstance(old, dict) and isinstance(new, dict):
        old, new = ({name: v for name, v in side.items() if name not in GONE} for side in (old, new))
    if isinstance(old, dict) and isinstance(new, dict) and old.keys() <= new.keys():
        scale = max((abs(v) for v in old.values() if isinstance(v, float)), default=0.0)
        return [line for name in old for line in _figures_moved(key, old[name], new[name], f"{where}.{name}", scale)]
    if isinstance(old, list) and isinstance(new, list) and len(old) == len(new):
        pairs = enumerate(zip(old, new, strict=True))
        return [line for i, (was, now) in pairs for line in _figures_moved(key, was, now, f"{where}[{i}]", scale)]
    return [] if _close(where, old, new, scale) else [f"{key}{where}: {old} -> {new}"]


def _close(where: str, old: Any, new: Any, scale: float) -> bool:
    if not (isinstance(old, (int, float)) and isinstance(new, (int, float))) or isinstance(old, bool):
        return bool(old == new)
    if any(word in where for word in BOUNDS):
        return new <= 3 * old + 1e-17
    if any(word in where for word in LOCATIONS):
        apart = abs(old - new)
        return min(apart, abs(apart - 360.0)) <= LOCATION
    return abs(old - new) <= CLOSED_FORM * max(abs(old), abs(new), scale)


def main() -> int:
    """Take or hold the parts named, all by default."""
    action, words = sys.argv[1], sys.argv[2:]
    only = [word.removeprefix("only=") for word in words if word.startswith("only=")]
    ONLY.extend(only)
    parts = [word for word in words if not word.startswith("only=")] or PARTS
    count = 0
    for part in parts:
        file = HERE / f"{part}.json.gz"
        records = globals()[part]()
        text = json.dumps(records, indent=0, sort_keys=True).replace(f"{ROOT}{os.sep}", "")  # wherever the tree lies
        records = json.loads(text)
        if action == "take":
            file.write_bytes(gzip.compress(text.encode(), mtime=0))
            print(f"{part}: {len(records)} records pinned")
            continue
        old = json.loads(gzip.decompress(file.read_bytes()))
        lines = moved(part, old, records)
        count += len(lines)
        print(f"{part}: {len(old)} pinned, {len(old.keys() & records.keys())} made, {len(lines)} moved")
        print("".join(f"  {line}\n" for line in lines), end="")
    return 1 if count else 0


if __name__ == "__main__":
    sys.exit(main())
