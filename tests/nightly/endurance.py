"""A campaign killed again and again, at random moments, and resumed each time: what is lost of it, what is doubled.

``python -m tests.nightly.endurance TIMES [SEED]`` measures it. Every attempt is a process forked from one that
has imported everything, so that hundreds take a minute; most use workers forked likewise, some the usual server.
"""

from __future__ import annotations

import contextlib
import ctypes
import json
import os
import random
import signal
import subprocess
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Iterable, Iterator
from dataclasses import asdict, dataclass
from pathlib import Path

from analytic.description.crank_motion import REGIMES, crank_motion
from analytic.description.loading import catalogue, load
from comparisons.campaign.campaign import CampaignRequest, compare, sheets
from comparisons.campaign.results import COMPARE, Results, document, save
from comparisons.campaign.results import load as load_results
from comparisons.datasheet.saved import FILE as SHEETS
from comparisons.judging.records import RunRecord
from comparisons.runs.record_file import RECORDS
from comparisons.runs.study import Journal
from comparisons.runs.worker_process import START
from comparisons.runs.workers import LocalPool
from engines.contract import Setting

COMMAND = "linkproof compare --regime all --engine direct"
# Short, slow motions and two of the quantities: a run takes milliseconds, its journal no less than any other's.
QUANTITIES = ("Jeq", "Mkr")
SPEED, RAMP_TIME, HOLD_TIME = 10.0, 0.03, 0.01  # rad/s, s, s
PROCESSES = 2
# One attempt in this many starts its workers as the command does; importing anew, it takes ten times as long.
SERVED = 8
# A kill comes when so many runs are saved, and then after a pause of random length with this mean, s: somewhere in the
# runs after them, at the start before the first or in the writing after the last.
PAUSE = 0.06
# Numbers drawn below 0 every journal has at once; those above RUNS none ever reaches, so that attempts finish.
BEYOND = 2
RUNS = len(catalogue()) * len(REGIMES)
# Seconds that processes are given to notice their parent's death.
PATIENCE = 600.0
UNSTEADY = ("seconds", "setup_seconds")  # fields of a record that differ from run to run
_PR_SET_CHILD_SUBREAPER = 36


@dataclass(frozen=True)
class Endurance:
    """Result of ``kills`` over so many ``campaigns``, each finished in the end and compared with an undisturbed one.

    ``lost`` counts records and curves that are missing or differ in anything but their timings, ``doubled`` those
    there more than once, ``survivors`` worker processes that outlived their campaign, ``litter`` files left over.
    ``stages`` says how many kills came before the first run was saved, among them, and after the last.
    """

    kills: int
    campaigns: int
    lost: int
    doubled: int
    survivors: int
    litter: int
    stages: dict[str, int]


def measure(times: int, seed: int = 0) -> Endurance:
    """Kill campaigns ``times`` times at random moments, resume them until they finish, and hold their records.

    Runs in a process of its own, which has no threads when it forks. POSIX only.
    """
    command = [sys.executable, "-m", "tests.nightly.endurance", str(times), str(seed)]
    environment = {**os.environ, "OPENBLAS_NUM_THREADS": "1", "PYTHONPATH": os.pathsep.join(filter(None, sys.path))}
    done = subprocess.run(command, capture_output=True, text=True, env=environment, check=True)
    return Endurance(**json.loads(done.stdout))


def request() -> CampaignRequest:
    """Every mechanism of the catalogue under every prescribed regime in the direct engine, tuned; no invariants."""
    motions = tuple(crank_motion(name, speed=SPEED, ramp_time=RAMP_TIME, hold_time=HOLD_TIME) for name in REGIMES)
    linkages = tuple(load(name) for name in catalogue())
    return CampaignRequest(linkages, motions, "brief", ("direct",), (Setting.TUNED,), QUANTITIES, with_invariants=False)


def run_campaign(folder: Path, processes: int) -> None:
    """The campaign as the command runs it: resumed from its journal, every finished run saved, then written at once."""
    given, journal = request(), Journal(folder, COMMAND)
    results = list(compare(given, pool=LocalPool(processes), journal=journal))
    save(folder, document(given, COMMAND), results, sheets(given, processes=processes))
    journal.clear()


@dataclass
class _KilledCampaigns:
    """Kills so far and what they did."""

    folder: Path
    chance: random.Random
    kills: int = 0
    survivors: int = 0

    def __post_init__(self) -> None:
        self.stages: Counter[str] = Counter()

    def undisturbed(self) -> Results:
        """A campaign without kills, run in this process, which imports everything."""
        run_campaign(self.folder / "undisturbed", 0)
        return load_results(self.folder / "undisturbed")

    def campaign(self, folder: Path, times: int) -> Results:
        """One campaign, resumed until it is finished, killed on the way as long as there are fewer than ``times``."""
        while not self._attempt(folder, self._pieces(folder) if self.kills < times else RUNS + BEYOND):
            pass
        return load_results(folder)

    def _pieces(self, folder: Path) -> int:
        """Number of saved runs at which the next kill comes."""
        return max(len(Journal(folder, COMMAND).records), self.chance.randint(-BEYOND, RUNS + BEYOND))

    def _attempt(self, folder: Path, pieces: int) -> bool:
        """Whether an attempt finished, rather than being killed when so many runs were saved."""
        served, pause = self.chance.randrange(SERVED) == 0, self.chance.expovariate(1.0 / PAUSE)
        child = os.fork()
        if child == 0:
            _be_the_campaign(folder, served)
        status = _kill_later(child, folder, pieces, pause)
        self.survivors += _survivors(child)
        if os.WIFSIGNALED(status):
            self.kills += 1
            self.stages[_stage(folder)] += 1
        elif status:
            raise RuntimeError((folder / "error.txt").read_text(encoding="utf-8"))
        return status == 0


