"""One pass in Ondsel: a simulation for each part of the motion, each from the poses in which the one before ended.

Data are the adapter's ``model``, in SI or the scene's own units. A course has ``parts`` of the motion, ``ratio`` steps
to a sample, and the ``channels`` to record. A part has its ``start`` and ``end``, s, a number of ``samples``, and a
``segment``: its own start, s, and φ's coefficients from then on, lowest power first.
"""

import math
import os
from collections.abc import Iterator
from contextlib import contextmanager
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
from numpy.typing import NDArray
from pyondsel.errors import AsmtError
from pyondsel.model.asmt_model import AsmtModel
from pyondsel.model.joint import Joint
from pyondsel.model.marker import Marker
from pyondsel.model.motion import Motion
from pyondsel.model.part import Part
from pyondsel.model.simulation import Simulation
from pyondsel.solve import solve_asmt

Array = NDArray[np.float64]
Data = dict[str, Any]
Rows = dict[tuple[str, str], Array]  # one number a frame, by path and label

KINEMATICS = {
    "position": ("X", "Y", "Bryantz"),
    "velocity": ("VX", "VY", "OmegaZ"),
    "acceleration": ("AX", "AY", "AlphaZ"),
}
NAME = "linkage"
TIMEOUT = 3600.0  # s, of the solver's process, which pyondsel starts for every solution


def build(given: Data) -> tuple[AsmtModel, Data]:
    """Ondsel's model in its start state, together with the data it was built from, the adapter's."""
    model = AsmtModel(NAME, gravity=given["gravity"])
    model.ground_markers += make_markers(given["ground"])
    for number, part in enumerate(given["parts"]):
        model.add_part(Part(f"part{number}", mass=part["mass"], moments_of_inertia=(part["inertia"],) * 3))
        model.parts[-1].markers += make_markers(part["markers"])
        set_pose(model.parts[-1], *part["pose"])
    for number, (kind, *ends) in enumerate(given["joints"]):
        model.add_joint(Joint(f"joint{number}", kind, *(f"/{NAME}/{end}" for end in ends), pitch=0.0))
    for name, number, kind in given["motions"]:
        model.add_motion(Motion(name, f"joint{number}", "", kind))
    return model, given


def make_markers(given: list[tuple[Any, Any]]) -> list[Marker]:
    """Ondsel's markers, named by number in their order, from pairs of a place, (x, y, z), m, and a matrix of axes."""
    return [Marker(f"marker{number}", *each) for number, each in enumerate(given)]


def set_pose(part: Part, x: float, y: float, angle: float) -> None:
    """Put a part's mass centre at x, y, m, and turn it to an angle, rad."""
    cosine, sine = math.cos(angle), math.sin(angle)
    part.position = (x, y, 0.0)
    part.rotation = ((cosine, -sine, 0.0), (sine, cosine, 0.0), (0.0, 0.0, 1.0))


def follow(world: tuple[AsmtModel, Data], course: Data) -> Data:
    """Solve all parts of a course and return its samples; at a border of parts the later part's counts.

    They are times, s, and values by channel, and by joint under "joint_force". The model's parts are left where the
    course ends. Raises ArithmeticError where Ondsel gives up or solves too few frames.
    """
    (model, given), parts = world, course["parts"]
    samples: Data = {name: ([], []) for name in course["channels"] if name != "joint_force"}
    forces: Data = {name: ([], []) for name in given["forces"]} if "joint_force" in course["channels"] else {}
    for part in parts:
        rows, selected = solve_part(model, part), slice(0, part["samples"] + (part is parts[-1]))
        # Ondsel adds its steps up: its times differ from whole steps in their last digits, which shows in the torque.
        time = (rows["", "Time"] - rows["", "Time"][0] + part["start"])[selected]
        values = {
            name: np.array([[rows[f"/{NAME}/{each.name}", label] for label in labels] for each in model.parts])
            for name, labels in KINEMATICS.items()
            if name == "position" or name in samples
        }
        for each, pose in zip(model.parts, values["position"][:, :, part["samples"]].tolist(), strict=True):
            set_pose(each, *pose)
        read = {name: np.moveaxis(values[name], 2, 0)[:, : len(given["angles"])] for name in values}
        read["torque"] = torque(given["line"], rows)
        for name, signal in samples.items():
            append_samples(signal, time, read[name][selected])
        for name, signal in forces.items():
            source, sign = given["forces"][name]
            x, y = (rows[f"/{NAME}/{source}", label] for label in ("FXonI", "FYonI"))
            append_samples(signal, time, sign * np.stack([x, y], axis=1)[selected])
    if "position" in samples:
        places = np.array(samples["position"][1])
        places[:, :, 2] = np.unwrap([given["angles"], *places[:, :, 2]], axis=0)[1:]
        samples["position"] = samples["position"][0], places
    return {**samples, "joint_force": forces}


