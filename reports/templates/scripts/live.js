"use strict";
// The part of a page that can be pulled at: points and numbers, undone and redone, copied as a file, curves, a link.
linkproof.widget("live", async (element, data) => {
  const program = data.opened?.program ?? await linkproof.load(element, "model");
  const { make, labelled, choice } = linkproof.controls, SECONDS = 6, STEPS = 1000, EVERY = 4; // frames between read-outs
  const PACES = [[0.1, "× 0.1"], [0.25, "× 0.25"], [0.5, "× 0.5"], [1, "× 1"], [2, "× 2"], [4, "× 4"]];
  const WIDE = 900; // px of a page with the drawing beside the curves
  const NO_PLACE = "Cannot save: the file does not set these numbers. Add them to the file and reload.";
  const model = data.isSampled ? linkproof.sampledModel(program, data)
    : linkproof.liveModel(await linkproof.liveProgram(program), data);
  const { motion, length } = data, byName = model.byName;
  const before = model.whole({}), figuresBefore = model.figures(before);
  const done = [], undone = [], cells = [], rows = new Map();
  let design = fromAddress(), over = before, share = 0, playing = false, clock = 0;
  const axis = motion.linear ? "travel" : motion.steady ? "φ" : "t";
  let pull = null, last = null, isDirty = false, pointed = null, frames = 0;

  const gripped = { can, begin, move, end, step: () => Number(step.value) * length.size };
  const scheme = linkproof.liveDrawing(data, model, gripped);
  const curves = linkproof.liveCurves(data, model, before, point), arrows = linkproof.liveArrows(data, model, scheme);
  const coordinates = Object.values(data.bodies).flatMap((points) => Object.values(points).flat());
  const extent = Math.max(...coordinates.map(Math.abs), 1e-9) / length.size;
  const steps = [0.1, 1, 10].map((times) => tidy(times * nice(extent / 100)));
  const [pace, paceLabel] = choice("Speed", PACES, () => {});
  pace.value = 1;
  const [step, stepLabel] = choice("Snap to", steps.map((one) => [one, `${one} ${length.unit}`]), () => {});
  step.value = steps[1];

  const button = (text, act) => make("button", text, { type: "button", onclick: act });
  const playButton = button("Play", () => play(!playing)), at = make("output"), reading = make("b");
  const place = make("input", "", { type: "range", min: 0, max: STEPS, step: 1 });
  const undoButton = button("Undo", () => travel(done, undone));
  const redoButton = button("Redo", () => travel(undone, done));
  const resetButton = button("Reset", () => change({}));
  const status = make("p", "", { className: "live-status" });
  const hint = "Pull a point of the drawing or move a number: curves and key figures follow.";
  const spoken = make("p", hint, { className: "small live-said", ariaLive: "polite" });
  const label = "The file with the new numbers";
  const copied = make("textarea", "", { readOnly: true, hidden: true, rows: 12, ariaLabel: label });

  element.replaceChildren(...layout());
  arrows.onChange(() => {
    arrows.measure(over, design);
    show(share);
  });
  redraw();
  settle();
  if (!Object.keys(design).length) tell(data.isSampled ? "" : hint);
  play(!matchMedia("(prefers-reduced-motion: reduce)").matches && !Object.keys(design).length);
  linkproof.redrawn(() => {
    redraw();
    refresh();
  });
  window.addEventListener("hashchange", () => {
    if (location.hash.includes("=") && !location.hash.startsWith("#model=") && element.isConnected) change(fromAddress());
  });
  element.addEventListener("keydown", (event) => {
    if (!(event.ctrlKey || event.metaKey) || event.key.toLowerCase() !== "z" || event.target.type === "number") return;
    event.preventDefault();
    if (event.shiftKey) travel(undone, done);
    else travel(done, undone);
  });

  /* What stands on the page. */
  function box(name, ...parts) {
    const found = make("div", "", { className: name });
    found.append(...parts);
    return found;
  }
  function layout() {
    place.addEventListener("input", () => {
      play(false);
      show(place.value / STEPS);
    });
    const controls = box("controls", playButton, labelled(`${axis} `, place), at);
    const own = [stepLabel, undoButton, redoButton, resetButton, button("Copy as TOML", copy), button("Copy address", link)];
    const tools = box("controls live-tools", paceLabel, ...(data.isSampled ? [] : own), button("Save curves", save));
    if (linkproof.watched && !data.isSampled && !data.opened) tools.append(button(`Save to ${data.name}.toml`, saveFile));
    const fold = make("details", "", { className: "live-figures", open: innerWidth > WIDE });
    fold.append(make("summary", "Key figures"), figuresTable());
    const words = "Dots are peaks. Point at a curve to read it; drag along it to move the linkage. Values at ";
    const legend = make("p", words, { className: "small live-legend" });
    legend.append(reading);
    const stage = box("live-stage", scheme.svg, status, controls), reader = box("live-read", legend, curves.box);
    if (data.isSampled) return [box("live", box("live-left", stage, tools, arrows.controls), reader)];
    const left = box("live-left", stage, tools, arrows.controls, spoken, copied, numbersPanel());
    return [box("live", left, box("live-right", reader, fold))];
  }
  function figuresTable() {
    const table = make("table");
    const heads = ["figure", "now", "in the file", "change"];
    const line = table.createTHead().insertRow(), body = table.createTBody();
    line.append(...heads.map((word, n) => make("th", word, { scope: "col", className: n ? "num" : "" })));
    for (const one of figuresBefore) {
      const now = make("td", "", { className: "num" }), change = make("td", "", { className: "num" });
      const name = make("th", one.name.replaceAll("_", " "), { scope: "row" });
      body.insertRow().append(name, now, make("td", shown(one), { className: "num muted" }), change);
      cells.push({ now, change });
    }
    return table;
  }
  function numbersPanel() {
    const groups = new Map(), order = ["motion and loads", data.crank];
    const rank = ({ role, group }) => (role === "speed" ? -1 : group === "ground" ? 3 : (order.indexOf(group) + 3) % 3);
    for (const one of data.numbers.filter(({ offered }) => offered).sort((a, b) => rank(a) - rank(b))) {
      if (!groups.has(one.group)) {
        const fold = make("details", "", { open: groups.size < 2 });
        fold.append(make("summary", one.group.replaceAll("_", " ")));
        groups.set(one.group, fold);
      }
      groups.get(one.group).append(numberRow(one));
    }
    return box("live-numbers", ...groups.values());
  }
  /** A slider and a box for one number, in the file's unit. */
  function numberRow(one) {
    const usual = one.unit === length.unit ? extent / 4 : 10;
    const far = one.value ? Math.abs(one.value) / (one.role === "scale" ? 1 : 2) : usual;
    const by = nice(far / 50), reach = by * Math.round(far / by);
    const words = `${one.group} ${one.label}, ${one.unit}`.replaceAll("_", " ");
    const [min, max] = [one.value - reach, one.value + reach];
    const slider = make("input", "", { type: "range", min, max, step: by, ariaLabel: words });
    const exact = make("input", "", { type: "number", step: "any", ariaLabel: `${words}, exactly` });
    slider.addEventListener("input", () => preview({ [one.name]: tidy(Number(slider.value)) }));
    slider.addEventListener("change", commit);
    exact.addEventListener("change", () => {
      if (exact.value === "" || !Number.isFinite(exact.valueAsNumber)) return;
      preview({ [one.name]: exact.valueAsNumber });
      commit();
    });
    const unit = make("span", one.unit, { className: "muted" });
    const line = box("live-number", make("span", one.label.replaceAll("_", " ")), slider, exact, unit);
    rows.set(one.name, { slider, exact, line });
    return line;
  }

  /* What is changed, and undone. */
  function clean(values) {
    return Object.fromEntries(Object.entries(values).filter(([name, value]) => value !== byName.get(name).value));
  }
  function preview(values) {
    last ??= design;
    design = clean({ ...design, ...values });
    refresh();
  }
  function commit() {
    if (last && JSON.stringify(last) !== JSON.stringify(design)) {
      done.push(last);
      undone.length = 0;
    }
    last = null;
    settle();
  }
  function change(values) {
    last = design;
    design = clean(values);
    commit();
  }
  function travel(from, to) {
    if (!from.length) return;
    to.push(design);
    design = from.pop();
    settle();
  }

  /* Points. */
  function can(name) {
    const isFree = (body, point) => ["x", "y"].every((axis) => byName.get(`${body}.${point}.${axis}`)?.offered);
    const pulls = data.pulls[name] ?? [];
    return pulls.length > 0 && pulls.every(({ body, about }) =>
      isFree(body, name) && (!about || !isOrigin(body, name) || isFree(body, about)));
  }
  function isOrigin(body, point) {
    return data.bodies[body][point].every((value) => value === 0);
  }
  function begin(name) {
    play(false);
    pull = { design, share, frame: scheme.frame(), grid: Number(step.value) };
    last ??= design;
  }
  function end() {
    pull = null;
    commit();
  }
  function move(name, target) {
    if (!pull) return;
    const values = {};
    for (const one of data.pulls[name]) {
      const [point, spot] = one.way === "place" ? inFrame(one.body, name, target) : stretched(one, name, target);
      if (spot) [values[`${one.body}.${point}.x`], values[`${one.body}.${point}.y`]] = spot;
      if (one.way === "crank" && motion.turns) turnTo(one.about, name, target);
    }
    preview(Object.fromEntries(Object.entries(values).filter(([number]) => byName.get(number)?.offered)));
  }
  function snap(value) {
    return tidy(Math.round(value / pull.grid) * pull.grid);
  }
  /** A point with its place in the frame of a body, in the file's unit, where it has gone to a target. */
  function inFrame(body, name, target) {
    const { origin, angle } = pull.frame.frames[body], x = target[0] - origin[0], y = target[1] - origin[1];
    const spot = [x * Math.cos(angle) + y * Math.sin(angle), y * Math.cos(angle) - x * Math.sin(angle)];
    return [name, spot.map((value) => snap(value / length.size))];
  }
  /** The same where its distance from another point alone changes; the point at the frame's origin stays there. */
  function stretched({ body, about }, name, target) {
    const place_ = (point) => scheme.local(pull.design, body, point, data.bodies[body][point]);
    const own = (point) => place_(point).map((value) => value / length.size);
    const there = pull.frame.points[about];
    const long = Math.max(snap(Math.hypot(target[0] - there[0], target[1] - there[1]) / length.size), pull.grid);
    const [moved, fixed] = isOrigin(body, name) ? [about, name] : [name, about], [p, q] = [own(moved), own(fixed)];
    const was = Math.hypot(p[0] - q[0], p[1] - q[1]);
    return [moved, was ? p.map((value, k) => tidy(q[k] + ((value - q[k]) / was) * long)) : null];
  }
  /** The crank goes with its pin. */
  function turnTo(about, name, target) {
    const [x, y] = pull.frame.points[about], start = pull.frame.points[name];
    const turn = Math.atan2(target[1] - y, target[0] - x) - Math.atan2(start[1] - y, start[0] - x);
    share = (((pull.share + turn / (over.phi.at(-1) - over.phi[0])) % 1) + 1) % 1;
  }

  /* What is shown. */
  /** All that depends on the page's width and colours. */
  function redraw() {
    curves.measure();
    fit();
  }
  function fit() {
    scheme.fit(over, design);
    scheme.trace(before, {}, "before");
  }
  /** Draw before the next frame, with key figures as sampled; what comes to rest first is drawn with them closed in. */
  function refresh() {
    if (isDirty) return;
    isDirty = true;
    requestAnimationFrame(() => {
      if (!isDirty) return;
      const start = performance.now();
      render(true);
      if (!pull && !scheme.holds(over, design)) fit();
      element.dataset.frame = (performance.now() - start).toFixed(2);
    });
  }
  function render(isQuick = false) {
    isDirty = false;
    over = Object.keys(design).length ? model.whole(design) : before;
    const figures = over === before ? figuresBefore : model.figures(over, isQuick);
    for (const [n, one] of figures.entries()) {
      cells[n].now.textContent = shown(one);
      cells[n].change.textContent = changed(one.value, figuresBefore[n].value);
    }
    for (const [name, { slider, exact, line }] of rows) {
      const value = model.value(design, byName.get(name));
      if (value < slider.min) slider.min = value;
      if (value > slider.max) slider.max = value;
      if (Number(slider.value) !== value) slider.value = value;
      if (document.activeElement !== exact && exact.value !== String(value)) exact.value = value;
      line.classList.toggle("changed", name in design);
    }
    scheme.trace(over, design, "path");
    curves.draw(over, tops(figures, isQuick));
    if (!isQuick) arrows.measure(over, design);
    show(share);
    undoButton.disabled = !done.length;
    redoButton.disabled = !undone.length;
    resetButton.disabled = !Object.keys(design).length;
    return figures;
  }
  function settle() {
    const [first] = render();
    if (!scheme.holds(over, design)) {
      fit();
      render();
    }
    const against = first && changed(first.value, figuresBefore[0].value);
    const beside = Object.keys(design).length ? `, ${against || "0.0 %"} against the file` : "";
    const figure = first && `${first.name} ${shown(first)}${beside}.`;
    if (first) tell(over.isWhole ? figure : "The linkage does not pass its whole motion with these numbers.");
  }
  function tell(words) {
    spoken.textContent = words;
  }
  /** The peaks of the curves: key figures, and of what has none its largest magnitude. */
  function tops(figures, isQuick) {
    const known = figures.map((one, n) => [one, figuresBefore[n]]).filter(([{ signal }]) => signal);
    const others = over.isWhole ? curves.rows.filter((row) => !known.some(([{ signal }]) => signal === row)) : [];
    const rest = others.map((signal) => {
      const { unit, size } = data.results[model.places.get(signal)];
      const { time, height } = model.top(over, model.places.get(signal), Math.abs, isQuick);
      return [{ name: "peak", signal, time, unit, value: height / size }];
    });
    return [...known, ...rest].filter(([{ value }]) => Number.isFinite(value)).map(([one, was]) => {
      const { size } = data.results[model.places.get(one.signal)], i = (one.time / over.duration) * (over.times.length - 1);
      const change = was && changed(one.value, was.value), row = model.places.get(one.signal) * over.times.length;
      const place = told(motion.steady ? over.phiAt(one.time / over.duration) : one.time);
      const name = /^(least|stroke|peak braking)/.exec(one.name)?.[0].replace("peak ", "") ?? "peak";
      const words = `${name} ${shown({ ...one, unit: "" })} at ${place}${change ? ` (${change})` : ""}`;
      const height = one.name === "stroke" ? over.found[row + Math.round(i)] : one.value * size;
      return { signal: one.signal, time: one.time, height, words };
    });
  }
  /** A place of the axis in words. */
  function told(where) {
    return motion.steady ? angle(where) : `${Number((where / Math.abs(model.pace(design))).toPrecision(3))} s`;
  }
  /** Read the curves at a share of their axis, none without one; show it where the pointer is down. */
  function point(there, isDown) {
    if (there === null) pointed = null;
    else {
      const [low, high] = curves.ends(over, before), [first, end_] = curves.ends(over);
      pointed = Math.min(1, Math.max(0, (low + there * (high - low) - first) / (end_ - first)));
      if (isDown) {
        play(false);
        show(pointed);
        return;
      }
    }
    readOut();
  }
  function readOut() {
    const there = pointed ?? share;
    reading.textContent = `${axis} ${told(motion.steady ? over.phiAt(there) : there * over.duration)}`;
    curves.point(over, there, (value) => shown({ value, unit: "" }));
  }
  /** The position at a share of the motion; where there is none, the nearest one that there is. */
  function show(now) {
    share = now;
    let phi = over.phiAt(share), found = over.placed(share), red = [];
    const halted = !found[model.moving];
    if (halted) {
      const nearest = [...over.stops].sort((a, b) => gap(a, phi) - gap(b, phi))[0];
      found = nearest === undefined ? null : model.placed(design, nearest);
      phi = nearest ?? phi;
      const group = found && closest(found);
      red = [group?.point].filter(Boolean);
      status.textContent = found
        ? `Stops at ${angle(phi)}: ${group?.name.replaceAll("_", " ") ?? "a group"} stands at its end. `
          + `Its reach ends at ${stops()}.`
        : "These numbers cannot be assembled at any angle: undo the last change.";
    } else status.textContent = over.isWhole ? "" : `Does not pass its whole motion: it stops at ${stops()}.`;
    if (found) scheme.draw(design, found, red);
    if (found) arrows.draw(over, share, design);
    scheme.svg.classList.toggle("unmade", !found);
    scheme.svg.classList.toggle("halted", halted);
    const here = told(motion.steady ? phi : share * over.duration);
    at.textContent = here;
    place.value = Math.round(share * STEPS);
    place.ariaValueText = here;
    frames += 1;
    if (!playing || frames % EVERY === 0) readOut();
  }
  function stops() {
    return [...new Set(over.stops.map((stop) => angle(stop).replace(/^360.0°$/, "0.0°")))].join(" and ");
  }
  function gap(one, two) {
    const d = Math.abs(one - two) % (2 * Math.PI);
    return motion.linear ? Math.abs(one - two) : Math.min(d, 2 * Math.PI - d);
  }
  /** The group that is nearest to its end. */
  function closest(found) {
    const left = data.groups.map((_, k) => found[model.moving + 1 + k] / largest(k));
    return data.groups[left.indexOf(Math.min(...left))];
  }
  function largest(k) {
    const count = over.times.length, row = model.moving + 1 + k;
    const own = over.found.subarray(row * count, (row + 1) * count);
    return own.reduce((most, value, i) => (over.moves[i] && value > most ? value : most), 0) || 1;
  }
  function play(on) {
    playing = on;
    clock = 0;
    playButton.textContent = on ? "Pause" : "Play";
    if (on) requestAnimationFrame(tick);
  }
  function tick(now) {
    if (!playing || !element.isConnected) return;
    const way = clock ? (Number(pace.value) * (now - clock)) / 1000 / SECONDS : 0;
    clock = now;
    show((share + way) % 1);
    requestAnimationFrame(tick);
  }

  /* Words and numbers. */
  function nice(value) {
    const ten = 10 ** Math.floor(Math.log10(value)), first = value / ten;
    return Number((ten * (first >= 5 ? 5 : first >= 2 ? 2 : 1)).toPrecision(1));
  }
  function tidy(value) {
    return Number(value.toPrecision(12)) + 0;
  }
  function angle(phi) {
    const words = motion.linear
      ? `${Number((phi / length.size).toPrecision(4))} ${length.unit}` : `${((phi * 180) / Math.PI).toFixed(1)}°`;
    return words.replace("-", "−");
  }
  /** A key figure with its unit, to four digits. */
  function shown({ value, unit, isOpen }) {
    if (!Number.isFinite(value)) return "–";
    const size = Math.abs(value), isFar = size >= 1e6 || (size > 0 && size < 1e-3);
    const text = isFar ? value.toExponential(3).replace("e+", "e") : value.toPrecision(4);
    const plain = size >= 1e4 && !isFar ? String(Number(text)) : size ? text : "0";
    return (unit === "deg" ? `${value.toFixed(2)}°` : `${plain} ${unit}`.trim()).replaceAll("-", "−") + (isOpen ? "*" : "");
  }
  function changed(now, was) {
    if (!Number.isFinite(now) || !Number.isFinite(was) || !was || now === was) return "";
    const percent = 100 * (Math.abs(now / was) - 1); // of the size: a peak may change its sign
    return Math.abs(percent) < 0.05 ? "" : `${percent > 0 ? "+" : "−"}${Math.abs(percent).toFixed(1)} %`;
  }

  /* Back to work. */
  /** The file with the new numbers; without a place for them, an empty text, and a sentence that says so. */
  function file() {
    const isOfFile = ({ role }) => !["sketch", "speed", "scale"].includes(role);
    const changes = data.numbers.filter((one) => isOfFile(one) && model.value(design, one) !== one.value);
    const values = new Map(changes.map((one) => [one.name, model.value(design, one)]));
    const [was, now] = [{}, design].map((one) => scheme.posed(one, model.placed(one, data.sketch)).points);
    for (const one of values.size ? data.numbers.filter(({ role }) => role === "sketch") : []) {
      const [, point, axis] = /^sketch\.(.*)\.(.)$/.exec(one.name), k = "xy".indexOf(axis);
      const way = (now[point]?.[k] - was[point]?.[k]) / length.size;
      if (Math.abs(way) > extent / 100) values.set(one.name, Number((one.value + way).toPrecision(4)));
    }
    const found = data.files.find(({ literals }) => [...values.keys()].every((name) => name in literals));
    if (!found) tell(NO_PLACE);
    const written = (name) => (values.has(name) ? String(values.get(name)) : found.literals[name]);
    return found ? found.parts.map((part, k) => (k % 2 ? written(part) : part)).join("") : "";
  }
  function copy() {
    const text = file(), speed = "speed" in design ? ` --speed ${design.speed}` : "";
    const [from, to] = [0, 1].map((end_) => (over.phiAt(end_) * 180) / Math.PI);
    const command = `linkproof results ${data.name}.toml${speed}${motion.range ? ` --from=${from} --to=${to}` : ""}`;
    if (text) hand(text, `Copied. Save it as ${data.name}.toml; ${command} prints these numbers.`);
  }
  /** Over the file that is watched; what is no number of a file, the speed, stays in the address. */
  function saveFile() {
    const text = file(), address = location.href;
    if (!text) return;
    toAddress("speed" in design ? { speed: design.speed } : {});
    linkproof.watched.save(text).then((reason) => {
      if (!reason) return;
      history.replaceState(null, "", address);
      tell(reason);
    });
  }
  /** The whole model goes into the address, so that any page of results opens it; where the page's own has a secret, or
   * is a file's, what follows it alone. */
  async function link() {
    const { opened: _, ...own } = data, title = document.querySelector("h1").textContent;
    const letters = await linkproof.packedText(JSON.stringify({ title, design, program, data: own }));
    const isPlain = !linkproof.watched && location.protocol !== "file:";
    const place = isPlain ? location.href.replace(/#.*/s, "") : "";
    hand(`${place}#model=${letters}`, isPlain ? "The address with this linkage is copied."
      : "The end of an address with this linkage is copied: put it behind that of any page of results.");
  }
  function toAddress(values) {
    history.replaceState(null, "", `#${new URLSearchParams(Object.entries(values))}`);
  }
  function fromAddress() {
    const words = data.opened ? Object.entries(data.opened.design) : [...new URLSearchParams(location.hash.slice(1))];
    const given = words.filter(([, value]) => String(value).trim() !== "");
    const numbers = given.map(([name, value]) => [name, Number(value)]);
    return Object.fromEntries(numbers.filter(([name, value]) => byName.get(name)?.offered && Number.isFinite(value)));
  }
  /** To the clipboard; where there is none, into a box to copy from. */
  function hand(text, words) {
    const byHand = () => {
      copied.hidden = false;
      copied.focus();
      copied.select();
      tell(words.replace("Copied.", "Press Ctrl+C.").replace("is copied", "is in the box"));
    };
    copied.value = text;
    if (navigator.clipboard) navigator.clipboard.writeText(text).then(() => tell(words), byHand);
    else byHand();
  }
  function save() {
    const count = over.times.length, quoted = (word) => (/[",]/.test(word) ? `"${word.replaceAll('"', '""')}"` : word);
    const columns = [
      ["time [s]", (i) => over.times[i] / model.pace(design)],
      [motion.linear ? "phi [m]" : "phi [rad]", (i) => over.phi[i]],
      ...data.results.map(({ name, unit, size }, k) => [`${name} [${unit}]`, (i) => over.found[k * count + i] / size]),
    ];
    const lines = Array.from({ length: count }, (_, i) => columns.map(([, value]) => value(i)).join(","));
    const text = [columns.map(([name]) => quoted(name)).join(","), ...lines, ""].join("\n");
    const address = URL.createObjectURL(new Blob([text], { type: "text/csv" }));
    make("a", "", { href: address, download: `${data.name}.csv` }).click();
    setTimeout(() => URL.revokeObjectURL(address), 1000);
  }
});
