"use strict";
// Curves over the motion on canvases: those of the design, and thin behind them those of the file; dots are peaks.
linkproof.liveCurves = (data, model, before, pointed) => {
  const TALL = 128, EDGE = { left: 54, right: 12, top: 8, bottom: 20 }, APART = { x: 62, y: 30 }; // px
  const MOST = 10, ROUNDING = 1e-12; // curves of one chart, those of the largest values; of the largest value
  const ANGLES = [1, 2, 5, 10, 15, 30, 45, 60, 90, 180, 360, 720]; // between two marks, degrees
  const { motion, results, length } = data, { make, swatch } = linkproof.controls;
  const names = results.map((one) => one.name), drive = motion.linear ? "force Mkr" : "torque Mkr";
  const largest = (name) => {
    const count = before.times.length, row = model.places.get(name) * count;
    return before.found.subarray(row, row + count).reduce((most, one) => (Math.abs(one) > most ? Math.abs(one) : most), 0);
  };
  const these = (start, end = "") => {
    const every = names.filter((name) => name.startsWith(start) && name.endsWith(end) && largest(name) > 0);
    const chosen = [...every].sort((one, other) => largest(other) - largest(one)).slice(0, MOST);
    return every.filter((name) => chosen.includes(name));
  };
  const box = make("div", "", { className: "live-curves" });
  const drawn = [
    ["displacement S", ["S"]], ["velocity v", ["v"]], ["acceleration a", ["a"]], [drive, ["Mkr"]],
    ["power Peq", ["Peq"]], ["energy Teq", ["Teq"]], [motion.linear ? "mass Jeq" : "inertia Jeq", ["Jeq"]],
    ["joint forces", these("joint_force:", ":magnitude")], ["shaking force", ["shaking_force:magnitude"]],
    ["shaking moment", ["shaking_moment"]], ["transmission angle", these("transmission_angle:")],
  ].filter(([, rows]) => rows.length && names.includes(rows[0]) && !(data.isSampled && rows.every((row) => !largest(row))))
    .map(chart);
  let colours = linkproof.colours(), font = "";

  function chart([title, rows], number) {
    const { unit, size } = results[model.places.get(rows[0])], words = `${title}, ${unit === "deg" ? "°" : unit}`;
    const caption = make("figcaption", words), peak = make("span", "", { className: "live-peak muted" });
    const canvas = make("canvas", "", { role: "img", ariaLabel: `${words}, over the motion` });
    const cursor = make("span", "", { className: "cursor" }), plot = make("div", "", { className: "live-plot" });
    const values = rows.map((name, n) => {
      const key = make("span", "", { className: rows.length > 1 ? "live-key" : "" }), value = make("b");
      const part = name.replace(/^[a-z_]+:/, "").replace(":magnitude", "").replaceAll("_", " ");
      if (rows.length > 1) key.append(swatch(`c${n % 6}`), `${part} `);
      key.append(value);
      caption.append(key);
      return value;
    });
    caption.append(peak);
    plot.append(canvas, cursor);
    box.append(make("figure"));
    box.lastChild.append(caption, plot);
    for (const kind of ["pointerdown", "pointermove"])
      canvas.addEventListener(kind, (event) => {
        const area = canvas.getBoundingClientRect(), at = event.clientX - area.left - EDGE.left;
        pointed(at / (area.width - EDGE.left - EDGE.right), event.buttons > 0);
      });
    canvas.addEventListener("pointerleave", () => pointed(null, false));
    return { rows, size, number, canvas, cursor, values, peak, width: 0, scale: 0 };
  }

  /** Take what the page's layout and colours say, which costs more than to draw. */
  function measure() {
    colours = linkproof.colours();
    font = `12px ${getComputedStyle(document.body).fontFamily}`;
    for (const one of drawn) one.width = one.canvas.clientWidth;
  }

  function short(value) {
    const size = Math.abs(value), isFar = size >= 1e5 || (size > 0 && size < 1e-3);
    const text = isFar ? value.toExponential(1).replace(".0e", "e").replace("e+", "e") : String(Number(value.toPrecision(6)));
    return text.replaceAll("-", "−");
  }

  /** Round numbers between two ends, about so many; their distance is one of a list, or round. */
  function marks(low, high, most, known = []) {
    const least = (0.75 * (high - low)) / Math.max(most, 1), ten = 10 ** Math.floor(Math.log10(least));
    const step = known.find((one) => one >= least) ?? [1, 2, 2.5, 5, 10].find((one) => one * ten >= least * 0.999) * ten;
    const first = Math.ceil(low / step - 1e-9);
    return Array.from({ length: Math.floor(high / step + 1e-9) - first + 1 }, (_, n) => (first + n) * step);
  }

  /** Where the axis begins and ends, for all of some motions: φ at constant speed, else the time. */
  function ends(...motions) {
    const places = motions.flatMap(({ phi, duration }) => (motion.steady ? [phi[0], phi.at(-1)] : [0, duration]));
    const [low, high] = [Math.min(...places), Math.max(...places)];
    return places[1] < places[0] ? [high, low] : [low, high];
  }

  /** The least and the largest value of results over two motions, with some room. */
  function range(rows, motions) {
    let [low, high] = rows.length > 1 || rows[0] === "Jeq" ? [0, -Infinity] : [Infinity, -Infinity];
    for (const { found, moves, times } of motions)
      for (const name of rows) {
        const row = model.places.get(name) * times.length;
        for (let i = 0; i < times.length; i += 1) {
          const value = found[row + i];
          if (moves[i] && Number.isFinite(value)) {
            if (value < low) low = value;
            if (value > high) high = value;
          }
        }
      }
    const room = high - low > 1e-9 * Math.abs(high) ? 0.05 * (high - low) : 0.1 * Math.abs(high) || 1;
    return Number.isFinite(high) ? [low === 0 ? 0 : low - room, high + room] : [0, 1];
  }

  /** Draw all curves with the ``tops`` of results: name of the result, time, value, and what is said of it. */
  function draw(over, tops) {
    const axis = ends(over, before), dense = window.devicePixelRatio || 1;
    const share = (place) => (place - axis[0]) / (axis[1] - axis[0]);
    const shares = (one) => Array.from(motion.steady ? one.phi : one.times, share);
    const across = new Map([before, over].map((one) => [one, shares(one)]));
    const isAngle = motion.steady && !motion.linear;
    const unit = isAngle ? Math.PI / 180 : motion.steady ? length.size : Math.abs(over.pace);
    const spread = axis.map((one) => one / unit).sort((one, other) => one - other);
    for (const one of drawn.filter(({ width }) => width)) {
      const { rows, size, number, canvas, peak, width } = one;
      const right = width - EDGE.right, foot = TALL - EDGE.bottom, pen = canvas.getContext("2d");
      const [low, high] = range(rows, [before, over]);
      one.scale = Math.max(-low, high);
      const x = (at) => EDGE.left + at * (right - EDGE.left);
      const y = (value) => foot - ((value - low) / (high - low)) * (foot - EDGE.top);
      if (canvas.width !== Math.round(width * dense))
        Object.assign(canvas, { width: Math.round(width * dense), height: Math.round(TALL * dense) });
      pen.setTransform(dense, 0, 0, dense, 0, 0);
      pen.clearRect(0, 0, width, TALL);
      Object.assign(pen, { font, fillStyle: colours.muted, lineWidth: 1, textAlign: "right" });
      for (const value of marks(low / size, high / size, (foot - EDGE.top) / APART.y)) {
        rule(pen, [EDGE.left, y(value * size)], [right, y(value * size)], value === 0 ? colours.muted : colours.line);
        pen.fillText(short(value), EDGE.left - 6, y(value * size) + 4);
      }
      pen.textAlign = "center";
      for (const value of marks(...spread, (right - EDGE.left) / APART.x, isAngle ? ANGLES : [])) {
        const at = x(share(value * unit));
        rule(pen, [at, foot], [at, foot + 3], colours.muted);
        pen.fillText(`${short(value)}${isAngle ? "°" : ""}`, Math.min(at, right - 6), TALL - 4);
      }
      for (const way of new Set([before, over]))
        for (const [n, name] of rows.entries()) {
          pen.strokeStyle = way === over ? colours.c[(rows.length > 1 ? n : number) % 6] : colours.muted;
          pen.lineWidth = way === over ? 2 : 0.9;
          curve(pen, way, model.places.get(name) * way.times.length, (i) => x(across.get(way)[i]), y);
        }
      const mine = tops.filter(({ signal }) => rows.includes(signal));
      for (const { signal, time, height } of mine) {
        pen.fillStyle = colours.c[(rows.length > 1 ? rows.indexOf(signal) : number) % 6];
        pen.beginPath();
        pen.arc(x(share(motion.steady ? over.phiAt(time / over.duration) : time)), y(height), 3.5, 0, 7);
        pen.fill();
      }
      if (rows.length === 1) peak.textContent = mine.map(({ words }) => words).join("; ");
    }
  }

  function rule(pen, from, to, colour) {
    pen.strokeStyle = colour;
    pen.beginPath();
    pen.moveTo(...from);
    pen.lineTo(...to);
    pen.stroke();
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

  /** Put the cursors at a share of a motion, with the values there, of which ``told`` makes words. */
  function point(over, share, told) {
    const [low, high] = ends(over, before), place = motion.steady ? over.phiAt(share) : share * over.duration;
    const count = over.times.length, i = Math.min(Math.floor(share * (count - 1)), count - 2), part = share * (count - 1) - i;
    for (const { rows, cursor, values, width, scale } of drawn) {
      cursor.style.left = `${EDGE.left + ((place - low) / (high - low)) * (width - EDGE.left - EDGE.right)}px`;
      for (const [n, name] of rows.entries()) {
        const row = model.places.get(name), here = row * count + i;
        const value = over.moves[i] ? over.found[here] + part * (over.found[here + 1] - over.found[here]) : NaN;
        values[n].textContent = told(Math.abs(value) < ROUNDING * scale ? 0 : value / results[row].size);
      }
    }
  }

  return { box, draw, point, measure, ends, rows: drawn.flatMap(({ rows }) => rows) };
};
