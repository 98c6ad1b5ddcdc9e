"use strict";
// Curves over the motion on canvases: those of the design, and thin behind them those of the file.
linkproof.liveCurves = (data, model, scrubbed) => {
  const TALL = 170,
    EDGE = { left: 62, right: 10, top: 22, bottom: 22 };
  const names = data.results.map((one) => one.name),
    loads = names.filter((name) => name.startsWith("joint_force:") && name.endsWith(":magnitude"));
  const unit = (name) => data.results[model.places.get(name)];
  const charts = [["S"], ["v"], ["a"], ["Mkr"], ["Jeq"], loads].filter(
    (rows) => rows.length && names.includes(rows[0]),
  );
  const box = linkproof.controls.make("div", "", { className: "live-curves" });
  const drawn = charts.map((rows) => {
    const title =
      rows === loads
        ? `Bearing forces, ${unit(rows[0]).unit}`
        : `${rows[0] === "Mkr" && data.motion.linear ? "force" : rows[0]}, ${unit(rows[0]).unit}`;
    const figure = linkproof.controls.make("figure"),
      canvas = linkproof.controls.make("canvas"),
      cursor = linkproof.controls.make("span", "", { className: "cursor" });
    const caption = linkproof.controls.make("figcaption", title),
      plot = linkproof.controls.make("div", "", { className: "live-plot" });
    canvas.setAttribute("role", "img");
    canvas.setAttribute("aria-label", `${title}, over the motion`);
    if (rows === loads)
      caption.append(
        ...rows.map((name, n) => {
          const key = linkproof.controls.make("span", ` ${name.slice(12, -10)}`, { className: "live-key" });
          key.prepend(linkproof.controls.swatch(`c${n % 6}`));
          return key;
        }),
      );
    plot.append(canvas, cursor);
    figure.append(caption, plot);
    box.append(figure);
    const move = (event) => {
      if (!event.buttons) return;
      const area = canvas.getBoundingClientRect(),
        share = (event.clientX - area.left - EDGE.left) / (area.width - EDGE.left - EDGE.right);
      scrubbed(share);
    };
    canvas.addEventListener("pointerdown", move);
    canvas.addEventListener("pointermove", move);
    return { rows: rows, canvas, cursor, width: 0 };
  });
  let colours = linkproof.colours(),
    font = "";

  /** Take what the page's layout and colours say, which costs more than to draw. */
  function measure() {
    colours = linkproof.colours();
    font = `12px ${getComputedStyle(document.body).fontFamily}`;
    for (const one of drawn) one.width = one.canvas.clientWidth;
  }

  const short = (value) =>
    (Math.abs(value) >= 1e5 || (value && Math.abs(value) < 1e-3)
      ? value.toExponential(1)
      : String(Number(value.toPrecision(3)))
    ).replace("-", "−");

  /** Shares of the width of the instants, 0 to 1: by φ at constant speed, else by the time. */
  const across = (over, [low, high]) =>
    Array.from(data.motion.steady ? over.phi : over.times, (at) => (at - low) / (high - low));

  /** Where the axis begins and ends: for both of two motions. */
  const ends = (...motions) => {
    const marks = motions.flatMap((over) =>
      data.motion.steady ? [over.phi[0], over.phi[over.phi.length - 1]] : [0, over.duration],
    );
    const sign = marks[1] < marks[0] ? -1 : 1;
    return [sign * Math.min(...marks.map((mark) => sign * mark)), sign * Math.max(...marks.map((mark) => sign * mark))];
  };

  function draw(over, before, told) {
    const axis = ends(over, before),
      dense = window.devicePixelRatio || 1,
      shares = new Map([before, over].map((one) => [one, across(one, axis)]));
    const marks = [0, 0.5, 1].map((at) => [at, told(axis[0] + at * (axis[1] - axis[0]))]);
    for (const { rows, canvas, width } of drawn) {
      const right = width - EDGE.right,
        low_ = TALL - EDGE.bottom,
        pen = canvas.getContext("2d");
      if (!width) continue;
      if (canvas.width !== Math.round(width * dense))
        Object.assign(canvas, { width: Math.round(width * dense), height: Math.round(TALL * dense) });
      pen.setTransform(dense, 0, 0, dense, 0, 0);
      pen.clearRect(0, 0, width, TALL);
      const size = unit(rows[0]).size;
      let [low, high] = [Infinity, -Infinity];
      for (const one of [before, over])
        for (const name of rows) {
          const count = one.times.length,
            row = model.places.get(name) * count;
          for (let i = 0; i < count; i += 1) {
            const value = one.found[row + i];
            if (one.moves[i] && Number.isFinite(value)) {
              if (value < low) low = value;
              if (value > high) high = value;
            }
          }
        }
      if (one_sided(rows)) low = Math.min(low, 0);
      if (!(high > low)) [low, high] = [(low || 0) - 1e-12, (low || 0) + 1e-12];
      const x = (at) => EDGE.left + at * (right - EDGE.left),
        y = (value) => low_ - ((value - low) / (high - low)) * (low_ - EDGE.top);
      pen.font = font;
      pen.fillStyle = colours.muted;
      pen.strokeStyle = colours.line;
      pen.lineWidth = 1;
      pen.textAlign = "right";
      for (const value of low < 0 && high > 0 ? [low, 0, high] : [low, high]) {
        pen.beginPath();
        pen.moveTo(EDGE.left, y(value));
        pen.lineTo(right, y(value));
        pen.stroke();
        if (value || Math.min(y(low) - y(0), y(0) - y(high)) > 14 || !(low < 0 && high > 0))
          pen.fillText(short(value / size), EDGE.left - 6, y(value) + 4);
      }
      for (const [at, text] of marks) {
        pen.textAlign = at === 0 ? "left" : at === 1 ? "right" : "center";
        pen.fillText(text, x(at), TALL - 5);
      }
      for (const [one, thick] of [
        [before, 0.9],
        [over, 2],
      ]) {
        rows.forEach((name, n) => {
          const count = one.times.length,
            row = model.places.get(name) * count,
            share = shares.get(one);
          let on = false;
          pen.beginPath();
          for (let i = 0; i < count; i += 1) {
            const isSeen = one.moves[i] && Number.isFinite(one.found[row + i]);
            if (isSeen) pen[on ? "lineTo" : "moveTo"](x(share[i]), y(one.found[row + i]));
            on = Boolean(isSeen);
          }
          pen.strokeStyle =
            one === before && one !== over
              ? colours.muted
              : colours.c[(rows.length > 1 ? n : drawn.findIndex((two) => two.rows === rows)) % 6];
          pen.lineWidth = thick;
          pen.stroke();
        });
      }
    }
  }
  const one_sided = (rows) => rows.length > 1 || rows[0] === "Jeq";

  /** Put the cursors at a place of the axis, of which the drawing has those of two motions. */
  function point(over, before, place) {
    const [low, high] = ends(over, before),
      share = (place - low) / (high - low);
    for (const { cursor, width } of drawn)
      cursor.style.left = `${EDGE.left + share * (width - EDGE.left - EDGE.right)}px`;
  }
  return { box, draw, point, measure, ends };
};
