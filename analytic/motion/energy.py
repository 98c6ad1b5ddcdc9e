"""The energy of a released crank's motion against the work done on it: a check that needs no equation of motion."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from analytic.dynamics import reduced
from analytic.kinematics.sweep import Sweep
from analytic.motion.released import NODES, FreeMotion
from analytic.numerics.collocation import gauss_scheme


def energy_imbalance(motion: FreeMotion) -> float:
    """Largest gap between the energy gained and the work of torque, forces and damping, over the energy scale.

    Energies come from the closed form at the angles and speeds of the motion, the work from Gauss quadrature along it;
    neither uses ½ Jeq' or the equation of motion. A wrong model shows here, since it violates conservation of energy.
    """
    mechanism, starts = motion.equation.mechanism, motion.windows.starts
    ends = mechanism.sweep(motion.angle(starts))
    kinetic, potential = reduced.kinetic_energy(ends, motion.speed(starts)), reduced.potential_energy(ends)
    gained = kinetic + potential - (kinetic[0] + potential[0])
    scheme = gauss_scheme(NODES)
    time = starts[:-1, None] + np.diff(starts)[:, None] * scheme.nodes
    work = np.append(0.0, np.cumsum(np.diff(starts) * (_power(motion, time) @ scheme.end_once)))
    at_play = np.max(kinetic) + np.ptp(potential) + np.max(np.abs(work))
    return float(np.max(np.abs(gained - work)) / at_play) if at_play > 0.0 else 0.0


def _power(motion: FreeMotion, time: NDArray[np.float64]) -> NDArray[np.float64]:
    """Power of the torque, the forces and the damping, which the potential energy does not include, W."""
    mechanism, angle, speed = motion.equation.mechanism, motion.angle(time), motion.speed(time)
    linkage = replace(mechanism.linkage, springs=(), dampers=())
    force = reduced.load_force(Sweep(linkage, mechanism.structure, angle)) + motion.equation.torque(angle)[0]
    if motion.equation.over_time is not None:
        force = force + motion.equation.over_time(time)
    return np.asarray((force - reduced.damping_coefficient(mechanism.sweep(angle)) * speed) * speed)
