"""Writers of the layouts in which other tools export their results, for tests: from a small table to a file's text.

They follow files of the tools themselves: Adams ``.res`` as Adams/Solver 2022 writes it, ``.tab`` as
Adams/PostProcessor does, OpenModelica's CSV, and SolidWorks Motion's export of plots.
"""

from __future__ import annotations

import io
from dataclasses import dataclass, replace

import numpy as np
from scipy.io import savemat

from comparisons.filejudge.columns import Column, ImportedResults, ImportedSignal, SignalTimes
from comparisons.filejudge.simulation import Simulation


def rounded(values, digits):
    """Values to so many significant digits, and half a unit of the last one of each."""
    texts = [f"{value:.{digits - 1}e}" for value in values]
    exponents = np.array([int(text.partition("e")[2]) for text in texts])
    return np.array([float(text) for text in texts]), 0.5 * 10.0 ** (exponents - digits + 1)


def exported(linkage, motion, names, time, *, digits=6, change=None, model=None):
    """Imported results of a model, the true one by default; ``change`` alters values by name."""
    model = model or Simulation(linkage, motion)
    values = dict(zip(names, model.predict([SignalTimes(name, time) for name in names]), strict=True))
    there = np.all(np.isfinite([*values.values()]), axis=0)  # a motion that is shifted in time does not reach both ends
    values, time = {name: value[there] for name, value in values.items()}, np.asarray(time)[there]
    return results_of(change(values, time) if change else values, time, digits=digits)


def results_of(values, time, *, digits=6):
    """Values (n,) by the names of their signals, rounded as a file has them."""
    signals = []
    for name in values:
        printed, half = rounded(values[name], digits)
        at, at_half = rounded(time, 10)
        column = Column(name, "", printed, half, "made up")
        signals.append(ImportedSignal(name, at, printed, half, at_half, "time", column))
    clock = Column("time", "s", *rounded(time, 10), "made up")
    return ImportedResults(
        tuple(signals), (), {}, (("time", clock, 1.0, ""), *((s.name, s.column, 1.0, "") for s in signals))
    )


def with_link(linkage, name, **changes):
    """A linkage with a link changed."""
    link = replace(linkage.links[name], **changes)
    return replace(linkage, links={**linkage.links, name: link})


@dataclass(frozen=True)
class Channel:
    """A column to be written: what its tool would call it, its unit there, and values (n,) in that unit."""

    header: str
    unit: str
    values: np.ndarray


def _rows(channels, write):
    return [[write(x) for x in row] for row in np.column_stack([c.values for c in channels]).tolist()]


def csv(
    channels,
    *,
    delimiter=",",
    decimal=".",
    digits=6,
    quotes=False,
    title="",
    trailing=False,
    unit_row=False,
    decimals=None,
):
    """A CSV with units in brackets behind the headers, or in a row below; ``digits`` or ``decimals``."""
    headers = [f"{c.header} [{c.unit}]" if c.unit and not unit_row else c.header for c in channels]
    headers = [f'"{header}"' for header in headers] if quotes else headers
    form = f".{digits}g" if decimals is None else f".{decimals}f"
    rows = _rows(channels, lambda x: format(x, form).replace(".", decimal))
    rows = [[c.unit for c in channels], *rows] if unit_row else rows
    end = delimiter if trailing else ""
    return "\n".join([*([title] if title else []), *(delimiter.join(row) + end for row in [headers, *rows])]) + "\n"


def solidworks(plots, *, digits=6):
    """SolidWorks Motion: every plot with a title line, quoted headers with the unit in round brackets.

    ``plots`` are pairs of a title and its channels, the time first.
    """
    parts = []
    for title, channels in plots:
        headers = ",".join(f'"{c.header} ({c.unit})"' for c in channels)
        rows = [",".join(row) for row in _rows(channels, lambda x: format(x, f".{digits}g"))]
        parts.append("\n".join([f'"{title}"', headers, *rows]))
    return "\n\n".join(parts) + "\n"


