"""What lies beside a campaign's curves gets sections of its own."""

from comparisons.judging.records import to_json
from comparisons.runs.files import write_text
from comparisons.work_precision.records import FILE as BENCH
from reports.campaign.extra_sections import extra_sections, rebuild_pages
from reports.stress.facts import FILE as STRESS
from tests.reports.made_up_bench import made_up_bench
from tests.reports.made_up_stress import made_up_stress


def test_an_empty_folder_has_no_sections(tmp_path):
    assert extra_sections(tmp_path) == ()
    rebuild_pages(tmp_path, tmp_path)
    assert list(tmp_path.iterdir()) == []


def test_a_benchmark_and_maps_have_sections_and_pages_of_their_own(tmp_path):
    write_text(tmp_path / BENCH, to_json(made_up_bench().document))
    write_text(tmp_path / STRESS, to_json(made_up_stress().document))
    found = {one.key: one for one in extra_sections(tmp_path)}
    assert {"cost", "stability"} <= set(found)
    assert all(one.title in one.body for one in found.values())
    rebuild_pages(tmp_path, tmp_path)
    assert all((tmp_path / found[key].page).is_file() for key in ("cost", "stability"))
