"""Pages are written in the process of the tests, which has imported what draws them; ``site`` has others write them."""

import pytest


@pytest.fixture(autouse=True, scope="session")
def _pages_here():
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("reports.site.site.usual_processes", lambda _: 0)
        yield
