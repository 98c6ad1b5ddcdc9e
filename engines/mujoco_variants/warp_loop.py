"""One pass in MuJoCo Warp, in single precision: kernels, launched one after another, at every stage of a step."""

import mujoco_warp
import numpy as np
import warp

from engines.mujoco_variants.clocked_loop import READ, SET, Array, ClockedWorld, Data, follow

__all__ = ["build", "follow"]


class WarpWorld(ClockedWorld):
    """A world of MuJoCo Warp, whose kernels are compiled before its first step."""

    def __init__(self, given: Data) -> None:
        """Put the model and the start state on Warp's device and compile the step by taking one on a copy.

        Raises ArithmeticError if MuJoCo refuses the model.
        """
        super().__init__(given)
        self.device = warp.get_preferred_device().name
        self.begin()
        self.state = self.start()
        mujoco_warp.step(self.other, self.start())  # compiles

    def start(self) -> mujoco_warp.Data:
        """A new copy of the start state, C MuJoCo's present one, on Warp's device."""
        return mujoco_warp.put_data(self.model, self.data, nconmax=1, njmax=self.data.nefc)

    def begin(self) -> None:
        """Hand C MuJoCo's model, with its present step, to Warp.

        If the recipe settles, constraints are made anew at every stage.
        """
        self.other = mujoco_warp.put_model(self.model)
        if self.given["settle"]:  # else J'q' is that of the stage before, and Runge-Kutta's method of first order
            self.other.callback.control = mujoco_warp.make_constraint

    def advance(self, motion: Array) -> None:
        """Take a step of Warp for each row of the clock's motion: angle, rad, speed, rad/s, and torque, N m.

        Then fill C MuJoCo's data.
        """
        for row in motion:
            for name, value in zip(SET, row, strict=False):
                values = getattr(self.state, name).numpy()
                values[0, -1] = value
                getattr(self.state, name).assign(values)
            mujoco_warp.step(self.other, self.state)
        self.fetch()

    def compute(self, settled: bool) -> None:
        """Copy the state from C MuJoCo to Warp; if ``settled``, compute its forces and copy them back."""
        for name in SET:
            getattr(self.state, name).assign(getattr(self.data, name)[None])
        if settled:
            mujoco_warp.forward(self.other, self.state)
            self.fetch()

    def fetch(self) -> None:
        """Copy the variant's state into C MuJoCo's data, constraint rows reordered: a GPU keeps no order."""
        efc = self.state.efc
        order = np.argsort(efc.id.numpy()[0, : self.data.nefc], kind="stable")
        self.fill({name: getattr(self.state, name).numpy()[0] for name in READ[:-1]}, efc.force.numpy()[0, order])


build = WarpWorld
