"""Commands and options of linkproof 1.0 that are gone, each with what to do instead, in a sentence."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from typing import Final

COMMANDS: Final = {
    "show": "use linkproof check",
    "schema": "use linkproof new, which writes the schema beside the linkage file",
    "thread": "use linkproof results, which shows a thread's feed; a required feed stands in the linkage's file",
    "published": "use linkproof check NAME, which says how many of the printed figures hold",
    "check-engine": "use linkproof engines NAME --check",
    "doctor": "use linkproof engines --try",
    "export": "use linkproof compare with --script FILE",
    "diff": "use linkproof compare with --against FOLDER",
    "report": "use linkproof compare, bench or stress with --out DIR alone",
    "verify": "gone; linkproof compare with --against FOLDER computes a folder's results anew and shows what differs",
    "merge": "gone; keep a folder for each machine, and compare two with linkproof compare --against FOLDER",
}
STEADY: Final = (
    "designs are compared at constant speed; leave it out, or see one design under that motion by linkproof results "
    "--regime NAME"
)
# Options of every command that had them, then those of a command with another answer.
OPTIONS: Final = {
    **{f"--{kind}": f"use --save FILE.{kind}" for kind in ("csv", "xlsx", "svg", "png", "pdf", "dxf")},
    "--json": "takes no file and prints on stdout; --save FILE.json writes a file",
    "--gif": "gone; the page that --out writes shows the linkage in motion",
    "--resume": "gone; repeat the command with the same --out, and it goes on",
    "--angles": "gone; signals are sampled at 180 crank angles",
    "--simulate": "gone; run linkproof compare on the file of a design",
    "--write-mapping": "gone; --map names a column, and the output shows what was read",
    "--mapping": "use --map 'COLUMN=SIGNAL [UNIT]', or --map FILE with one such line a column",
    "--figures": "use linkproof list MECHANISM",
    "--numbers": "use linkproof list MECHANISM",
    "--port": "gone; the page has a free port, which is printed",
    "--baseline": "use --against FILE",
    "--record-baseline": "use --record FILE",
    "--allow-new": "gone; what --against does not have is a note and no failure",
    "--allow-missing": "gone; --against compares only the engines and motions that are asked for",
    "--clockwise": "gone; a negative --speed turns clockwise",
    "--full": "gone; --setting naive --setting tuned --setting best runs the files' regimes in every setting, too",
    "--costs": "gone; time an output or a load by two runs, with and without it",
    "sweep --regime": STEADY,
    "optimise --regime": STEADY,
    "tolerance --regime": STEADY,
    "sweep --out": "use --save FILE.nc for every design, and --save FILE.svg for the picture",
    "sweep --resume": "gone; a sweep is in memory: repeat the command",
    "bench --scheduler": "gone; a benchmark runs on this machine",
    "sweep --scheduler": "gone; linkproof.sweep takes Dask arrays in Python",
    "sweep --designs": "gone with --simulate; run linkproof compare on the file of a design",
    "sweep --seed": "gone with --simulate; run linkproof compare on the file of a design",
    "sweep --jobs": "gone; a sweep takes all processor cores",
    "optimise --out": "use --save FILE.toml for the new linkage, --save FILE.svg for the curves",
    "optimise --starts": "gone; --global searches the whole region within the bounds",
    "optimise --seed": "gone; --global searches the whole region within the bounds",
    "tolerance --seed": "gone; the random designs are the same every time",
    "stress --time-limit": "gone; a cell may take the time of its map",
}


def answer_to_command(name: str) -> str:
    """The sentence about a command that is gone."""
    return f"{name}: {COMMANDS[name]}"


def answer_to_option(command: str, option: str) -> str:
    """The sentence about an option of a command that is gone; empty for any other."""
    answer = OPTIONS.get(f"{command} {option}", OPTIONS.get(option))
    return f"{option}: {answer}" if answer else ""


def answer_to_json_file(words: Sequence[str]) -> str:
    """The sentence about a file, or - for stdout, after --json, which is a flag now; empty without."""
    for word, file in pairwise(words):
        if word == "--json" and (file == "-" or file.lower().endswith(".json")):
            return answer_to_option("", word)
    return ""
