/* The lines, marks and names of the diagram of error over cost, for its script. */
"use strict";
linkproof.bench = (() => {
  const DASHES = ["solid", "6px,3px"], HEIGHT = 560, LINE = 16;
  const isSetting = (sweep) => sweep.kind === "setting";
  const short = (value) => value.toExponential(1).replace("e+", "e");
  const time = (value) => (value < 1 ? `${(1e3 * value).toPrecision(3)} ms` : `${value.toPrecision(3)} s`);
  const plain = (text) => text.replace(/[<>&]/g, (sign) => `&#${sign.charCodeAt(0)};`);
  const wrapped = (text) => plain(text.replace(/(.{34,44}) /g, "$1\n")).replaceAll("\n", "<br>");

  /* The points that no other beats in both x and y, by x. */
  function front(points) {
    let least = Infinity;
    return [...points].sort((one, two) => one.x - two.x || one.y - two.y)
      .filter((one) => one.y < least && ((least = one.y), true));
  }

  function told(sweep, point, [key, words, unit, peak]) {
    const [, largest, mean] = point.errors[key], [ends, order] = sweep.ends[key] || [];
    return [
      `<b>${sweep.engine} ${sweep.engine_version}: ${isSetting(sweep) ? "setting " : ""}${plain(sweep.way)}</b>`,
      `${words}: largest ${short(largest)}, RMS ${short(mean)} of ${peak} ${unit}`,
      `${point.step ? `${Math.round(point.steps_per_turn)} steps a turn, ${point.step} s` : "step fixed by the adapter"}; ` +
        (sweep.runs > 1 ? `${sweep.runs} runs, extrapolated` : "1 run"),
      `stepping ${time(point.seconds)}, median ${time(point.seconds_median)}`,
      `set-up ${time(point.setup_seconds)}`,
      `${point.steps} steps${sweep.solver && `; ${sweep.solver}`}`,
      ends && `${order ? `order ${order.toFixed(1)}` : "no steady order"}; ${ends}`,
      point.used && wrapped(point.used),
    ].filter(Boolean).join("<br>");
  }

  const line = (points, colour, style, more) => ({ type: "scatter", mode: "lines", hoverinfo: "skip",
    x: points.map((one) => one.x), y: points.map((one) => one.y), line: { color: colour, ...style }, ...more });

  /* All traces of one engine, and its methods' fronts of single runs and of several: no line joins settings. */
  function drawn(data, quantity, value, engine, colours) {
    const { marker, inked } = linkproof.controls, colour = inked(colours, engine.ink);
    const kinds = [[], []], found = [], visible = engine.isOn;
    data.sweeps.filter((sweep) => sweep.engine === engine.name).forEach((sweep) => {
      const points = sweep.points.filter((one) => one.errors[quantity[0]] && value(one) > 0)
        .map((one) => ({ x: value(one), y: one.errors[quantity[0]][0], text: told(sweep, one, quantity) }));
      const kind = Number(sweep.runs > 1), style = { width: 1, dash: DASHES[kind] };
      if (!isSetting(sweep)) kinds[kind].push(...points);
      if (!points.length) return;
      found.push(line(points, colour, style, { visible, mode: "lines+markers", hoverinfo: "text", opacity: 0.85,
        hovertext: points.map((one) => one.text),
        marker: marker(colours, engine.ink, engine.symbol, sweep.setting, isSetting(sweep) ? 12 : 6) }));
    });
    kinds.map(front).forEach((points, kind) => found.push(line(points, colour, { width: 3, dash: DASHES[kind] }, { visible })));
    return { engine, colour, found, least: Math.min(...found.flatMap((trace) => trace.y)) };
  }

  /* Names at the right edge, at the heights of the least errors and moved apart where they would touch. */
  function names(parts, range) {
    const gap = (LINE * (range[1] - range[0])) / (HEIGHT - 60);
    let last = -Infinity;
    return parts.filter((one) => one.engine.isOn && one.least < Infinity).sort((one, two) => one.least - two.least)
      .map(({ engine, colour, least }) => ({ x: 1, xref: "paper", xanchor: "left", showarrow: false,
        y: (last = Math.max(Math.log10(least), last + gap)), text: engine.isControl ? "control" : engine.name,
        font: { color: colour, size: 13 } }));
  }

  const traces = (parts) => parts.flatMap((one) => one.found);

  function layout(parts, title) {
    const heights = parts.flatMap((one) => one.found.flatMap((trace) => trace.y)).map(Math.log10);
    const [low, high] = heights.length ? [Math.min(...heights), Math.max(...heights)] : [0, 0];
    const range = [Math.floor(low) - 0.4, Math.ceil(high) + 0.2];
    const log = { type: "log", exponentformat: "power", dtick: 1, tickfont: { size: 14 } };
    return { height: HEIGHT, showlegend: false, hovermode: "closest", margin: { l: 60, r: 70, t: 12, b: 48 },
      annotations: names(parts, range), xaxis: { ...log, title: { text: title } },
      yaxis: { ...log, dtick: 2, range, title: { text: "largest |error| / peak", standoff: 12 } } };
  }

  return { drawn, traces, layout };
})();