def append_samples(signal: tuple[list[float], list[Any]], time: Array, values: Array) -> None:
    """Append times and values to a signal's lists, in place."""
    signal[0].extend(time)
    signal[1].extend(values)


def torque(line: tuple[int | None, complex] | None, rows: Rows) -> Array:
    """The drive's moment, N m, for None, or its force, N, along a line, at every frame, (frames,).

    The line is the number of the part it is fixed in, None for the ground, and its direction there, a complex number;
    ``rows`` are Ondsel's results.
    """
    path = f"/{NAME}/drive"
    if line is None:
        return -rows[path, "TZonI"]
    host, along = line
    turned = np.zeros(1) if host is None else rows[f"/{NAME}/part{host}", "Bryantz"]
    force = rows[path, "FXonI"] + 1j * rows[path, "FYonI"]
    return np.asarray(-(force * (along * np.exp(1j * turned)).conjugate()).real)


def solve_part(model: AsmtModel, part: Data) -> Rows:
    """Solve one part of the motion and return the rows of Ondsel's results, (frames,), by path and label.

    Sets the model's motions and simulation. Raises ArithmeticError where Ondsel gives up or solves too few frames.
    """
    zero, crank = part["segment"]
    # A flywheel's motion, if there is one, is against the crank: its whole angle is the integral of the crank's.
    turned = [0.0, *(each / power for power, each in enumerate(crank, 1))]
    flywheel = [whole - own for whole, own in zip(turned, [*crank, 0.0], strict=True)]
    for motion, coefficients in zip(model.motions, (crank, flywheel), strict=False):
        motion.expression = "+time*(".join(map(repr, coefficients)) + ")" * (len(coefficients) - 1)
    model.simulation = Simulation(part["start"] - zero, part["end"] - zero, part["samples"])
    try:
        # pyondsel writes "Pitch" where Ondsel reads "pitch" and gives up otherwise.
        with temporary_folder():  # its files have the same names in every process
            text = solve_asmt(model.to_asmt().replace("\tPitch\n", "\tpitch\n"), timeout=TIMEOUT)
    except AsmtError as error:
        raise ArithmeticError(f"Ondsel gave up: {error}") from error
    rows: Rows = {}
    path = ""
    for line in text.partition("TimeSeries\n")[2].splitlines():
        label, *cells = line.rstrip("\t").split("\t")
        if label.endswith("Series"):
            path = cells[0]
        else:
            rows[path, label] = np.array(cells[1:], dtype=float)  # the first column is the pose that was given
    # Ondsel ends early without a message where it has no solution or does not know a word.
    frames = min(map(len, rows.values()), default=0)
    if frames <= part["samples"]:
        raise ArithmeticError(f"Ondsel solved {frames} of {part['samples'] + 1} frames")
    return rows


@contextmanager
def temporary_folder() -> Iterator[None]:
    """In the block, have temporary files of this process and its children in a folder that is then deleted.

    TMPDIR is set to it and then put back.
    """
    before = os.environ.get("TMPDIR")
    with TemporaryDirectory() as folder:
        os.environ["TMPDIR"] = folder
        try:
            yield
        finally:
            del os.environ["TMPDIR"]
            if before is not None:
                os.environ["TMPDIR"] = before
