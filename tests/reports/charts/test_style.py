"""Drawings are fit to stand in a page: text whole, ids their own, the same every time."""

import itertools
import re

import pytest

from reports.charts import style


def draw(figure):
    axes = figure.subplots()
    axes.plot([0.0, 1.0 / 3.0, 1.0], [0.0, 1.23456789, 2.0])
    axes.text(0.5, 0.5, "1.688123 m/s")


@pytest.fixture(scope="module")
def drawing():
    return str(style.picture(style.drawn(3.0, 2.0, draw), "key", 'a "described" <figure>'))


def test_text_keeps_its_digits_while_coordinates_lose_theirs(drawing):
    assert "1.688123 m/s" in drawing
    paths = re.findall(r'd="([^"]*)"', drawing)
    assert paths
    assert not any(re.search(r"\.\d{3}", path) for path in paths)


def test_ids_belong_to_the_figure_and_references_resolve(drawing):
    ids = re.findall(r'\bid="([^"]*)"', drawing)
    assert all(name.startswith("key-") for name in ids)
    assert len(ids) == len(set(ids))
    assert set(re.findall(r"(?:url\(#|href=\"#)([^)\"]*)", drawing)) <= set(ids)


def test_it_describes_itself_and_is_the_same_every_time(drawing):
    assert '<title id="key-title">a &quot;described&quot; &lt;figure&gt;</title>' in drawing
    assert drawing == str(style.picture(style.drawn(3.0, 2.0, draw), "key", 'a "described" <figure>'))
    assert not re.search(r"<style|<metadata|<\?xml|DOCTYPE|DejaVu", drawing)


def test_a_drawing_too_large_becomes_a_picture_with_its_description(monkeypatch):
    monkeypatch.setattr(style, "LARGEST_DRAWING", 100)
    found = style.picture(style.drawn(3.0, 2.0, draw), "key", "a <figure>")
    assert found.startswith('<img width="288" alt="a &lt;figure&gt;" src="data:image/png;base64,')


def test_colours_and_dashes_go_by_the_order_of_names():
    names = [f"engine {letter}" for letter in "abcdefgh"]
    assert style.colour("engine b", names) == style.PALETTE[1]
    assert style.colour("engine g", names) == style.PALETTE[0]
    assert style.dashes("engine e", names) == style.DASHES[0]


@pytest.mark.parametrize("heights", [[0.5, 0.5, 0.5], [0.0, 0.01, 0.99, 1.0], [1.4, 1.5], [0.1 * i for i in range(10)]])
def test_labels_are_moved_apart_within_the_panel(heights):
    placed = style.spread(sorted(heights), 0.1)
    assert all(later - earlier >= 0.1 - 1e-12 for earlier, later in itertools.pairwise(placed))
    assert min(placed) >= -1e-12
    assert max(placed) <= 1.0 + 1e-12


def test_powers_of_ten_are_plain_text():
    assert style.power_of_ten(1e-5) == "10⁻⁵"
