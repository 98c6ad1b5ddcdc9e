"""Plots of a benchmark show every point, mark every setting, and name every engine."""

import json
import re

from reports.work_precision.facts import engine_names, places
from reports.work_precision.figure import bench_figure
from reports.work_precision.interactive import AXES, bench_html
from tests.reports.made_up_bench import made_up_bench

BENCH = made_up_bench()
PLACES, ENGINES = places(BENCH), engine_names(BENCH)


def test_a_panel_for_every_mechanism_and_a_key():
    figure = bench_figure(PLACES, ENGINES)
    assert [axes.get_title(loc="left") for axes in figure.axes] == ["juki-mf7923d: Mkr", "rimoldi-164: Mkr", ""]
    words = [text.get_text() for text in figure.axes[-1].get_legend().get_texts()]
    assert words[:2] == ["alpha: its front", "beta: its front"]
    assert {"setting naive", "setting tuned", "setting best", "the front over all engines"} <= set(words)


def test_every_point_of_a_method_at_its_own_effort_is_drawn_and_every_setting_marked():
    axes = bench_figure(PLACES, ENGINES, "Mkr").axes[0]
    sweeps = [len(line.get_xdata()) for line in axes.get_lines() if line.get_marker() == "."]
    assert sorted(sweeps) == [6, 6, 8, 8]
    marks = [line.get_marker() for line in axes.get_lines() if line.get_marker() in "os*"]
    assert sorted(marks) == ["*", "*", "o", "o", "s", "s"]
    assert {text.get_text() for text in axes.texts} == {"alpha", "beta"}


def test_another_quantity_can_be_drawn():
    assert bench_figure(PLACES, ENGINES, "joint_force").axes[0].get_title(loc="left").endswith("joint force")


def _figure(html):
    found = re.search(r'Plotly\.newPlot\(\s*"key",\s*(\[.*?\]),\s*(\{.*\}),\s*\{"displaylogo"', html, re.DOTALL)
    return json.loads(found[1]), json.loads(found[2])


def test_the_interactive_plot_holds_every_record_of_every_quantity():
    data, layout = _figure(bench_html(PLACES[0], ENGINES, "key"))
    lines = [trace for trace in data if trace["mode"] in ("lines+markers", "markers")]
    held = sum(len(trace["hovertext"]) for trace in lines)
    assert held == sum(record.finished for record in PLACES[0].records)
    quantities, axes = layout["updatemenus"]
    assert [button["label"] for button in quantities["buttons"]] == ["Mkr", "joint force"]
    assert len(axes["buttons"]) == len(AXES)
    for button in axes["buttons"]:
        assert len(button["args"][0]["x"]) == len(data)
    for button in quantities["buttons"]:
        assert len(button["args"][0]["visible"]) == len(data)


def test_only_the_foremost_quantity_shows_at_first_and_other_efforts_are_switched_off():
    data, _ = _figure(bench_html(PLACES[0], ENGINES, "key"))
    shown = [trace["name"] for trace in data if trace["visible"] is True]
    assert len([name for name in shown if name.startswith("alpha")]) == 6
    waiting = [trace["name"] for trace in data if trace["visible"] == "legendonly"]
    assert waiting == ["alpha: plain, 10 iterations", "beta: plain, 10 iterations"]


def test_pointing_at_a_point_tells_everything_of_it():
    data, _ = _figure(bench_html(PLACES[0], ENGINES, "key"))
    (words,) = next(trace["hovertext"] for trace in data if trace["name"] == "alpha: setting tuned")
    for part in ("alpha 1.0", "setting tuned", "max 4.0e-4", "finds its own steps", "repeats:", "set-up", "700 steps"):
        assert part in words
