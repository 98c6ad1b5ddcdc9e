"""An Ondsel run as the text of a script: each part of the motion from the poses in which the one before ended."""

from __future__ import annotations

from engines.export.script import FORCE, row
from engines.ondsel_adapter import OndselWorld
from engines.scene import Scene
from engines.stepping.stepped_engine import Course, Recipe

TEXT = """
# Of each part of the motion: begin (s); start, end and number of frames of the simulation, whose clock is that of a
# piece of the crank's motion; the crank's angle as a polynomial of that clock, lowest power first.
PARTS = [
{parts}
]
BODIES = [{bodies}]
ANGLES = {angles}  # of these at the start
FORCES = {{  # path of the joint, sign of its force
{forces}
}}
MOTION = {{
    "position": ("X", "Y", "Bryantz"),
    "velocity": ("VX", "VY", "OmegaZ"),
    "acceleration": ("AX", "AY", "AlphaZ"),
}}
for begin, start, end, count, crank in PARTS:
    # A flywheel's motion, if there is one, is against the crank: its whole angle is the integral of the crank's.
    whole = [0.0, *(each / power for power, each in enumerate(crank, 1))]
    flywheel = [each - own for each, own in zip(whole, [*crank, 0.0])]
    for motion, angle in zip({model}.motions, (crank, flywheel)):
        motion.expression = "+time*(".join(map(repr, angle)) + ")" * (len(angle) - 1)
    {model}.simulation = {Simulation}(start, end, count)
    # pyondsel writes "Pitch" where Ondsel reads "pitch" and gives up otherwise.
    text = {solve_asmt}({model}.to_asmt().replace("\\tPitch\\n", "\\tpitch\\n"), timeout=3600.0)
    rows, path = {{}}, ""
    for line in text.partition("TimeSeries\\n")[2].splitlines():
        label, *cells = line.rstrip("\\t").split("\\t")
        if label.endswith("Series"):
            path = cells[0]
        else:
            rows[path, label] = np.array(cells[1:], dtype=float)  # the first column is the pose that was given
    frames = min(map(len, rows.values()), default=0)
    if frames <= count:
        raise SystemExit(f"Ondsel solved {{frames}} of {{count + 1}} frames from {{begin}} s on")
    kept = slice(0, count + (begin == PARTS[-1][0]))
    time = (rows["", "Time"] - rows["", "Time"][0] + begin)[kept]
    for name, labels in MOTION.items():
        values = np.array([[rows["/linkage/" + part.name, label] for label in labels] for part in {model}.parts])
        keep(name, time, np.moveaxis(values, 2, 0)[kept, : len(BODIES)])
        if name == "position":
            for part, (x, y, angle) in zip({model}.parts, values[:, :, count].tolist()):
                part.position = (x, y, 0.0)
                cosine, sine = math.cos(angle), math.sin(angle)
                part.rotation = ((cosine, -sine, 0.0), (sine, cosine, 0.0), (0.0, 0.0, 1.0))
    keep("torque", time, -rows["/linkage/drive", "TZonI"][kept])
    for name, (path, sign) in FORCES.items():
        keep(name, time, sign * np.stack([rows[path, "FXonI"], rows[path, "FYonI"]], axis=1)[kept])
places = np.array(samples["position"][1])
places[:, :, 2] = np.unwrap([ANGLES, *places[:, :, 2]], axis=0)[1:]
samples["position"] = samples["position"][0], places
"""


def text(scene: Scene, world: OndselWorld, course: Course[Recipe], followed: OndselWorld) -> str:
    """The text of a pass."""
    from pyondsel.model.simulation import Simulation
    from pyondsel.solve import solve_asmt

    parts = []
    for part in course.parts:
        segment = part.segment
        assert segment is not None  # the drive is prescribed
        crank = [*map(float, segment.coefficients)]
        parts.append(row((part.start, part.start - segment.start, part.end - segment.start, part.samples, crank)))
    bodies = scene.bodies
    return TEXT.format(
        parts="\n".join(parts),
        bodies=", ".join(str(world.parts[body.name]) for body in bodies),
        angles=[float(body.angle) for body in bodies],
        forces="\n".join(row(source, FORCE + name) for name, source in world.sources.items()),
        model=world.model,
        Simulation=Simulation,
        solve_asmt=solve_asmt,
    )
