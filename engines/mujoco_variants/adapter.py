"""MJX and MuJoCo Warp: the model of C MuJoCo's adapter, driven by a clock, in single and in double precision.

**MJX** lacks the term J'q' of a constraint's reference acceleration. So a loop lags behind by the square of the
constraints' time constant, whatever the step, and that cannot be much below 2.5 steps: steps have to be short. In
single precision the rounding of positions, divided by the square of the time constant, ends that.

**MuJoCo Warp**, in single precision alone, has the term, but that of the stage before, and its Runge-Kutta method is of
first order. The control callback, which runs at every stage, makes the constraints anew: the order is C MuJoCo's again.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from typing import Any
from xml.etree.ElementTree import Element, SubElement, indent

from analytic.description.linkage import DriverKind
from engines.contract import Setting
from engines.mechanics.joints import scene_size
from engines.mujoco_adapter import MujocoEngine, MujocoModel, MujocoRecipe
from engines.scene import Prescribed, Scene

HEAVY = 1e8  # of the scene's mass and its size squared: the clock's inertia
SETTINGS = (Setting.NAIVE, Setting.TUNED)


# Mutants of the conformance test that change less than the limits of both leave open, then of MJX.
UNSEEN = tuple(f"four-bar: {fault}" for fault in ("a pin 0.1 mm out of place", "the crank 0.01° out of place"))
MJX_UNSEEN = (
    "four-bar at speed: gravity 0.1 % too small",
    *(f"{name} at speed: start velocities of the middle of the first step" for name in ("four-bar", "slider-crank")),
)


def expected(mutants: Iterable[str]) -> dict[str, str]:
    """The names of the conformance test's checks for these mutants, each with the reason why it is expected to fail."""
    return {f"mutant: {name}": "it changes less than this engine's error" for name in mutants}


@dataclass(frozen=True, kw_only=True)
class VariantRecipe(MujocoRecipe):
    """In single precision a softness below MuJoCo's own is lost in rounding; ``precision`` is f32 or f64."""

    settle: float = 2.5
    harder: float = 1.0
    precision: str = "f32"


NEWCOMER = VariantRecipe(step=1e-3, integrator="Euler", settle=0.0, in_own_units=False)
EXPERT = VariantRecipe(steps_per_turn=160, ratios=(5,), settle=0.5, harder=1e-7, precision="f64")
WARP = VariantRecipe(steps_per_turn=200, settle=3.0, harder=10.0)


class ClockedModel(MujocoModel):
    """The model with a clock, a body whose hinge the driven joint follows."""

    def xml(self, recipe: MujocoRecipe) -> Element:
        """MuJoCo's XML with a clock: a heavy body whose angle the driven joint follows by an equality."""
        root = super().xml(recipe)
        inertia = HEAVY * sum(body.mass for body in self.scene.bodies) * scene_size(self.scene) ** 2
        clock = SubElement(next(root.iter("worldbody")), "body", name="/clock")
        SubElement(clock, "inertial", pos="0 0 0", mass="1", diaginertia=f"{inertia:.17g} " * 3)
        SubElement(clock, "joint", name="/clock", axis="0 0 1")
        root.findall("equality/joint")[0].attrib |= {"joint2": "/clock", "polycoef": "0 1 0 0 0"}
        next(root.iter("flag")).attrib.clear()  # Warp has no such flag
        indent(root)
        return root


class MjxEngine(MujocoEngine):
    """Prescribed drivers alone: a free crank's 160 turns would take an hour."""

    name = "mjx"
    package = "mujoco.mjx"
    distribution = "mujoco-mjx"
    oldest = "3.17"
    loop = "engines.mujoco_variants.mjx_loop"
    chatters = True
    expected_failures = expected((*UNSEEN, *MJX_UNSEEN))
    abilities = replace(
        MujocoEngine.abilities,
        drives=frozenset({Prescribed}),
        timed_torque=False,
        friction=False,
        settings=frozenset(SETTINGS),
    )
    settings: Mapping[type, Mapping[Setting, MujocoRecipe]] = {
        Prescribed: dict(zip(SETTINGS, (NEWCOMER, EXPERT), strict=True))
    }
    studied: Mapping[str, tuple[str, MujocoRecipe]] = {
        "defaults": ("Euler and all else as MuJoCo has it, in single precision, read as a step leaves it", NEWCOMER),
        "f32": ("RK4 in single precision, constraints of 2.5 steps", VariantRecipe(harder=100.0)),
        "f64": ("RK4 in double precision, constraints of 2.5 steps", VariantRecipe(harder=1e-7, precision="f64")),
    }

    def model(self, scene: Scene, recipe: MujocoRecipe) -> Mapping[str, Any]:
        """The scene as plain data by name for the loop of a variant, with its precision, and steps to a sample."""
        assert isinstance(recipe, VariantRecipe)
        model = ClockedModel(scene, recipe).as_data(recipe)
        return {**model, "precision": recipe.precision, "ratio": recipe.ratios[0]}


class WarpEngine(MjxEngine):
    """The same in single precision alone."""

    name = "mujoco-warp"
    package = "mujoco_warp"
    distribution = "mujoco-warp"
    oldest = "4.0"
    loop = "engines.mujoco_variants.warp_loop"
    expected_failures = expected(UNSEEN)
    # A cylinder's rod has next to no mass, which single precision loses.
    abilities = replace(MjxEngine.abilities, drivers=frozenset({DriverKind.CRANK, DriverKind.SLIDER}))
    settings: Mapping[type, Mapping[Setting, MujocoRecipe]] = {
        Prescribed: dict(zip(SETTINGS, (NEWCOMER, WARP), strict=True))
    }
    studied: Mapping[str, tuple[str, MujocoRecipe]] = {
        "defaults": MjxEngine.studied["defaults"],
        "f32": ("RK4, constraints of 3 steps, made anew at every stage", VariantRecipe(settle=3.0, harder=10.0)),
    }