def adams_table(channels, *, model="MODEL_1", decimals=4):
    """Adams ``.tab``: the model's name, an empty line, padded headers without units, fixed decimals, tabs."""
    headers = "\t".join(f"{c.header:<10}" for c in channels)
    rows = ["\t".join(f"{x} " for x in row) for row in _rows(channels, lambda x: format(x, f".{decimals}f"))]
    return "\n".join([f"      {model}" + "\t" * len(channels), "\t" * len(channels), headers, *rows]) + "\n"


def adams_results(channels, *, digits=17):
    """Adams ``.res``: every header is ``ENTITY.COMPONENT``, but the time's, which comes first."""
    components = "\n".join(
        f'<Entity name="{entity}"{kind}>\n<Component name="{component}" unitsValue="{c.unit}" id="{number}" />\n'
        "</Entity>"
        for number, c in enumerate(channels, start=1)
        for entity, component, kind in [_entity(c.header)]
    )
    rows = _rows(channels, lambda x: format(x, f".{digits}g"))
    steps = [f'<Step type="dynamic">\n{row[0]}\n{" ".join(row[1:])}\n</Step>' for row in rows]
    return (
        '<?xml version="1.0" encoding="UTF-8"?>\n<Results xmlns="http://www.mscsoftware.com/:xrf10">\n'
        '<Analysis name="ANALYSIS_01">\n<Units angle="rad" length="meter" mass="kg" time="sec" />\n'
        f'<StepMap name="map_001">\n{components}\n</StepMap>\n'
        '<Data name="modelInput_001" id="1">\n<Step type="input">\n0\n0\n</Step>\n</Data>\n'
        '<Data name="dynamic_001" id="2">\n' + "\n".join(steps) + "\n</Data>\n</Analysis>\n</Results>\n"
    )


def _entity(header):
    entity, _, component = header.rpartition(".")
    return (entity, component, f' entity="{entity}" entType="Joint"') if entity else ("time", header.upper(), "")


def robotran(channels, *, digits=9):
    """Robotran ``.res``: numbers alone, the time first, in SI units."""
    return "\n".join(" ".join(row) for row in _rows(channels, lambda x: format(x, f".{digits}e"))) + "\n"


def modelica(channels, *, digits=16):
    """OpenModelica's CSV: quoted names of variables, the first of them ``time``, in SI units."""
    headers = ",".join(f'"{c.header}"' for c in channels)
    return "\n".join([headers, *(",".join(row) for row in _rows(channels, lambda x: format(x, f".{digits}g")))]) + "\n"


def workbook(channels):
    """An Excel workbook, its first sheet without numbers."""
    from openpyxl import Workbook  # noqa: PLC0415 - an extra

    book, content = Workbook(), io.BytesIO()
    book.active.append(["Exported by hand", 3])
    sheet = book.create_sheet("curves")
    for row in ([f"{c.header} [{c.unit}]" for c in channels], *_rows(channels, float)):
        sheet.append(row)
    book.save(content)
    return content.getvalue()


def trajectory(channels, *, transposed, kind=np.float64):
    """OpenModelica's and Dymola's ``.mat``: the time first, the last with the other sign, and a parameter."""
    names = [c.header for c in channels] + ["mass"]
    count = len(channels)
    info = np.array([[0, 1], *[[2, n + 1] for n in range(1, count - 1)], [2, -count], [1, 2]])
    info = np.hstack([info, np.zeros((count + 1, 2), dtype=int)])
    values = np.column_stack([c.values for c in channels]).astype(kind)
    values[:, -1] *= -1.0
    letters = np.array([list(name.ljust(max(map(len, names)))) for name in names])
    parts = {"name": letters, "dataInfo": info, "data_1": np.array([[0.0, 2.5], [1.0, 2.5]]), "data_2": values}
    parts = {key: np.ascontiguousarray(part.T) for key, part in parts.items()} if transposed else parts
    order = ["Atrajectory", "1.1", "", "binTrans" if transposed else "binNormal"]
    content = io.BytesIO()
    savemat(content, {"Aclass": np.array([list(line.ljust(11)) for line in order]), **parts}, format="4")
    return content.getvalue()


def matlab(**arrays):
    """Arrays of MATLAB by their names."""
    content = io.BytesIO()
    savemat(content, arrays)
    return content.getvalue()
