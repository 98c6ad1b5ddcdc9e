"""The page: self-contained, whole, plain about what failed, the same every time, and made without an engine."""

import dataclasses
import re
import subprocess
import sys
from html.parser import HTMLParser
from pathlib import Path

import pytest

from analytic.description.loading import load, parse
from analytic.errors import LinkproofError
from comparisons.campaign.results import RECORDS, Results
from comparisons.judging.records import Verdict, to_json
from engines.contract import Setting
from reports.campaign.page import page, write_page
from reports.campaign.sections import mechanism_section
from reports.records.views import View
from tests.analytic.drives import driven
from tests.analytic.linkages import from_text
from tests.analytic.textbook import DOUBLE_ROCKER
from tests.reports.made_up_results import made_up_results

LINKAGES = Path(__file__).parents[2] / "linkages"
VOID = {"meta", "br", "img", "path", "use", "rect"}


class Reader(HTMLParser):
    """Collects ids, links and open tags; fails on a tag closed out of turn."""

    def __init__(self, text):
        super().__init__()
        self.ids, self.links, self.open, self.headings = [], [], [], []
        self.feed(text)

    def handle_starttag(self, tag, attrs):
        found = dict(attrs)
        self.ids += [found["id"]] if "id" in found else []
        self.links += [value for name, value in attrs if name in ("href", "src", "xlink:href")]
        if tag not in VOID:
            self.open.append(tag)

    def handle_startendtag(self, tag, attrs):
        if tag not in VOID:
            self.open.append(tag)
        self.handle_starttag(tag, attrs)
        if tag not in VOID:
            self.open.pop()
            self.open.pop()

    def handle_endtag(self, tag):
        if tag not in VOID:
            assert self.open.pop() == tag

    def handle_data(self, data):
        if self.open and self.open[-1] in ("h2", "h3"):
            self.headings.append(data.strip())


@pytest.fixture(scope="module")
def results():
    names = ["juki-mf7923d", "rimoldi-164"]
    return made_up_results(
        [load(name) for name in names],
        engines=("alpha", "beta", "gamma", "delta"),
        broken={"gamma": Verdict.UNAVAILABLE, "delta": Verdict.DIVERGED},
    )


@pytest.fixture(scope="module")
def text(results):
    return page(results)


@pytest.fixture(scope="module")
def read(text):
    reader = Reader(text)
    assert reader.open == []
    return reader


def test_nothing_is_fetched_and_nothing_runs(text, read):
    assert not [link for link in read.links if not link.startswith(("#", "data:"))]
    assert not re.search(r"<script|<link|@import|url\((?!#)|\son\w+=", text)
    assert len(text) < 5_000_000


def test_ids_are_unique_and_links_lead_somewhere(read):
    assert len(read.ids) == len(set(read.ids))
    assert {link[1:] for link in read.links if link.startswith("#")} <= set(read.ids)


def test_sections_stand_in_the_order_of_a_report(read):
    tops = [
        "What was run", "Every error beside its limit", "Juki MF-7923D needle mechanism (four-bar crank-slider)",
        "Rimoldi 164 needle mechanism (six-bar)", "Settings used", "Limits and their reasons", "Known limitations",
        "Reproduce this report",
    ]  # fmt: skip
    assert [heading for heading in read.headings if heading in tops] == tops
    parts = ["Motion of the output", "Reduced moment of inertia Jeq", "Forces in the joints and on the frame",
             "Regime run-up", "Published figures against ours"]  # fmt: skip
    assert [heading for heading in read.headings if heading in parts] == 2 * parts


def test_every_figure_describes_itself(text):
    drawings = re.findall(r"<svg[^>]*>", text)
    assert len(drawings) == 32
    assert all('role="img"' in drawing for drawing in drawings)


def test_pass_and_fail_read_in_black_and_white(text):
    assert re.search(r'class="cell pass[^>]*><span class="sign">✓</span> 1.3e-6<small>≤ 1e-5', text)
    assert re.search(r'class="cell over[^>]*><span class="sign">✗</span> \d\.\de-2<small>≤ 6e-2', text)


def test_runs_that_failed_are_shown_with_their_reason(text):
    assert text.count("✗ diverged: delta &lt;cannot&gt; hold this scene") == 6
    assert text.count("– not installed: gamma &lt;cannot&gt; hold this scene") == 6
    assert "<cannot>" not in text


def test_command_versions_and_conditions_are_told(results, text):
    assert text.count("linkproof compare juki-mf7923d --setting all") == 2
    assert "1000 rpm counter-clockwise, 0.6 s + 0.1 s, from 0°, gravity on" in text
    assert results.document["environment"]["python"] in text


def test_the_same_results_give_the_same_page(results, text):
    assert page(Results(results.document, results.curves)) == text


