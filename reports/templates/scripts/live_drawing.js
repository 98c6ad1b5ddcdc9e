"use strict";
// The linkage as it stands, in lines that follow its points; a handle at every point that can be pulled.
linkproof.liveDrawing = (data, model, pulled) => {
  const SPACE = "http://www.w3.org/2000/svg",
    RIM = 34,
    TALL = 430,
    PIN = 5.5,
    GRIP = 16;
  const make = (tag, names, parent) => {
    const element = document.createElementNS(SPACE, tag);
    for (const [name, value] of Object.entries(names)) element.setAttribute(name, value);
    parent?.append(element);
    return element;
  };
  const svg = make("svg", {
    class: "live-scheme",
    role: "group",
    "aria-label": "The linkage: points can be pulled, or moved by arrow keys",
  });
  const layer = (name) => make("g", { class: name }, svg);
  const [ghosts, paths, guides, bars, springs, joints, words, grips] = [
    "ghosts",
    "paths",
    "guides",
    "bars",
    "springs",
    "joints",
    "words",
    "grips",
  ].map(layer);
  const ground = new Set(Object.keys(data.bodies.ground)),
    bodies = Object.entries(data.bodies).filter(([name]) => name !== "ground");
  const names = [...new Set(Object.values(data.bodies).flatMap((points) => Object.keys(points)))];
  const joined = new Set(
    names.filter(
      (name) =>
        ground.has(name) ||
        data.guides.some((guide) => guide.point === name) ||
        bodies.filter(([, points]) => name in points).length > 1,
    ),
  );
  const free = names.filter((name) => !joined.has(name) && name !== data.output);
  const shapes = new Map();
  const shape = (key, tag, names_, parent) => shapes.set(key, make(tag, names_, parent));
  let view = { left: 0, top: 0, scale: 1, width: 600, height: TALL },
    frame = null;

  for (const name of names) {
    const colour = name === data.output ? "c0" : `c${1 + (Math.max(free.indexOf(name), 0) % 5)}`,
      own = name === data.output || free.includes(name);
    shape(`before:${name}`, "path", { class: "before" }, ghosts);
    shape(
      `path:${name}`,
      "path",
      { class: own ? "trace" : "joint-trace", style: own ? `stroke: var(--${colour})` : "" },
      paths,
    );
  }
  for (const guide of data.guides)
    shape(`guide:${guide.name}`, "path", { class: guide.host === "ground" ? "guide" : "slot" }, guides);
  for (const [name] of bodies) shape(`bar:${name}`, "path", { class: "bar" }, bars);
  for (const guide of data.guides) if (guide.link) shape(`block:${guide.name}`, "path", { class: "block" }, bars);
  data.springs.forEach((_, n) => shape(`spring:${n}`, "path", { class: "spring" }, springs));
  for (const name of data.centres) shape(`centre:${name}`, "path", { class: "centre" }, springs);
  for (const name of names) {
    shape(
      `pin:${name}`,
      joined.has(name) ? "circle" : "circle",
      { class: ground.has(name) ? "pin fixed" : joined.has(name) ? "pin" : "pin eye", r: joined.has(name) ? PIN : 3.5 },
      joints,
    );
    shape(`foot:${name}`, "path", { class: "foot", visibility: ground.has(name) ? "visible" : "hidden" }, guides);
    shape(`word:${name}`, "text", {}, words);
    shapes.get(`word:${name}`).textContent = name;
    if (!pulled.can(name)) continue;
    const grip = make(
      "circle",
      {
        class: "grip",
        r: GRIP,
        tabindex: 0,
        role: "button",
        "aria-label": `Point ${name}: pull it, or move it by arrow keys`,
      },
      grips,
    );
    shapes.set(`grip:${name}`, grip);
    grip.addEventListener("pointerdown", (event) => {
      event.preventDefault();
      grip.setPointerCapture(event.pointerId);
      grip.focus();
      pulled.begin(name);
    });
    grip.addEventListener("pointermove", (event) => {
      if (grip.hasPointerCapture(event.pointerId)) pulled.move(name, inWorld(event));
    });
    grip.addEventListener("pointerup", () => pulled.end());
    grip.addEventListener("keydown", (event) => {
      const way = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] }[event.key];
      if (!way) return;
      event.preventDefault();
      pulled.begin(name);
      pulled.move(
        name,
        frame.points[name].map((value, k) => value + way[k] * pulled.step() * (event.shiftKey ? 10 : 1)),
      );
      pulled.end();
    });
  }

  const px = ([x, y]) => [RIM + (x - view.left) * view.scale, RIM + (view.top - y) * view.scale];
  const line = (points, close = "") =>
    points.length && points.flat().every(Number.isFinite)
      ? `M${points
          .map((one) =>
            px(one)
              .map((value) => value.toFixed(1))
              .join(" "),
          )
          .join("L")}${close}`
      : "";
  function inWorld(event) {
    const box = svg.getBoundingClientRect();
    return [
      view.left + (((event.clientX - box.left) * view.width) / box.width - RIM) / view.scale,
      view.top - (((event.clientY - box.top) * view.height) / box.height - RIM) / view.scale,
    ];
  }

  /** A point of a body in its frame, m, by the design's numbers. */
  const local = (design, body, point, place) =>
    ["x", "y"].map((axis, k) => {
      const number = model.byName.get(`${body}.${point}.${axis}`);
      return number ? model.inSI(design, number) : place[k];
    });

  /** Where all points and frames are, from results of one row or of many. */
  function posed(design, found, row = 0, count = 1) {
    const value = (name) => found[model.places.get(name) * count + row],
      points = {},
      frames = { ground: { origin: [0, 0], angle: 0 } };
    for (const name of names)
      points[name] = ground.has(name)
        ? local(design, "ground", name, data.bodies.ground[name])
        : [value(`point:${name}:x`), value(`point:${name}:y`)];
    for (const [name, own] of bodies) {
      const [[point, place]] = Object.entries(own),
        angle = value(`link:${name}:angle`),
        at = turned(local(design, name, point, place), angle);
      frames[name] = { origin: [points[point][0] - at[0], points[point][1] - at[1]], angle };
    }
    return { points, frames };
  }
  const turned = ([x, y], angle) => [
    x * Math.cos(angle) - y * Math.sin(angle),
    x * Math.sin(angle) + y * Math.cos(angle),
  ];
  const placed = ({ origin, angle }, place) => turned(place, angle).map((value, k) => value + origin[k]);

  /** Fit the drawing around these courses of points, and around where they are now. */
  function fit(over, design) {
    const spots = [];
    for (let i = 0; i < over.times.length; i += 8)
      if (over.moves[i]) spots.push(...Object.values(posed(design, over.found, i, over.times.length).points));
    const [x, y] = [0, 1].map((k) => spots.map((spot) => spot[k]).filter(Number.isFinite));
    if (!x.length) return;
    const [left, right, bottom, top] = [Math.min(...x), Math.max(...x), Math.min(...y), Math.max(...y)],
      size = Math.max(right - left, top - bottom) || 1;
    const width = svg.clientWidth || 600,
      high = Math.min(TALL, width);
    const scale = Math.min(
      (width - 2 * RIM) / Math.max(right - left, size / 1e3),
      (high - 2 * RIM) / Math.max(top - bottom, size / 1e3),
    );
    const height = Math.max((top - bottom) * scale + 2 * RIM, 180);
    view = {
      scale,
      width,
      height,
      left: (left + right) / 2 - (width / 2 - RIM) / scale,
      top: (top + bottom) / 2 + (height / 2 - RIM) / scale,
    };
    svg.setAttribute("viewBox", `0 0 ${width} ${height}`);
    return size;
  }

  /** Whether all of a motion lies in the drawing, which is not much larger. */
  const holds = (over, design) => {
    for (let i = 0; i < over.times.length; i += 16) {
      if (!over.moves[i]) continue;
      for (const spot of Object.values(posed(design, over.found, i, over.times.length).points)) {
        const [x, y] = px(spot);
        if (x < 0 || y < 0 || x > view.width || y > view.height) return false;
      }
    }
    return true;
  };

  /** The curves of the points over a motion: those of a design, or thin those of the file. */
  function trace(over, design, key) {
    const count = over.times.length;
    for (const name of names) {
      if (ground.has(name)) continue;
      const [x, y] = ["x", "y"].map((axis) => model.places.get(`point:${name}:${axis}`) * count),
        spots = [[]];
      for (let i = 0; i < count; i += 4)
        if (over.moves[i]) spots.at(-1).push([over.found[x + i], over.found[y + i]]);
        else spots.push([]);
      shapes.get(`${key}:${name}`).setAttribute("d", spots.map((one) => line(one)).join(""));
    }
    for (const guide of data.guides) {
      let [low, high] = [Infinity, -Infinity];
      for (let i = 0; i < count; i += 8) {
        if (!over.moves[i]) continue;
        const { points, frames } = posed(design, over.found, i, count),
          host = frames[guide.host],
          start = placed(host, through(design, guide)),
          way = turned(guide.along, host.angle);
        const course = (points[guide.point][0] - start[0]) * way[0] + (points[guide.point][1] - start[1]) * way[1];
        [low, high] = [Math.min(low, course), Math.max(high, course)];
      }
      guide.reach = [low, high];
    }
  }
  const through = (design, guide) => local(design, guide.name, "through", guide.through);

  /** Draw one position; joints named in ``red`` are those that stop it. */
  function draw(design, found, red = []) {
    frame = posed(design, found);
    const { points, frames } = frame,
      set = (key, value) => shapes.get(key)?.setAttribute("d", value);
    for (const [name, own] of bodies) {
      const spots = Object.keys(own).map((point) => points[point]),
        middle = [0, 1].map((k) => spots.reduce((sum, one) => sum + one[k], 0) / spots.length);
      if (spots.length > 2)
        spots.sort(
          (one, two) =>
            Math.atan2(one[1] - middle[1], one[0] - middle[0]) - Math.atan2(two[1] - middle[1], two[0] - middle[0]),
        );
      set(`bar:${name}`, spots.length > 1 ? line(spots, spots.length > 2 ? "Z" : "") : "");
    }
    for (const guide of data.guides) {
      const host = frames[guide.host],
        [low, high] = guide.reach ?? [0, 0],
        spare = 12 / view.scale,
        start = through(design, guide);
      set(
        `guide:${guide.name}`,
        line(
          [low - spare, high + spare].map((way) =>
            placed(host, [start[0] + way * guide.along[0], start[1] + way * guide.along[1]]),
          ),
        ),
      );
      const way = host.angle + Math.atan2(guide.along[1], guide.along[0]),
        half = [
          [-1, -0.7],
          [1, -0.7],
          [1, 0.7],
          [-1, 0.7],
        ].map((one) =>
          turned(
            one.map((value) => (value * 11) / view.scale),
            way,
          ),
        );
      set(
        `block:${guide.name}`,
        line(
          half.map(([x, y]) => [points[guide.point][0] + x, points[guide.point][1] + y]),
          "Z",
        ),
      );
    }
    data.springs.forEach((spring, n) => {
      const [start, end] = spring.points.map((name) => points[name]),
        way = [end[0] - start[0], end[1] - start[1]],
        long = Math.hypot(...way) || 1;
      const at = (share, side) => [
        start[0] + share * way[0] - (side * way[1]) / long,
        start[1] + share * way[1] + (side * way[0]) / long,
      ];
      set(
        `spring:${n}`,
        line([
          at(0, 0),
          ...Array.from({ length: 12 }, (_, k) => at(0.15 + (0.7 * k) / 11, (k % 2 ? 6 : -6) / view.scale)),
          at(1, 0),
        ]),
      );
    });
    for (const name of data.centres) {
      const [x, y] = px(placed(frames[name], local(design, name, "centre", [NaN, NaN])));
      set(
        `centre:${name}`,
        Number.isFinite(x) ? `M${x - 5} ${y}h10M${x} ${y - 5}v10M${x - 5} ${y}a5 5 0 1 0 10 0a5 5 0 1 0 -10 0` : "",
      );
    }
    for (const name of names) {
      const [x, y] = px(points[name]),
        isSeen = Number.isFinite(x + y);
      for (const key of ["pin", "grip", "word", "foot"])
        shapes
          .get(`${key}:${name}`)
          ?.setAttribute("transform", isSeen ? `translate(${x.toFixed(1)} ${y.toFixed(1)})` : "translate(-999 -999)");
      shapes.get(`pin:${name}`).classList.toggle("stopped", red.includes(name));
    }
  }
  for (const name of names) {
    shapes.get(`word:${name}`).setAttribute("x", 9);
    shapes.get(`word:${name}`).setAttribute("y", -9);
    shapes.get(`foot:${name}`).setAttribute("d", "M0 0L-8 13H8ZM-12 13H12M-10 18l4-5M-4 18l4-5M2 18l4-5M8 18l4-5");
  }
  return { svg, draw, trace, fit, holds, local, posed, frame: () => frame };
};
