"""One pass in MJX: the steps between two samples are one compiled function, what is read at a sample another."""

from collections.abc import Iterator
from typing import Any

import jax
import numpy as np
from mujoco import mjx

from engines.mujoco_variants.clocked_loop import SET, Array, ClockedWorld, Data, follow

__all__ = ["build", "follow"]


def after_steps(model: mjx.Model, state: mjx.Data, motion: jax.Array) -> mjx.Data:
    """The state after one step by each row of ``motion``: the clock's angle, rad, speed, rad/s, and torque, N m.

    The state that is given stays as it is.
    """

    def step(state: mjx.Data, row: jax.Array) -> tuple[mjx.Data, None]:
        """Set the clock by a row of its motion and take one step, in the form of ``jax.lax.scan``: the state and None.

        The clock is the body that leads the crank; a row has its angle, rad, speed, rad/s, and torque, N m.
        """
        clock = {name: getattr(state, name).at[-1].set(value) for name, value in zip(SET[:3], row, strict=True)}
        after = mjx.step(model, state.replace(**clock))
        # In double precision MJX 3.17 makes an integer of tendons longer, which a scan does not take.
        return jax.tree.map(lambda new, old: new.astype(old.dtype), after, state), None

    return jax.lax.scan(step, state, motion)[0]


stepped, forward = jax.jit(after_steps), jax.jit(mjx.forward)


class MjxWorld(ClockedWorld):
    """A world in single or double precision, whose functions are compiled before its first step."""

    lead = 12
    compiled = ""  # the precision of what JAX holds compiled

    def __init__(self, given: Data) -> None:
        """Put the model and the start state on JAX's device and compile the step.

        JAX's caches are cleared where the precision is another than the last world's. Raises ArithmeticError if MuJoCo
        refuses the model.
        """
        super().__init__(given)
        if MjxWorld.compiled not in ("", given["precision"]):
            jax.clear_caches()  # JAX 0.10 mixes constants of both up in what it has traced
        MjxWorld.compiled = given["precision"]
        self.device = jax.devices()[0].device_kind
        with jax.enable_x64(given["precision"] == "f64"):
            self.begin()
            self.state = start = mjx.put_data(self.model, self.data)
            jax.block_until_ready(
                (stepped(self.other, start, np.zeros((given["ratio"], 3))), forward(self.other, start))
            )

    def begin(self) -> None:
        """Hand C MuJoCo's model, with the step it has now, to MJX."""
        self.other = mjx.put_model(self.model)

    def advance(self, motion: Array) -> None:
        """Take a step of MJX for each row of the clock's motion, angle, speed and torque; then fill C MuJoCo's data."""
        self.state = stepped(self.other, self.state, motion)
        self.fetch()

    def compute(self, settled: bool) -> None:
        """Copy the state from C MuJoCo to MJX; if ``settled``, compute its forces and copy them back."""
        self.state = self.state.replace(**{name: jax.numpy.array(getattr(self.data, name)) for name in SET})
        if settled:
            self.state = forward(self.other, self.state)
            self.fetch()

    def fetch(self) -> None:
        """Copy the variant's state into C MuJoCo's data, constraint rows reordered: the drive's is its last."""
        values = vars(self.state) | vars(self.state._impl)
        self.fill(values, np.roll(values["efc_force"], 1))

    def states(self, part: Data, course: Data, warnings: list[str]) -> Iterator[tuple[Any, ...]]:
        """Step through a part in the model's precision and yield its samples as ``read`` returns them.

        ``warnings`` are left alone.
        """
        with jax.enable_x64(self.given["precision"] == "f64"):
            yield from super().states(part, course, warnings)


build = MjxWorld
