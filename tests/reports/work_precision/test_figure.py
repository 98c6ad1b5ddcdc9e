"""Plots of a benchmark show every point, mark every setting, and name every engine."""

import json
import re

from comparisons.work_precision.analysis import apart, on_front
from reports.charts.style import MUTED, REFERENCE
from reports.work_precision.facts import places
from reports.work_precision.figure import bench_figure, inks
from reports.work_precision.interactive import AXES, bench_html
from tests.reports.made_up_bench import made_up_bench

BENCH = made_up_bench()
PLACES, INKS = places(BENCH), inks(BENCH)


def test_a_panel_for_every_mechanism_and_a_key():
    figure = bench_figure(PLACES, INKS)
    assert [axes.get_title(loc="left") for axes in figure.axes] == ["juki-mf7923d: Mkr", "rimoldi-164: Mkr", ""]
    words = [text.get_text() for text in figure.axes[-1].get_legend().get_texts()]
    assert words[:2] == ["alpha: its front", "beta: its front"]
    assert {"setting naive", "setting tuned", "setting best", "the front over all engines"} <= set(words)
    assert words[2:4] == ["1 run", "several runs extrapolated"]


def test_single_runs_are_solid_and_extrapolated_ones_dashed():
    axes = bench_figure(PLACES, INKS, "Mkr").axes[0]
    records = [record for record in PLACES[0].records if record.engine == "alpha" and record.quantity == "Mkr"]
    bold = [line for line in axes.get_lines() if line.get_color() == INKS["alpha"] and line.get_marker() == "None"]
    drawn = {line.get_linestyle(): line for line in bold}
    assert set(drawn) == {"-", "--"}
    for style, runs in (("-", {1}), ("--", {2, 4})):
        front = on_front([record for record in records if record.runs in runs])
        assert list(drawn[style].get_ydata()) == [record.error_max for record in front]


def test_the_control_is_named_muted_last_and_outside_the_front():
    bench = made_up_bench(control="alpha")
    colours, place = inks(bench), places(bench)[0]
    assert list(colours) == ["beta", "alpha"]
    assert colours == {"beta": INKS["beta"], "alpha": MUTED}
    axes = bench_figure([place], colours, "Mkr").axes[0]
    assert {text.get_text() for text in axes.texts} == {"control", "beta"}
    broad = [line for line in axes.get_lines() if line.get_color() == REFERENCE]
    assert [line.get_linestyle() for line in broad] == ["-", "--"]
    beta = apart(one for one in place.records if one.engine == "beta" and one.quantity == "Mkr")
    assert [list(line.get_xdata()) for line in broad] == [[one.seconds_min for one in on_front(part)] for part in beta]
    data, _ = _figure(bench_html(place, colours, "key"))
    assert [trace["x"] for trace in data[:2]] == [list(line.get_xdata()) for line in broad]
    overall = {trace["name"] for trace in data[:2]}
    assert {trace["name"].partition(":")[0] for trace in data} == {"alpha (control)", "beta", *overall}


def test_every_point_of_a_method_at_its_own_effort_is_drawn_and_every_setting_marked():
    axes = bench_figure(PLACES, INKS, "Mkr").axes[0]
    sweeps = [len(line.get_xdata()) for line in axes.get_lines() if line.get_marker() == "."]
    assert sorted(sweeps) == [6, 6, 8, 8]
    marks = [line.get_marker() for line in axes.get_lines() if line.get_marker() in "os*"]
    assert sorted(marks) == ["*", "*", "o", "o", "s", "s"]
    assert {text.get_text() for text in axes.texts} == {"alpha", "beta"}


def test_another_quantity_can_be_drawn():
    assert bench_figure(PLACES, INKS, "joint_force").axes[0].get_title(loc="left").endswith("joint force")


def _figure(html):
    found = re.search(r'Plotly\.newPlot\(\s*"key",\s*(\[.*?\]),\s*(\{.*\}),\s*\{"displaylogo"', html, re.DOTALL)
    return json.loads(found[1]), json.loads(found[2])


def test_the_interactive_plot_holds_every_record_of_every_quantity():
    data, layout = _figure(bench_html(PLACES[0], INKS, "key"))
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
    data, _ = _figure(bench_html(PLACES[0], INKS, "key"))
    shown = [trace["name"] for trace in data if trace["visible"] is True]
    assert len([name for name in shown if name.startswith("alpha")]) == 7
    assert {"alpha: higher x2", "alpha: setting best x4"} < set(shown)
    dashes = {trace["name"]: trace["line"]["dash"] for trace in data if "dash" in trace.get("line", {})}
    assert dashes["alpha: plain"] == dashes["alpha: front, 1 run"] == "solid"
    assert dashes["alpha: higher x2"] == dashes["alpha: front, several runs extrapolated"] != "solid"
    waiting = [trace["name"] for trace in data if trace["visible"] == "legendonly"]
    assert waiting == ["alpha: plain, 10 iterations", "beta: plain, 10 iterations"]


def test_pointing_at_a_point_tells_everything_of_it():
    data, _ = _figure(bench_html(PLACES[0], INKS, "key"))
    (words,) = next(trace["hovertext"] for trace in data if trace["name"] == "alpha: setting tuned")
    for part in (
        "alpha 1.0",
        "setting tuned",
        "max 4.0e-4",
        "fixed by the adapter; 1 run",
        "repeats:",
        "set-up",
        "700 steps",
    ):
        assert part in words
