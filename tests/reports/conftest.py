"""Pages are written in the process of the tests, which has imported what draws them; ``site`` has others write them."""

import pytest

from tests.commands import empty_picture, pool_here


@pytest.fixture(autouse=True, scope="session")
def _pages_here():
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("reports.site.LocalPool", pool_here)
        yield


@pytest.fixture
def without_pictures(monkeypatch):
    """Pages have empty pictures: most of the time that a page takes is its drawings'."""
    monkeypatch.setattr("reports.document.html._PageFiles.picture", empty_picture)
