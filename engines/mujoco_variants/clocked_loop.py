"""A model that C MuJoCo compiles, stepped by another implementation, and read by C MuJoCo's world again.

MJX calls nothing back at the stages of a step, as C MuJoCo does for its drive. A clock drives instead: a body too heavy
to be held up, set at every step to where the motion is then, which the driven joint has to follow. Loads are set at
every sample, at the state that is read.

Data are the adapter's ``model``, in SI or the scene's own units. A course has ``parts`` of the motion, ``ratio`` steps
to a sample, the ``channels`` to record and ``details`` to report in. A part has its ``start`` and ``end``, s, a number
of ``samples``, and a ``segment``: its own start, s, and φ's coefficients from then on, lowest power first.
"""

from abc import ABC, abstractmethod
from collections.abc import Iterator
from math import ceil
from typing import Any

import mujoco
import numpy as np

from engines.mujoco_loop import READ, Array, Data, MujocoWorld, follow

__all__ = ["READ", "SET", "Array", "ClockedWorld", "Data", "follow"]

SET = ("qpos", "qvel", "qfrc_applied", "xfrc_applied")  # the clock's coordinate is the last


class ClockedWorld(MujocoWorld, ABC):
    """A world of C MuJoCo with a clock, filled with what the other implementation computes."""

    state: Any
    device: str
    lead = 0  # time constants by which the other starts earlier, for its loops to lag as they will

    @abstractmethod
    def begin(self) -> None:
        """Hand C MuJoCo's model, with the step it has now, to the variant."""

    @abstractmethod
    def advance(self, motion: Array) -> None:
        """Take a step for each row, the clock's angle, rad, speed and torque, N m, and fill C MuJoCo's data."""

    @abstractmethod
    def compute(self, settled: bool) -> None:
        """Copy the state named in ``SET`` from C MuJoCo; if ``settled``, compute its forces and fill C's data."""

    def fill(self, values: Data, forces: Array) -> None:
        """Copy the ``values`` named in READ, and the constraints' forces in C MuJoCo's order, into C MuJoCo's data."""
        for name in READ[:-1]:
            getattr(self.data, name)[:] = values[name]
        self.data.efc_force[:] = forces

    def states(self, part: Data, course: Data, warnings: list[str]) -> Iterator[tuple[Any, ...]]:
        """Step through a part and yield its samples as ``read`` returns them; ``warnings`` are left alone.

        A part that starts at 0 s begins ``lead`` time constants earlier, without samples. Names the device in the
        course's ``details`` once all samples are taken.
        """
        model, data, ratio, settle = self.model, self.data, course["ratio"], self.given["settle"]
        sample, lead = (part["end"] - part["start"]) / part["samples"], 0 if part["start"] else ceil(self.lead * settle)
        step = sample / ratio
        instants = part["start"] + step * np.arange(-lead * ratio, part["samples"] * ratio + 1)
        if lead:  # C MuJoCo, which does not lag, steps back
            model.opt.timestep, model.eq_solref[:, 0] = -step, 100.0 * step
            mujoco.set_mjcb_control(self.control(part["segment"]))
            mujoco.mj_step(model, data, nstep=lead * ratio)
            mujoco.set_mjcb_control(None)
        model.opt.timestep, model.eq_solref[:, 0] = step, settle * sample or 0.02  # s, as shipped
        self.begin()
        zero, coefficients = part["segment"]
        angle, inertia = np.poly1d(coefficients[::-1]), model.dof_M0[-1]
        values, speed, acceleration = (angle.deriv(order)(instants - zero) for order in range(3))
        motion = np.column_stack([values - self.given["start"], speed, inertia * acceleration])
        steps = np.column_stack([motion[:-1, :2], inertia * np.diff(speed) / step]).reshape(-1, ratio, 3)
        set_loads = self.control(None)
        for number, instant in enumerate(instants[::ratio].tolist()):
            if number:
                self.advance(steps[number - 1])
            data.qpos[-1], data.qvel[-1], data.qfrc_applied[-1] = motion[number * ratio]
            if set_loads:
                mujoco.mj_fwdPosition(model, data)
                mujoco.mj_fwdVelocity(model, data)
                set_loads(model, data)
            self.compute(settle > 0.0)
            if number >= lead:
                yield self.read(instant)
        course["details"]["device"] = self.device
