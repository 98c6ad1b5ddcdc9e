"""One page of a whole report: names stay apart, links stay inside, nothing lies beside it."""

import re

import numpy as np
from markupsafe import Markup

from reports.document.chart import Chart, Curve, Panel
from reports.document.parts import Drawn, Page, PageFigure, PageLink, Paragraph, Section, Widget
from reports.site.single_file import joined_page, write_single_file
from tests.reports.site.test_site import save_campaign

CHART = Chart((Panel((Curve(np.arange(3.0), np.arange(3.0)),)),))


def page(file, *links):
    words = tuple(PageLink("x", link) for link in links)
    parts = (
        PageFigure("f", "", "", CHART),
        Widget("k", "w", "", {}),
        Drawn(Markup('<b id="m"></b><i href="#m" class="m-1">m mm-1</i>'), ""),
    )
    return Page(file, file, file, "", (Paragraph(words),), (Section("s", "s", parts),))


def found(part, kind):
    """Everything of a kind on a page."""
    if isinstance(part, kind):
        yield part
    for name in ("parts", "sections", "words"):
        value = getattr(part, name, ())
        for one in value if isinstance(value, tuple) else (value,):
            if not isinstance(one, (str, int)):
                yield from found(one, kind)


def test_names_stay_apart_and_links_lead_to_them():
    one = joined_page(
        (
            page("index.html", "mechanisms/a.b.html", "bench.html#s"),
            page("mechanisms/a.b.html", "#s", "index.html#s"),
            page("bench.html"),
        )
    )
    for kind, name in ((PageFigure, "name"), (Widget, "name"), (Section, "key")):
        names = [getattr(part, name) for part in found(one, kind)]
        assert len(names) == len(set(names))
    keys = {section.key for section in found(one, Section)} | {"main"}
    links = [link.href for link in found(one, PageLink)]
    assert links == ["#a-b", "#bench-s", "#a-b-s", "#s"]
    assert {link[1:] for link in links} <= keys
    drawn = [part.markup for part in found(one, Drawn)]
    assert drawn[1] == '<b id="a-b-m"></b><i href="#a-b-m" class="a-b-m-1">m mm-1</i>'


def test_a_report_in_one_file_needs_no_other(tmp_path):
    save_campaign(tmp_path)
    text = write_single_file(tmp_path, tmp_path / "mail" / "report.html").read_text(encoding="utf-8")
    markup = re.sub(r"<script>.*?</script>|<style>.*?</style>", "", text, flags=re.DOTALL)
    assert not [link for link in re.findall(r'(?:href|src)="([^"]*)"', markup) if not link.startswith(("#", "data:"))]
    assert [path.name for path in (tmp_path / "mail").iterdir()] == ["report.html"]
    ids = re.findall(r'\sid="([^"]*)"', markup)
    assert len(ids) == len(set(ids))
    assert set(re.findall(r'href="#([^"]*)"', markup)) <= set(ids)


def test_the_curves_of_one_regime_at_the_settings_that_matter_are_mailed():
    def curves(*settings):
        return {"truth": {}, "runs": [{"setting": name} for name in settings]}

    quantities = [{"title": "S", "curves": True}, {"title": "v", "curves": False}]
    data = {
        "settings": ["naive", "tuned"],
        "regimes": [{"name": "one", "quantities": quantities}, {"name": "two", "quantities": quantities}],
        "first": "0-0",
        "curves": curves("naive", "tuned"),
    }
    further = {"0-1": curves("naive", "tuned"), "1-0": curves("tuned")}
    widget = Widget("curves", "w", "", data, further)
    one = joined_page((page("index.html"), Page("a.html", "a", "a", "", (widget,), ())))
    (mailed,) = (part for part in found(one, Widget) if part.kind == "curves")
    assert mailed.data["curves"]["runs"] == [{"setting": "tuned"}]
    assert mailed.further == {"0-1": curves("tuned")}
    offered = [[one["curves"] for one in regime["quantities"]] for regime in mailed.data["regimes"]]
    assert offered == [[True, False], [False, False]]
    assert "one" in mailed.data["left_out"]
    assert widget.data is data
    assert data["regimes"][1]["quantities"] == quantities
