"""A page as HTML: its elements, its links, the files beside it, its colours."""

import json
import re
from functools import partial
from html.parser import HTMLParser

import numpy as np
import pytest

from reports.charts import draw
from reports.document import html
from reports.document.parts import (
    Bullets,
    Card,
    Cards,
    Command,
    Facts,
    FigureGroup,
    Fold,
    Mono,
    Page,
    PageFigure,
    PageLink,
    Paragraph,
    Section,
    Table,
    TableCell,
    Widget,
)

FOREIGN = '</script><b title="&">'
EMPTY = {"meta", "link", "img"}
TURN = np.linspace(0.0, 360.0, 50)


def figure(name):
    def place(whole):
        axes = whole.subplots()
        axes.plot(TURN, np.sin(np.radians(TURN)))
        draw.finish(axes, "φ, °", "S, mm", turn=True)

    return PageFigure(name, FOREIGN, FOREIGN, partial(draw.drawn, draw.WIDTH, 3.0, place))


TABLE = Table(
    FOREIGN,
    ("name", "limit", "", "b"),
    (
        (FOREIGN, "1e-4", TableCell("2e-5", "pass", note="small print", tooltip="more of it"), "x"),
        ("y", TableCell("gone", span=3)),
    ),
    "lr",
    FOREIGN,
    (("", 2), ("engine", 2)),
)
WIDGET = Widget("try", "w", FOREIGN, {"a": FOREIGN}, {"k": {"b": 2}}, (figure("instead"),))
PAGE = Page(
    "mechanisms/one.html",
    FOREIGN,
    FOREIGN,
    ("of ", PageLink("others", "index.html"), PageLink("here", "#a"), PageLink("source", "https://example.org/x")),
    (Paragraph(FOREIGN, "verdict"), Bullets((FOREIGN, ("x", Mono(FOREIGN)))), Facts(((FOREIGN, FOREIGN),))),
    (
        Section("a", FOREIGN, (TABLE, Section("in", "within", (Command(FOREIGN),)))),
        Section("b", "Figures", (FigureGroup((figure("one"), figure("two"))), Fold(FOREIGN, (Paragraph("folded"),)))),
        Section("c", "Rest", (Cards((Card(PageLink(FOREIGN, "index.html"), (Paragraph("card"),)),)), WIDGET)),
    ),
)  # fmt: skip


class Elements(HTMLParser):
    """Every element in order, with its attributes; a file whose elements do not nest fails."""

    def __init__(self, text):
        super().__init__()
        self.open, self.found, self.words = [], [], []
        self.feed(text)
        assert not self.open

    def handle_starttag(self, tag, attrs):
        self.found.append((tag, dict(attrs)))
        if tag not in EMPTY:
            self.open.append(tag)

    def handle_endtag(self, tag):
        assert self.open.pop() == tag

    def handle_data(self, data):
        self.words.append(data)

    def of(self, tag):
        return [attributes for name, attributes in self.found if name == tag]


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    folder = tmp_path_factory.mktemp("report")
    html.write_assets(folder)
    html.write(PAGE, folder, [PageLink("Index", "index.html"), PageLink("One", PAGE.file)])
    return folder


@pytest.fixture(scope="module")
def page(folder):
    return Elements((folder / PAGE.file).read_text(encoding="utf-8"))


def test_words_are_escaped_everywhere_and_elements_nest(page):
    assert not page.of("b")
    assert sum(FOREIGN in words for words in page.words) >= 12


def test_links_lead_from_the_page_through_the_report_s_folder(page, folder):
    assert [one["href"] for one in page.of("a")][:6] == [
        "#main", "../index.html", "../mechanisms/one.html", "../index.html", "#a", "https://example.org/x",
    ]  # fmt: skip
    for picture in page.of("img"):
        assert (folder / PAGE.file).parent.joinpath(picture["src"]).resolve().is_file()
        assert picture["alt"] == FOREIGN
        assert int(picture["width"]) > 0


def test_a_table_has_a_caption_heads_with_scopes_and_cells_of_its_classes(page):
    assert page.of("caption")
    assert page.of("div")[0]["role"] == "region"
    assert [head.get("scope") for head in page.of("th")] == ["colgroup", "col", "col", "col", "row", "row"]
    titled = [cell for cell in page.of("td") if "title" in cell]
    assert [(cell["class"], cell["title"]) for cell in titled] == [("num pass", "more of it")]
    assert [cell.get("colspan") for cell in page.of("td") if cell.get("class") == "num"][-1] == "3"


def test_data_of_a_widget_is_on_the_page_and_further_data_beside_it(folder):
    text = (folder / PAGE.file).read_text(encoding="utf-8")
    (data,) = re.findall(r'<script type="application/json">(.*?)</script>', text)
    assert json.loads(data) == WIDGET.data
    assert (folder / "data/one/w.k.js").read_text(encoding="utf-8") == 'linkproof.loaded("w.k", {"b":2});\n'
    assert 'data-files="../data/one/"' in text


def test_a_page_loads_its_assets_and_nothing_from_elsewhere(page, folder):
    (policy,) = (meta["content"] for meta in page.of("meta") if meta.get("http-equiv") == "Content-Security-Policy")
    assert policy.startswith("default-src 'none'; script-src 'self' file: blob:;")
    loaded = [one["href"] for one in page.of("link")][1:] + [one["src"] for one in page.of("script") if "src" in one]
    assert len(loaded) == 2
    for file in loaded:
        assert (folder / PAGE.file).parent.joinpath(file).resolve().is_file()
