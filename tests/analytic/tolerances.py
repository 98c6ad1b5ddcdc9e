"""What the reference has to hold, each limit with its reason; relative to the peak unless it says otherwise."""

import numpy as np

EPS = float(np.finfo(float).eps)

# The reference judges engines that reach 1e-7 and a second derivation held to 1e-12: it must not be felt there.
FIFTY_DIGITS = 1e-12
# What the fifty digits themselves lose to differences over 1e-12 rad, m: far below any rounding of a double.
ORACLE = 1e-22
# The needle mechanisms themselves, of moderate transmission angles, leave a few roundings only.
FEW_ROUNDINGS = 64 * EPS
# Ends of a joint apart, over the largest coordinate: either end is a sum of two or three rounded vectors.
CLOSURE = 8 * EPS
# A mirrored, turned or shifted drawing rounds differently; its figures are conditioned by the transmission angle.
SAME_FIGURES = 1e-12
# Trapezoid sums of smooth periodic functions converge beyond rounding; what is left is the rounding of the terms.
FULL_TURN_WORK = 1e-14
# Differences over a step h of 1e-3 rad by a seven-point formula err by h^6.
DIFFERENCED = 1e-9
# A bound that is to be believed may exceed the true error, but not by more than this.
BOUND_OVER_ERROR = 1e3
