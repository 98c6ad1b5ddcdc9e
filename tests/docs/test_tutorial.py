"""The tutorial runs from its first cell to its last, and prints what it shows."""

import json
from contextlib import redirect_stdout
from io import StringIO
from pathlib import Path

import matplotlib as mpl

from tests import printed

NOTEBOOK = Path(__file__).parents[2] / "docs" / "tutorial.ipynb"


def test_every_cell_prints_what_the_notebook_shows(monkeypatch):
    """Cells are run in this process, which knows what they defined as a kernel does; pictures are counted."""
    known, pictures = {}, []
    mpl.use("agg")
    monkeypatch.setattr("matplotlib.pyplot.show", lambda: pictures.append("display_data"))
    cells = json.loads(NOTEBOOK.read_text(encoding="utf-8"))["cells"]
    code = [cell for cell in cells if cell["cell_type"] == "code"]
    assert sum(bool(cell["outputs"]) for cell in code) > 3
    for cell in code:
        pictures.clear()
        with redirect_stdout(StringIO()) as text:
            exec("".join(cell["source"]), known)
        shown = [part for output in cell["outputs"] for part in output.get("text", ())]
        assert printed.is_same(text.getvalue(), "".join(shown))
        assert pictures == [kind for output in cell["outputs"] if (kind := output["output_type"]) != "stream"]
