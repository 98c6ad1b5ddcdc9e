"use strict";
// Curves over the motion on canvases: those of the design, and thin behind them those of the file.
linkproof.liveCurves = (data, model, scrubbed) => {
  const TALL = 170, EDGE = { left: 62, right: 10, top: 22, bottom: 22 }; // px
  const { make, swatch } = linkproof.controls, names = data.results.map((one) => one.name);
  const loads = names.filter((name) => name.startsWith("joint_force:") && name.endsWith(":magnitude"));
  const charts = [["S"], ["v"], ["a"], ["Mkr"], ["Jeq"], loads].filter(([first]) => names.includes(first));
  const box = make("div", "", { className: "live-curves" });
  const drawn = charts.map(chart);
  let colours = linkproof.colours(), font = "";

  function chart(rows, number) {
    const { unit, size } = data.results[model.places.get(rows[0])], isLoads = rows === loads;
    const name = isLoads ? "Bearing forces" : rows[0] === "Mkr" && data.motion.linear ? "force" : rows[0];
    const title = `${name}, ${unit}`, figure = make("figure"), caption = make("figcaption", title);
    const canvas = make("canvas", "", { role: "img", ariaLabel: `${title}, over the motion` });
    const cursor = make("span", "", { className: "cursor" }), plot = make("div", "", { className: "live-plot" });
    for (const [n, load] of isLoads ? rows.entries() : []) {
      const key = make("span", ` ${load.slice(12, -10)}`, { className: "live-key" });
      key.prepend(swatch(`c${n % 6}`));
      caption.append(key);
    }
    plot.append(canvas, cursor);
    figure.append(caption, plot);
    box.append(figure);
    for (const kind of ["pointerdown", "pointermove"])
      canvas.addEventListener(kind, (event) => {
        const area = canvas.getBoundingClientRect(), at = event.clientX - area.left - EDGE.left;
        if (event.buttons) scrubbed(at / (area.width - EDGE.left - EDGE.right));
      });
    return { rows, size, number, canvas, cursor, width: 0 };
  }

  /** Take what the page's layout and colours say, which costs more than to draw. */
  function measure() {
    colours = linkproof.colours();
    font = `12px ${getComputedStyle(document.body).fontFamily}`;
    for (const one of drawn) one.width = one.canvas.clientWidth;
  }

  function short(value) {
    const size = Math.abs(value), isFar = size >= 1e5 || (size > 0 && size < 1e-3);
    return (isFar ? value.toExponential(1) : String(Number(value.toPrecision(3)))).replace("-", "−");
  }

  /** Where the axis begins and ends, for all of some motions: φ at constant speed, else the time. */
  function ends(...motions) {
    const marks = motions.flatMap(({ phi, duration }) => (data.motion.steady ? [phi[0], phi.at(-1)] : [0, duration]));
    const [low, high] = [Math.min(...marks), Math.max(...marks)];
    return marks[1] < marks[0] ? [high, low] : [low, high];
  }

  /** The least and the largest value of results over two motions. */
  function range(rows, motions) {
    let [low, high] = rows.length > 1 || rows[0] === "Jeq" ? [0, -Infinity] : [Infinity, -Infinity];
    for (const { found, moves, times } of motions)
      for (const name of rows) {
        const row = model.places.get(name) * times.length;
        for (let i = 0; i < times.length; i += 1) {
          const value = found[row + i];
          if (!moves[i] || !Number.isFinite(value)) continue;
          if (value < low) low = value;
          if (value > high) high = value;
        }
      }
    return high > low ? [low, high] : [(low || 0) - 1e-12, (low || 0) + 1e-12];
  }

  function draw(over, before, told) {
    const axis = ends(over, before), dense = window.devicePixelRatio || 1;
    const share = (place) => (place - axis[0]) / (axis[1] - axis[0]);
    const shares = (one) => Array.from(data.motion.steady ? one.phi : one.times, share);
    const across = new Map([before, over].map((one) => [one, shares(one)]));
    const marks = [0, 0.5, 1].map((at) => [at, told(axis[0] + at * (axis[1] - axis[0]))]);
    for (const { rows, size, number, canvas, width } of drawn.filter((one) => one.width)) {
      const right = width - EDGE.right, foot = TALL - EDGE.bottom, pen = canvas.getContext("2d");
      const [low, high] = range(rows, [before, over]);
      const x = (at) => EDGE.left + at * (right - EDGE.left);
      const y = (value) => foot - ((value - low) / (high - low)) * (foot - EDGE.top);
      if (canvas.width !== Math.round(width * dense))
        Object.assign(canvas, { width: Math.round(width * dense), height: Math.round(TALL * dense) });
      pen.setTransform(dense, 0, 0, dense, 0, 0);
      pen.clearRect(0, 0, width, TALL);
      Object.assign(pen, { font, fillStyle: colours.muted, strokeStyle: colours.line, lineWidth: 1, textAlign: "right" });
      for (const value of low < 0 && high > 0 ? [low, 0, high] : [low, high]) {
        const isCrowded = value === 0 && low < 0 && high > 0 && Math.min(y(low) - y(0), y(0) - y(high)) <= 14;
        pen.beginPath();
        pen.moveTo(EDGE.left, y(value));
        pen.lineTo(right, y(value));
        pen.stroke();
        if (!isCrowded) pen.fillText(short(value / size), EDGE.left - 6, y(value) + 4);
      }
      for (const [at, text] of marks) {
        pen.textAlign = at === 0 ? "left" : at === 1 ? "right" : "center";
        pen.fillText(text, x(at), TALL - 5);
      }
      for (const one of [before, over])
        for (const [n, name] of rows.entries()) {
          const isBehind = one === before && one !== over;
          pen.strokeStyle = isBehind ? colours.muted : colours.c[(rows.length > 1 ? n : number) % 6];
          pen.lineWidth = one === over ? 2 : 0.9;
          curve(pen, one, model.places.get(name) * one.times.length, (i) => x(across.get(one)[i]), y);
        }
    }
  }

  function curve(pen, { found, moves, times }, row, x, y) {
    let isOn = false;
    pen.beginPath();
    for (let i = 0; i < times.length; i += 1) {
      const isSeen = moves[i] && Number.isFinite(found[row + i]);
      if (isSeen) pen[isOn ? "lineTo" : "moveTo"](x(i), y(found[row + i]));
      isOn = isSeen;
    }
    pen.stroke();
  }

  /** Put the cursors at a place of the axis, of which the drawing has those of two motions. */
  function point(over, before, place) {
    const [low, high] = ends(over, before), share = (place - low) / (high - low);
    for (const { cursor, width } of drawn)
      cursor.style.left = `${EDGE.left + share * (width - EDGE.left - EDGE.right)}px`;
  }

  return { box, draw, point, measure, ends };
};
