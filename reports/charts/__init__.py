"""Pictures drawn by matplotlib: figures in the looks of the house, and kinematic schemes."""

import logging

logging.getLogger("matplotlib").setLevel(logging.ERROR)  # of a home that cannot be written it would tell twice