def test_a_linkage_without_output_or_published_figures_has_its_own_page():
    path = LINKAGES / "spring-and-damper.toml"
    source = "\n".join(line for line in path.read_text(encoding="utf-8").splitlines() if not line.startswith("output"))
    linkage = load_text(source, path.stem)
    found = Reader(page(made_up_results([linkage], samples=51, quantities=("Mkr", "Jeq"))))
    assert "Motion of the output" not in found.headings
    assert "Published figures against ours" not in found.headings
    assert "Regime run-up" in found.headings


def load_text(source, name):

    return parse(source, name, name)


def test_several_regimes_have_a_part_each():
    found = Reader(
        page(made_up_results(samples=51, regimes=("run-up-quintic", "constant-speed"), settings=[Setting.BEST]))
    )
    assert [heading for heading in found.headings if heading.startswith("Regime")] == [
        "Regime run-up-quintic",
        "Regime constant-speed",
    ]


def test_a_regime_that_prescribes_nothing_and_a_campaign_that_gave_nothing_have_pages():
    results = made_up_results(samples=51)
    released = page(Results({**results.document, "motions": []}, results.curves))
    assert "Regime run-up" in Reader(released).headings
    assert "Where the crank is released (run-up)" in released
    nothing = made_up_results(samples=51, broken={"alpha": Verdict.DIVERGED, "beta": Verdict.UNSUPPORTED})
    assert "no run gave a curve" in page(nothing)


def test_dead_positions_are_told_not_raised():
    text = (LINKAGES / "parallelogram.toml").read_text(encoding="utf-8")
    stuck = parse(text.replace("B = [25, 0]", "B = [15, 0]"), "sample", "sample.toml")
    broken = {"alpha": Verdict.DIVERGED, "beta": Verdict.DIVERGED}
    assert "cannot be assembled at" in page(made_up_results([stuck], broken=broken, quantities=("Mkr",)))


def test_a_saved_campaign_becomes_a_page_with_no_engine_imported(results, tmp_path):
    results.curves.to_netcdf(tmp_path / "curves.nc", engine="scipy", format="NETCDF3_64BIT")
    (tmp_path / RECORDS).write_text(to_json(results.document), encoding="utf-8")
    code = (
        "import sys; from pathlib import Path; from comparisons.campaign.results import load;"
        "from reports.campaign.page import write_page;"
        "from reports.campaign.summary import markdown; folder = Path(sys.argv[1]); results = load(folder);"
        "write_page(results, folder / 'index.html'); markdown(results);"
        "bad = {'exudyn', 'pymunk', 'matplotlib.pyplot'} & set(sys.modules); sys.exit(', '.join(bad) or 0)"
    )
    root = Path(__file__).parents[3]
    done = subprocess.run(
        [sys.executable, "-c", code, str(tmp_path)], capture_output=True, text=True, cwd=root, check=False
    )
    assert done.returncode == 0, done.stderr
    assert (tmp_path / "index.html").read_text(encoding="utf-8") == page(results)


def test_a_page_is_written_whole(tmp_path):
    results = made_up_results(samples=21, settings=[Setting.TUNED], quantities=("Jeq",))
    write_page(results, tmp_path / "deep" / "index.html")
    assert (tmp_path / "deep" / "index.html").read_text(encoding="utf-8").endswith("</html>\n")


def test_sections_drawn_in_other_processes_are_the_same():
    results = made_up_results(
        samples=21, settings=[Setting.TUNED], quantities=("Jeq",), regimes=("run-up", "constant-speed")
    )
    assert page(results, processes=1) == page(results, processes=0)


def test_a_page_is_made_where_no_process_can_be_started(monkeypatch):
    def refuse(*_, **__):
        raise LinkproofError("no process")

    monkeypatch.setattr("reports.campaign.page.run_jobs", refuse)
    results = made_up_results(samples=21, settings=[Setting.TUNED], quantities=("Jeq",))
    assert "Regime run-up" in page(results)


def test_a_file_with_a_byte_order_mark_has_its_page():
    linkage = load("juki-mf7923d")
    linkage = dataclasses.replace(linkage, text="\ufeff" + linkage.text)
    results = made_up_results([linkage], samples=21, settings=[Setting.TUNED], quantities=("Jeq",))
    assert "Regime run-up" in page(results, processes=0)


@pytest.mark.parametrize("linkage", [from_text(DOUBLE_ROCKER).linkage, driven("linear-motor").linkage])
def test_a_linkage_that_makes_no_turn_is_drawn_over_its_range(linkage):
    section = mechanism_section(View(made_up_results(samples=21), linkage), None)
    assert "positions of the range that it reaches" in section["scheme"].lead
    assert section["parts"] == []
