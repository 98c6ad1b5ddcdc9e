"""Pictures: charts described as data and drawn by matplotlib, kinematic schemes that stand and move."""

import logging

logging.getLogger("matplotlib").setLevel(logging.ERROR)  # of a home that cannot be written it would tell twice
