"""The tutorial runs from its first cell to its last, and prints what it shows."""

from pathlib import Path

import pytest

from tests import printed

NOTEBOOK = Path(__file__).parents[2] / "docs" / "tutorial.ipynb"


def printed_text(cell):
    """What a cell of code printed."""
    return "".join(output["text"] for output in cell["outputs"] if output["output_type"] == "stream")


@pytest.mark.filterwarnings("ignore::DeprecationWarning", "ignore::RuntimeWarning")  # of the kernel's own packages
def test_every_cell_prints_what_the_notebook_shows():
    nbformat, client = pytest.importorskip("nbformat"), pytest.importorskip("nbclient")
    saved = nbformat.read(NOTEBOOK, as_version=4)
    executed = client.NotebookClient(
        nbformat.read(NOTEBOOK, as_version=4), timeout=None, coalesce_streams=True
    ).execute()
    code = [cells for cells in zip(saved.cells, executed.cells, strict=True) if cells[0].cell_type == "code"]
    assert sum(bool(printed_text(before)) for before, _ in code) > 3
    for before, after in code:
        assert printed.is_same(printed_text(before), printed_text(after))
        kinds = [[output["output_type"] for output in cell["outputs"]] for cell in (before, after)]
        assert kinds[0] == kinds[1]
