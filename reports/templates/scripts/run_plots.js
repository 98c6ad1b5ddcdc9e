/* Errors and curves of runs as Plotly's traces and layouts, which are functions of the page's colours, and words. */
"use strict";
linkproof.runPlots = (() => {
  const SIGNS = { naive: "open ···", tuned: "filled —", best: "outlined – –" };
  const DASHES = { naive: "dot", best: "dash" }, { inked, marker } = linkproof.controls;
  const title = (text) => ({ text, standoff: 8 });

  /* Values at increasing times, between the samples of a curve. */
  function between(times, values, wanted) {
    let next = 1;
    if (times.length < 2) return wanted.map(() => values[0]);
    return wanted.map((time) => {
      while (next < times.length - 1 && times[next] < time) next += 1;
      const share = (time - times[next - 1]) / (times[next] - times[next - 1] || 1);
      return values[next - 1] + share * (values[next] - values[next - 1]);
    });
  }

  const sentence = (words) => `${words.slice(0, 1).toUpperCase()}${words.slice(1)}.`;

  function across(y, yref, line) {
    return { type: "line", xref: "paper", x0: 0, x1: 1, yref, y0: y, y1: y, line: { width: 1.2, ...line } };
  }

  function upright(x, line) {
    return { type: "line", xref: "x", x0: x, x1: x, yref: "paper", y0: 0, y1: 1, line: { width: 1.2, ...line } };
  }

  /* Every error over its limit: quantities down, an engine's lane in each, the setting by its marker. */
  function errorPlot(data, at, shown, isNarrow) {
    const lanes = shown.engines.length;
    const fitting = (words) => (words.length > 18 ? `${words.slice(0, 17)}…` : words);
    const names = at.quantities.map((one) => (isNarrow ? fitting(one.short) : one.title));
    const dots = (engine, setting) => at.errors.filter(
      ([, e, s]) => data.engines[e] === engine && data.settings[s] === setting);
    const trace = (engine, lane, setting, colours) => {
      const [ink, symbol] = data.looks[engine];
      const rows = dots(engine, setting), off = 0.72 * ((lane + 0.5) / lanes - 0.5);
      return {
        type: "scatter", mode: "markers", meta: "errors", name: `${engine} ${setting}`, showlegend: false,
        x: rows.map(([, , , error, limit]) => error / limit), y: rows.map(([quantity]) => quantity + off),
        customdata: rows.map(([quantity, , , error, limit]) => [quantity, error, limit, at.quantities[quantity].title]),
        marker: marker(colours, ink, symbol, setting, 8),
        hovertemplate: `<b>${engine} ${setting}</b><br>%{customdata[3]}<br>error %{customdata[1]:.1e} of the peak, `
          + "limit %{customdata[2]:.1e}<extra></extra>",
      };
    };
    const traces = (colours) => shown.engines.flatMap((engine, lane) => shown.settings.map(
      (setting) => trace(engine, lane, setting, colours)));
    const layout = ({ limit, faint }) => ({
      height: 96 + 24 * names.length, margin: { l: 8, r: 12, t: 8, b: 48 }, hovermode: "closest",
      shapes: [upright(1, { color: limit }), ...names.flatMap((_, n) => (n % 2 ? [{
        type: "rect", layer: "below", xref: "paper", x0: 0, x1: 1, y0: n - 0.5, y1: n + 0.5, fillcolor: faint,
        line: { width: 0 } }] : []))],
      xaxis: { type: "log", title: title("largest error over its limit"), exponentformat: "e", dtick: isNarrow ? 4 : 2 },
      yaxis: { tickvals: names.map((_, n) => n), ticktext: names, range: [names.length - 0.5, -0.5], showgrid: false,
        zeroline: false },
    });
    return [traces, layout, `${sentence(at.conditions)} Right of the line an error is over its limit. Choose a dot, or a `
      + "quantity above, to see its curves."];
  }

  /* A quantity by the closed form and by the runs, and beneath it their errors with their limits. */
  function curvePlot(data, at, quantity, curves, shown) {
    const [times, angles, values] = linkproof.unpacked(curves.truth), [name, factor] = data.axis;
    const turned = (wanted) => between(times, angles, wanted).map((angle) => angle * factor);
    const along = (wanted) => (shown.axis === "angle" ? turned(wanted) : wanted);
    const runs = curves.runs.filter(
      ({ engine, setting }) => shown.engines.includes(engine) && shown.settings.includes(setting));
    const drawn = (run, colours) => {
      const [ink, symbol] = data.looks[run.engine], color = inked(colours, ink);
      const [time, value, decades] = linkproof.unpacked(run.samples), x = along(time), angle = turned(time);
      const error = decades.map((decade) => 10 ** decade), who = `<b>${run.engine} ${run.setting}</b>`;
      const common = {
        type: "scatter", x, name: `${run.engine} ${run.setting}`, showlegend: false,
        customdata: time.map((one, n) => [one, angle[n], value[n], error[n]]),
        hovertemplate: `${who}<br>t = %{customdata[0]:.4~g} s, ${name.replace(", ", " = %{customdata[1]:.4~g} ")}<br>`
          + `%{customdata[2]:.4~g} ${quantity.unit}<br>error %{customdata[3]:.1e} of the peak<extra></extra>`,
      };
      const line = { color, width: 1.4, dash: DASHES[run.setting] };
      return [{ ...common, y: value, mode: "markers", marker: marker(colours, ink, symbol, run.setting, 4) },
        { ...common, y: error, yaxis: "y2", mode: "lines", line }];
    };
    const traces = (colours) => [
      { type: "scatter", mode: "lines", name: "closed form", x: along(times), y: values, showlegend: false,
        line: { color: colours.reference, width: 4 }, hovertemplate: `closed form %{y:.4~g} ${quantity.unit}<extra></extra>` },
      ...runs.flatMap((run) => drawn(run, colours)),
    ];
    const limits = [...new Set(runs.map((run) => run.limit).filter(Boolean))];
    const layout = ({ limit, muted }) => ({
      height: 540, hovermode: "closest", margin: { l: 72, r: 12, t: 12, b: 48 },
      shapes: [...along(at.jumps).map((x) => upright(x, { color: muted, dash: "dot", width: 1 })),
        ...limits.map((one) => across(one, "y2", { color: limit, dash: "dash" }))],
      annotations: limits.map((one) => ({ text: `limit ${one.toExponential()}`, font: { color: limit },
        showarrow: false, xref: "paper", x: 1, xanchor: "right", yref: "y2", y: Math.log10(one), yanchor: "bottom" })),
      xaxis: { title: title(shown.axis === "angle" ? name : "time, s"), anchor: "y2" },
      yaxis: { title: title(`${quantity.short}, ${quantity.unit}`), domain: [0.44, 1], exponentformat: "e" },
      yaxis2: { title: title("|error| / peak"), domain: [0, 0.38], type: "log", exponentformat: "e", dtick: 2 },
    });
    const vector = quantity.vector ? " The curves are the force's magnitude; its error is that of the magnitude." : "";
    const dotted = at.jumps.length ? " Dotted lines: jumps of the crank's acceleration." : "";
    return [traces, layout, `${sentence(at.conditions)} The broad line is the closed form; of each run the sample with the `
      + `largest error of every stretch is shown.${dotted}${vector}`];
  }

  return { SIGNS, errorPlot, curvePlot };
})();
