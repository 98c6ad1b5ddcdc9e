"""A report's folder: complete from saved data alone, the same however it is written, without stale files."""

import os
import re
import shutil
import sys

import pytest

from analytic.description.loading import load
from analytic.errors import LinkproofError
from analytic.kinematics.mechanism import Mechanism
from comparisons.designer.building import usual_case
from comparisons.trials.campaign.results import RESULTS, save, save_case
from comparisons.trials.runs.files import STORE, write_file
from comparisons.trials.runs.workers import LocalPool
from comparisons.trials.stress.campaign import KIND as STRESS
from comparisons.trials.stress.campaign import save as save_stress
from comparisons.trials.work_precision.table import KIND as BENCH
from comparisons.trials.work_precision.table import save as save_bench
from engines.contract import Setting
from reports.site import write_site
from tests.commands import linkproof
from tests.made_up import made_up_bench, made_up_results, made_up_stress

NAME = "juki-mf7923d"
ENGINES = ("exudyn", "pymunk", "mujoco", "opensim", "pybullet", "pyondsel")


def save_campaign(folder):
    linkage = load(NAME)
    results = made_up_results([linkage], samples=51, settings=[Setting.TUNED], quantities=("Jeq", "S"))
    folder.mkdir(exist_ok=True)
    save(folder, results.document, results.runs)


def files_of(folder):
    return {path.relative_to(folder).as_posix() for path in folder.rglob("*") if path.is_file()}


@pytest.fixture(scope="module")
def saved(tmp_path_factory):
    folder = tmp_path_factory.mktemp("saved")
    save_campaign(folder)
    save_bench(folder, made_up_bench())
    save_stress(folder, made_up_stress())
    return folder


@pytest.fixture(scope="module")
def site(saved, tmp_path_factory):
    """The pages, written where no engine is installed and no window can be opened."""
    folder = tmp_path_factory.mktemp("site")
    with pytest.MonkeyPatch.context() as patch:
        for module in (*ENGINES, "matplotlib.pyplot"):
            patch.setitem(sys.modules, module, None)
        shutil.copytree(saved, folder, dirs_exist_ok=True)
        write_site(folder, processes=0)
    return folder


def test_every_page_is_there_and_every_link_leads_to_a_file(site):
    pages = {"index.html", "bench.html", "stress.html", f"mechanisms/{NAME}.as-built.html"}
    assert {name for name in files_of(site) if name.endswith(".html")} == pages
    for name in pages:
        text = (site / name).read_text(encoding="utf-8")
        for link in re.findall(r'(?:href|src)="([^"#:]+)"', text):
            assert ((site / name).parent / link).is_file(), (name, link)


@pytest.mark.nightly
def test_worker_processes_write_the_same(saved, site, tmp_path, monkeypatch):
    monkeypatch.setattr("reports.site.LocalPool", LocalPool)
    shutil.copytree(saved, tmp_path, dirs_exist_ok=True)
    write_site(tmp_path, processes=1)
    assert files_of(tmp_path) == files_of(site)
    for name in ("index.html", "RESULTS.md", f"mechanisms/{NAME}.as-built.html"):
        assert (tmp_path / name).read_bytes() == (site / name).read_bytes()


@pytest.mark.usefixtures("without_pictures")
def test_stale_files_of_the_report_go_and_no_others(saved, tmp_path):
    folder = tmp_path / "report"
    shutil.copytree(saved, folder)
    write_file(tmp_path / "precious.txt", "keep")
    write_file(folder / "assets" / "written.txt", "../precious.txt\nstress.html\nfigures/stress/old.svg\n")
    write_file(folder / "figures" / "stress" / "old.svg", "stale")
    write_file(folder / "figures" / "own.svg", "mine")
    (folder / STORE).unlink()
    save_campaign(folder)
    write_site(folder, processes=0)
    assert "stress.html" not in files_of(folder)
    assert not (folder / "figures" / "stress").exists()
    assert (folder / "figures" / "own.svg").read_text(encoding="utf-8") == "mine"
    assert (tmp_path / "precious.txt").is_file()


@pytest.mark.usefixtures("without_pictures")
@pytest.mark.parametrize(("part", "pages"), [(BENCH, 2), (STRESS, 2), (RESULTS, 1)])
def test_a_folder_with_one_study_has_its_page_and_an_index_and_that_of_a_linkage_one_page(tmp_path, part, pages):
    if part == RESULTS:
        save_case(tmp_path, usual_case(Mechanism(load(NAME))))
    elif part == BENCH:
        save_bench(tmp_path, made_up_bench())
    else:
        save_stress(tmp_path, made_up_stress())
    write_site(tmp_path, processes=0)
    assert len([name for name in files_of(tmp_path) if name.endswith(".html")]) == pages


def test_a_folder_without_any_is_refused(tmp_path):
    with pytest.raises(LinkproofError, match="nothing to report in"):
        write_site(tmp_path, processes=0)


@pytest.mark.usefixtures("without_pictures")
def test_pages_are_written_where_no_process_can_be_started(tmp_path, monkeypatch):
    def refuse(*_, **__):
        raise LinkproofError("no process")

    monkeypatch.setattr("reports.site.LocalPool", refuse)
    save_case(tmp_path, usual_case(Mechanism(load(NAME))))
    assert write_site(tmp_path).is_file()


@pytest.mark.usefixtures("without_pictures")
def test_two_commands_do_not_write_into_one_folder(tmp_path):
    save_campaign(tmp_path)
    fcntl = pytest.importorskip("fcntl", reason="no lock there")
    handle, words = os.open(tmp_path, os.O_RDONLY), "another linkproof command is writing to"
    try:
        fcntl.flock(handle, fcntl.LOCK_EX)
        with pytest.raises(LinkproofError, match=words):
            write_site(tmp_path)
        done = linkproof("results", NAME, "--out", tmp_path)
        assert (done.returncode, words in done.stderr) == (2, True)
    finally:
        os.close(handle)
