"use strict";
// The linkage as it stands, in lines that follow its points; a handle at every point that can be pulled.
linkproof.liveDrawing = (data, model, pulled) => {
  const SPACE = "http://www.w3.org/2000/svg", RIM = 34, PIN = 5.5, GRIP = 16; // px
  const WAYS = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };
  const BLOCK = [[-11, -7.7], [11, -7.7], [11, 7.7], [-11, 7.7]];
  const FOOT = "M0 0L-8 13H8ZM-12 13H12M-10 18l4-5M-4 18l4-5M2 18l4-5M8 18l4-5";
  const CENTRE = "M-5 0h10M0 -5v10M-5 0a5 5 0 1 0 10 0a5 5 0 1 0 -10 0";
  const shapes = new Map();
  const make = (tag, names, parent) => {
    const element = document.createElementNS(SPACE, tag);
    for (const [name, value] of Object.entries(names)) element.setAttribute(name, value);
    parent?.append(element);
    return element;
  };
  const label = "The linkage: points can be pulled, or moved by arrow keys";
  const svg = make("svg", { class: "live-scheme", role: "group", "aria-label": label });
  const layer = (name) => make("g", { class: name }, svg);
  const [ghosts, paths, guides, bars] = ["ghosts", "paths", "guides", "bars"].map(layer);
  const [springs, joints, arrowed, words, grips] = ["springs", "joints", "arrows", "words", "grips"].map(layer);
  const shape = (key, tag, attributes, parent) => shapes.set(key, make(tag, attributes, parent)).get(key);

  const ground = new Set(Object.keys(data.bodies.ground));
  const bodies = Object.entries(data.bodies).filter(([name]) => name !== "ground");
  const names = [...new Set(Object.values(data.bodies).flatMap((points) => Object.keys(points)))];
  const slides = (name) => data.guides.some((guide) => guide.point === name);
  const isShared = (name) => bodies.filter(([, points]) => name in points).length > 1;
  const joined = new Set(names.filter((name) => ground.has(name) || slides(name) || isShared(name)));
  const free = names.filter((name) => !joined.has(name) && name !== data.output);
  let shortest = 0; // length of the cylinder
  let view = { left: 0, top: 0, scale: 1, width: 600, height: 400 }, frame = null;

  for (const name of names) {
    const colour = name === data.output ? "c0" : `c${1 + (Math.max(free.indexOf(name), 0) % 5)}`;
    const own = name === data.output || free.includes(name);
    shape(`before:${name}`, "path", { class: "before" }, ghosts);
    const way = own ? { class: "trace", style: `stroke: var(--${colour})` } : { class: "joint-trace" };
    shape(`path:${name}`, "path", way, paths);
  }
  for (const { name, host } of data.guides)
    shape(`guide:${name}`, "path", { class: host === "ground" ? "guide" : "slot" }, guides);
  if (data.cylinder) for (const part of ["rod", "barrel"]) shape(part, "path", { class: part }, bars);
  for (const [name] of bodies) shape(`bar:${name}`, "path", { class: "bar" }, bars);
  for (const { name, link } of data.guides) if (link) shape(`block:${name}`, "path", { class: "block" }, bars);
  for (const n of data.springs.keys()) shape(`spring:${n}`, "path", { class: "spring" }, springs);
  for (const name of Object.keys(data.centres)) shape(`centre:${name}`, "path", { class: "centre", d: CENTRE }, springs);
  for (const name of names) {
    const kind = ground.has(name) ? "pin fixed" : joined.has(name) ? "pin" : "pin eye";
    shape(`pin:${name}`, "circle", { class: kind, r: joined.has(name) ? PIN : 3.5 }, joints);
    if (ground.has(name)) shape(`foot:${name}`, "path", { class: "foot", d: FOOT }, guides);
    shape(`word:${name}`, "text", { x: 9, y: -9 }, words).textContent = name;
    if (pulled.can(name)) handle(name);
  }

  function handle(name) {
    const told = `Point ${name}: pull it, or move it by arrow keys`;
    const named = { class: "grip", r: GRIP, tabindex: 0, role: "button", "aria-label": told };
    const grip = shape(`grip:${name}`, "circle", named, grips);
    grip.addEventListener("pointerdown", (event) => {
      event.preventDefault();
      grip.setPointerCapture(event.pointerId);
      grip.focus();
      pulled.begin(name);
    });
    grip.addEventListener("pointermove", (event) => {
      if (grip.hasPointerCapture(event.pointerId)) pulled.move(name, inWorld(event));
    });
    grip.addEventListener("lostpointercapture", () => pulled.end());
    grip.addEventListener("touchstart", (event) => event.preventDefault()); // else the page scrolls
    grip.addEventListener("keydown", (event) => {
      const way = WAYS[event.key], step = pulled.step() * (event.shiftKey ? 10 : 1);
      if (!way) return;
      event.preventDefault();
      pulled.begin(name);
      pulled.move(name, frame.points[name].map((value, k) => value + way[k] * step));
      pulled.end();
    });
  }

  const px = ([x, y]) => [RIM + (x - view.left) * view.scale, RIM + (view.top - y) * view.scale];
  function line(points, close = "") {
    if (!points.length || !points.flat().every(Number.isFinite)) return "";
    return `M${points.map((one) => px(one).map((value) => value.toFixed(1)).join(" ")).join("L")}${close}`;
  }
  function inWorld(event) {
    const box = svg.getBoundingClientRect();
    const x = ((event.clientX - box.left) * view.width) / box.width;
    const y = ((event.clientY - box.top) * view.height) / box.height;
    return [view.left + (x - RIM) / view.scale, view.top - (y - RIM) / view.scale];
  }

  /** A point of a body in its frame, m, by the design's numbers. */
  const local = (design, body, point, place) => ["x", "y"].map((axis, k) => {
    const number = model.byName.get(`${body}.${point}.${axis}`);
    return number ? model.inSI(design, number) : place[k];
  });
  function turned([x, y], angle) {
    const [c, s] = [Math.cos(angle), Math.sin(angle)];
    return [x * c - y * s, x * s + y * c];
  }
  const placed = ({ origin, angle }, place) => turned(place, angle).map((value, k) => value + origin[k]);
  const through = (design, guide) => local(design, guide.name, "through", guide.through);

  /** Where all points and frames are, from results of one row or of many. */
  function posed(design, found, row = 0, count = 1) {
    const value = (name) => found[model.places.get(name) * count + row];
    const points = {}, frames = { ground: { origin: [0, 0], angle: 0 } };
    for (const name of names)
      points[name] = ground.has(name)
        ? local(design, "ground", name, data.bodies.ground[name])
        : [value(`point:${name}:x`), value(`point:${name}:y`)];
    for (const [name, own] of bodies) {
      const [[point, place]] = Object.entries(own), angle = value(`link:${name}:angle`);
      const at = turned(local(design, name, point, place), angle);
      frames[name] = { origin: [points[point][0] - at[0], points[point][1] - at[1]], angle };
    }
    return { points, frames };
  }

  /** Every n-th position of a motion, where there is one. */
  function* positions(over, design, step) {
    for (let i = 0; i < over.times.length; i += step)
      if (over.moves[i]) yield posed(design, over.found, i, over.times.length);
  }

  /** Fit the drawing around a motion. */
  function fit(over, design) {
    const spots = [...positions(over, design, 8)].flatMap(({ points }) => Object.values(points));
    const [x, y] = [0, 1].map((k) => spots.map((spot) => spot[k]).filter(Number.isFinite));
    if (!x.length) return;
    const [left, right, bottom, top] = [Math.min(...x), Math.max(...x), Math.min(...y), Math.max(...y)];
    const least = (Math.max(right - left, top - bottom) || 1) / 1e3, width = svg.clientWidth || 600;
    const tall = Math.min(430, (innerWidth > 900 ? 0.5 : 0.36) * innerHeight); // px: curves are seen beside or below it
    const across = (width - 2 * RIM) / Math.max(right - left, least);
    const scale = Math.min(across, (Math.min(tall, width) - 2 * RIM) / Math.max(top - bottom, least));
    const height = Math.max((top - bottom) * scale + 2 * RIM, 180);
    const [middle, centre] = [(left + right) / 2, (top + bottom) / 2];
    view = { scale, width, height, left: middle - (width / 2 - RIM) / scale, top: centre + (height / 2 - RIM) / scale };
    svg.setAttribute("viewBox", `0 0 ${width} ${height}`);
  }

  /** Whether all of a motion lies in the drawing. */
  function holds(over, design) {
    for (const { points } of positions(over, design, 16))
      for (const [x, y] of Object.values(points).map(px))
        if (x < 0 || y < 0 || x > view.width || y > view.height) return false;
    return true;
  }

  /** The curves of the points over a motion: those of a design, or thin those of the file. */
  function trace(over, design, key) {
    const count = over.times.length;
    for (const name of names.filter((one) => !ground.has(one))) {
      const [x, y] = ["x", "y"].map((axis) => model.places.get(`point:${name}:${axis}`) * count), spots = [[]];
      for (let i = 0; i < count; i += 4)
        if (over.moves[i]) spots.at(-1).push([over.found[x + i], over.found[y + i]]);
        else spots.push([]);
      shapes.get(`${key}:${name}`).setAttribute("d", spots.map((one) => line(one)).join(""));
    }
    shortest = over.phi.reduce((least, phi, i) => (over.moves[i] && phi < least ? phi : least), Infinity);
    for (const guide of data.guides) guide.reach = [Infinity, -Infinity];
    if (data.guides.length)
      for (const { points, frames } of positions(over, design, 8))
        for (const guide of data.guides) {
          const host = frames[guide.host], start = placed(host, through(design, guide));
          const way = turned(guide.along, host.angle);
          const at = (points[guide.point][0] - start[0]) * way[0] + (points[guide.point][1] - start[1]) * way[1];
          guide.reach = [Math.min(guide.reach[0], at), Math.max(guide.reach[1], at)];
        }
  }

  const set = (key, d) => shapes.get(key)?.setAttribute("d", d);
  function put(key, place) {
    const [x, y] = px(place), there = Number.isFinite(x + y) ? `${x.toFixed(1)} ${y.toFixed(1)}` : "-999 -999";
    shapes.get(key)?.setAttribute("transform", `translate(${there})`);
  }

  /** Draw one position; joints named in ``red`` are those that stop it. */
  function draw(design, found, red = []) {
    frame = posed(design, found);
    const { points, frames } = frame;
    for (const [name, own] of bodies) drawBar(name, Object.keys(own).map((point) => points[point]));
    for (const guide of data.guides) drawGuide(design, guide);
    if (data.cylinder) drawCylinder(data.cylinder.map((name) => points[name]), shortest);
    for (const [n, spring] of data.springs.entries()) drawSpring(n, ...spring.points.map((name) => points[name]));
    for (const [name, place] of Object.entries(data.centres))
      put(`centre:${name}`, placed(frames[name], local(design, name, "centre", place)));
    for (const name of names) {
      for (const key of ["pin", "grip", "word", "foot"]) put(`${key}:${name}`, points[name]);
      shapes.get(`pin:${name}`).classList.toggle("stopped", red.includes(name));
    }
  }
  function drawBar(name, spots) {
    const [x, y] = [0, 1].map((k) => spots.reduce((sum, one) => sum + one[k], 0) / spots.length);
    const turn = (one) => Math.atan2(one[1] - y, one[0] - x);
    if (spots.length > 2) spots.sort((one, two) => turn(one) - turn(two));
    set(`bar:${name}`, spots.length > 1 ? line(spots, spots.length > 2 ? "Z" : "") : "");
  }
  function drawGuide(design, guide) {
    const host = frame.frames[guide.host], [low, high] = guide.reach, spare = 12 / view.scale;
    const start = through(design, guide), [x, y] = frame.points[guide.point];
    const along = (way) => placed(host, start.map((value, k) => value + way * guide.along[k]));
    const ends = [along(low - spare), along(high + spare)];
    const way = host.angle + Math.atan2(guide.along[1], guide.along[0]);
    const corners = BLOCK.map((one) => turned(one.map((value) => value / view.scale), way));
    set(`guide:${guide.name}`, line(ends));
    set(`block:${guide.name}`, line(corners.map((one) => [x + one[0], y + one[1]]), "Z"));
  }
  /** The barrel as long as the shortest cylinder leaves room for, and the rod. */
  function drawCylinder([start, end], shortest) {
    const long = Math.hypot(end[0] - start[0], end[1] - start[1]), part = (0.8 * shortest) / long;
    set("rod", line([start, end]));
    set("barrel", line([start, start.map((one, k) => one + part * (end[k] - one))]));
  }
  /** Arrows from points, px; those before go. */
  function arrows(list) {
    const { points } = frame;
    while (arrowed.children.length < list.length) make("path", {}, arrowed);
    for (const [n, element] of [...arrowed.children].entries()) {
      const { point, way, ink } = list[n] ?? { way: [NaN, NaN] }, long = Math.hypot(...way);
      const isSeen = long > 2 && points[point]?.every(Number.isFinite);
      element.setAttribute("d", isSeen ? arrow(px(points[point]), way[0], -way[1], long) : "");
      if (isSeen) element.setAttribute("style", `stroke: var(--${ink}); fill: var(--${ink})`);
    }
  }
  function arrow([x, y], across, down, long) {
    const [c, s] = [across / long, down / long], head = Math.min(9, long);
    const at = (a, b) => `${(x + a * c - b * s).toFixed(1)} ${(y + a * s + b * c).toFixed(1)}`;
    return `M${at(0, 0)}L${at(long - head, 0)}M${at(long, 0)}L${at(long - head, head / 2.6)}L${at(long - head, -head / 2.6)}Z`;
  }
  function drawSpring(n, start, end) {
    const way = [end[0] - start[0], end[1] - start[1]], side = 6 / view.scale / (Math.hypot(...way) || 1);
    const at = (share, off) => [start[0] + share * way[0] - off * way[1], start[1] + share * way[1] + off * way[0]];
    const coils = Array.from({ length: 12 }, (_, k) => at(0.15 + (0.7 * k) / 11, k % 2 ? side : -side));
    set(`spring:${n}`, line([start, ...coils, end]));
  }

  return { svg, draw, arrows, trace, fit, holds, local, posed, frame: () => frame };
};
