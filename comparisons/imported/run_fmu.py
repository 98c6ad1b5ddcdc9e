"""A script of its own process: run an FMU over its default experiment.

``arrays.npz`` gets the ``names`` and ``units`` (k,) of the time and the outputs, and ``values`` (n, k). Where a model
declares no outputs, all that varies is read. What is wrong goes to standard error, in a sentence.
"""

import sys

import numpy as np
from fmpy import read_model_description, simulate_fmu
from numpy.lib.recfunctions import structured_to_unstructured


def run(file: str, most_numbers: int) -> None:
    """Run an FMU that moves by itself; raises whatever FMPy does."""
    model = read_model_description(file, validate=False)
    variables, experiment = model.modelVariables, model.defaultExperiment
    inputs = [variable.name for variable in variables if variable.causality == "input"]
    if inputs:
        sys.exit(f"its input '{inputs[0]}' has no value; let the model itself drive it, and export it again")
    if experiment is None or experiment.stopTime is None:
        sys.exit("it has no stop time; set its default experiment, and export it again")
    varying = [each for each in variables if each.variability == "continuous" and each.causality == "local"]
    outputs = {each.name: each for each in [each for each in variables if each.causality == "output"] or varying}
    curves = simulate_fmu(file, validate=False, output=[*outputs], remote_platform=None)
    names, units = ["time"], ["s"]
    for name in curves.dtype.names[1:]:
        shape, kind = curves.dtype[name].shape, outputs[name].declaredType
        unit = outputs[name].unit or (kind.unit if kind else None) or ""
        for place in np.ndindex(shape):  # of a plain number ()
            names.append(f"{name}[{','.join(str(k + 1) for k in place)}]" if place else name)
            units.append(unit)
    values = structured_to_unstructured(np.asarray(curves), dtype=float)
    if values.size > most_numbers:
        sys.exit("it has more numbers than can be read; give it fewer outputs")
    np.savez("arrays.npz", names=names, units=units, values=values)


if __name__ == "__main__":
    run(sys.argv[1], int(sys.argv[2]))