def _kill_later(child: int, folder: Path, pieces: int, pause: float) -> int:
    """Exit status of a process that is killed a while after so many runs are saved, unless it ends before."""
    place, moment = Journal(folder, COMMAND).place, float("inf")
    while True:
        done, status = os.waitpid(child, os.WNOHANG)
        if done:
            return status
        if moment == float("inf") and _kept(place) >= pieces:
            moment = time.perf_counter() + pause
        if time.perf_counter() > moment:
            os.kill(child, signal.SIGKILL)
            return os.waitpid(child, 0)[1]
        time.sleep(1e-3)


def _kept(place: Path) -> int:
    """How many runs a journal's folder holds."""
    with contextlib.suppress(FileNotFoundError):
        return (place / RECORDS).read_bytes().count(b"\n")
    return 0


def _be_the_campaign(folder: Path, served: bool) -> None:
    """Run the campaign in a forked process, in a session of its own, by which its workers are recognised."""
    code = 1
    try:
        os.setsid()
        os.environ[START] = "forkserver" if served else "fork"
        run_campaign(folder, PROCESSES)
        code = 0
    except BaseException as error:
        (folder / "error.txt").write_text(repr(error), encoding="utf-8")
    finally:
        os._exit(code)


def _stage(folder: Path) -> str:
    pieces = Journal(folder, COMMAND).records.keys
    if len(pieces) == RUNS:
        return "all saved"
    return "some saved" if pieces else "none saved"


def _survivors(session: int) -> int:
    """Processes of a session that live on after a while; the dead are reaped."""
    patience = time.monotonic() + PATIENCE
    while True:
        with contextlib.suppress(ChildProcessError):
            while os.waitpid(-1, os.WNOHANG)[0]:
                pass
        alive = sum(1 for _ in _of_session(session))
        if not alive or time.monotonic() > patience:
            return alive
        time.sleep(1e-3)


def _of_session(session: int) -> Iterator[int]:
    for entry in Path("/proc").iterdir():
        if entry.name.isdigit():
            with contextlib.suppress(OSError):
                # after the name in brackets: state, parent, group, session
                state, _, _, found = entry.joinpath("stat").read_text(encoding="utf-8").rpartition(")")[2].split()[:4]
                if int(found) == session and state != "Z":
                    yield int(entry.name)


def losses(expected: Iterable[RunRecord], got: Iterable[RunRecord]) -> tuple[int, int]:
    """Records and curves that ``got`` lacks or has otherwise, and those that it has more than once or should not."""
    right, found = _contents(expected), _contents(got)
    lost = sum(content not in found.get(name, []) for name, (content,) in right.items())
    doubled = sum(len(contents) - (name in right) for name, contents in found.items())
    return lost, doubled


def _contents(runs: Iterable[RunRecord]) -> dict[str, list[bytes]]:
    """Every record without its unsteady fields, and every curve, by its name: run and quantity."""
    contents: dict[str, list[bytes]] = {}
    for run in runs:
        for record in run.every:
            steady = {name: value for name, value in asdict(record).items() if name not in UNSTEADY}
            name = "/".join(("record", *record.run, record.quantity))
            contents.setdefault(name, []).append(json.dumps(steady).encode())
        for quantity, curve in run.curves.items():
            contents.setdefault("/".join(("curve", *run.run, quantity)), []).append(curve.tobytes())
    return contents


def main(times: int, seed: int) -> Endurance:
    """Measure, in a process without threads."""
    ctypes.CDLL(None).prctl(_PR_SET_CHILD_SUBREAPER, 1)  # orphaned workers become ours, to be seen and reaped
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        killed = _KilledCampaigns(folder, random.Random(seed))
        expected = killed.undisturbed()
        lost = doubled = litter = campaigns = 0
        while killed.kills < times:
            place = folder / str(campaigns)
            missing, surplus = losses(expected.runs, killed.campaign(place, times).runs)
            campaigns += 1
            lost, doubled = lost + missing, doubled + surplus
            litter += len({path.name for path in place.iterdir()} - {COMPARE, SHEETS})
        made = killed
        return Endurance(made.kills, campaigns, lost, doubled, made.survivors, litter, dict(made.stages))


if __name__ == "__main__":
    sys.stdout.write(json.dumps(asdict(main(int(sys.argv[1]), int((sys.argv[2:] or ["0"])[0])))) + "\n")
