"""The words of a figure as they are drawn: none may touch another or leave the figure."""

import itertools
from unittest.mock import patch

from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.text import Text


def drawn_words(figure, axes=None):
    """Every text that a figure draws, or that lies in the axes or an axis of theirs, in the order of drawing."""
    found, draw = [], Text.draw
    with patch.object(Text, "draw", lambda text, renderer: (found.append(text), draw(text, renderer))):
        FigureCanvasAgg(figure)
        figure.draw_without_rendering()
    mine = set(axes.findobj(Text)) if axes else set()
    return [text for text in found if text.get_visible() and text.get_text().strip() and (axes is None or text in mine)]


def texts(figure, axes=None):
    """The same as strings, each in one line."""
    return [" ".join(text.get_text().split()) for text in drawn_words(figure, axes)]


def check_words(figure, slack):
    """No words touch others, by more than so many pixels of their line's height, or leave the figure."""
    boxes = [(text, text.get_window_extent()) for text in drawn_words(figure) if text.get_rotation() in (0.0, 90.0)]
    for (one, box), (other, another) in itertools.combinations(boxes, 2):
        wide = min(box.x1, another.x1) - max(box.x0, another.x0)
        high = min(box.y1, another.y1) - max(box.y0, another.y0)
        assert wide < 2.0 or high < slack, (one.get_text(), other.get_text())
    for text, box in boxes:
        assert min(box.x0, box.y0, figure.bbox.x1 - box.x1, figure.bbox.y1 - box.y1) > -1.0, text.get_text()
        assert text.get_fontsize() * 96.0 / 72.0 >= 12.0
