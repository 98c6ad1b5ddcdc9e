"""The report in one picture."""

from docs.preview import preview
from tests.reports.made_up_results import made_up_results


def test_a_picture_is_written_and_is_the_same_every_time(tmp_path):
    results = made_up_results(samples=201)
    for name in ("one.png", "two.png"):
        preview(results, tmp_path / name)
    picture = (tmp_path / "one.png").read_bytes()
    assert picture.startswith(b"\x89PNG")
    assert picture == (tmp_path / "two.png").read_bytes()
