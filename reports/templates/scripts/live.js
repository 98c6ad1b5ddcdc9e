"use strict";
// The part of a page that can be pulled at: points and numbers, undone and redone, copied as a file, as curves, as a link.
linkproof.widget("live", (element, data) => {
  linkproof.load(element, "model").then((formulas) => {
    const { make, labelled, choice } = linkproof.controls,
      SECONDS = 6,
      STEPS = 1000;
    const model = linkproof.liveModel(formulas, data),
      { motion, length } = data,
      byName = model.byName;
    const offered = data.numbers.filter((one) => one.offered),
      reduced = matchMedia("(prefers-reduced-motion: reduce)").matches;
    const before = model.whole({}),
      figuresBefore = model.figures(before);
    let design = fromAddress(),
      over = before,
      share = 0,
      playing = false,
      clock = 0,
      pull = null,
      isDirty = false,
      last = null;
    const done = [],
      undone = [];

    const pulled = { can, begin, move, end, step: () => Number(step.value) * length.size };
    const scheme = linkproof.liveDrawing(data, model, pulled),
      curves = linkproof.liveCurves(data, model, scrub);
    const button = (text, act, more = {}) => {
      const one = make("button", text, { type: "button", onclick: act, ...more });
      return one;
    };
    const playButton = button("Play", () => play(!playing)),
      place = make("input", "", { type: "range", min: 0, max: STEPS, step: 1 });
    const nice = (value) => {
      const ten = 10 ** Math.floor(Math.log10(value));
      return Number((ten * (value / ten >= 5 ? 5 : value / ten >= 2 ? 2 : 1)).toPrecision(1));
    };
    const extent =
      Math.max(...Object.values(data.bodies).flatMap((points) => Object.values(points).flat().map(Math.abs)), 1e-9) /
      length.size;
    const usual = nice(extent / 100);
    const [step, stepLabel] = choice(
      "Snap to",
      [
        [usual / 10, 0],
        [usual, 0],
        [usual * 10, 0],
      ].map(([one]) => [tidy(one), `${tidy(one)} ${length.unit}`]),
      () => {},
    );
    const status = make("p", "", { className: "live-status" }),
      spoken = make("p", "", { className: "small live-said" }),
      at = make("output", "");
    const undoButton = button("Undo", () => travel(done, undone)),
      redoButton = button("Redo", () => travel(undone, done));
    const resetButton = button("Reset", () => change({})),
      copied = make("textarea", "", {
        readOnly: true,
        hidden: true,
        rows: 12,
        ariaLabel: "The file with the new numbers",
      });
    const table = make("tbody"),
      cells = figuresBefore.map((one) => row(one)),
      rows = new Map(),
      panel = numbersPanel();
    spoken.setAttribute("aria-live", "polite");
    step.value = tidy(usual);
    element.replaceChildren(...layout());
    curves.measure();
    scheme.fit(before, {});
    scheme.trace(before, {}, "before");
    settle();
    play(!reduced && !Object.keys(design).length);
    linkproof.redrawn(() => {
      curves.measure();
      scheme.fit(over, design);
      scheme.trace(before, {}, "before");
      refresh();
    });
    window.addEventListener("hashchange", () => {
      if (location.hash.includes("=")) change(fromAddress());
    });
    element.addEventListener("keydown", (event) => {
      if (!(event.ctrlKey || event.metaKey) || event.key.toLowerCase() !== "z" || event.target.type === "number")
        return;
      event.preventDefault();
      if (event.shiftKey) travel(undone, done);
      else travel(done, undone);
    });

    function layout() {
      const figures = make("table", "", { className: "key" }),
        head = make("thead"),
        line = make("tr"),
        box = make("div", "", { className: "live-figures scroll" });
      for (const word of ["figure", "now", "in the file", "change"])
        line.append(make("th", word, { scope: "col", className: word === "figure" ? "" : "num" }));
      head.append(line);
      figures.append(head, table);
      box.append(figures);
      const controls = make("div", "", { className: "controls" }),
        tools = make("div", "", { className: "controls live-tools" });
      controls.append(
        playButton,
        labelled(`${motion.linear ? "travel" : motion.steady ? "φ" : "t"} `, place),
        at,
        stepLabel,
      );
      place.addEventListener("input", () => {
        play(false);
        show(place.value / STEPS);
      });
      tools.append(
        undoButton,
        redoButton,
        resetButton,
        button("Copy as TOML", copy),
        button("Save curves", save),
        button("Link", link),
      );
      const left = make("div", "", { className: "live-stage" }),
        top = make("div", "", { className: "live-top" }),
        lower = make("div", "", { className: "live-lower" });
      left.append(scheme.svg, status, controls);
      top.append(left, box);
      lower.append(curves.box, panel);
      return [top, tools, spoken, copied, lower];
    }

    /** A row of the key figures; gives what is written anew. */
    function row(one) {
      const line = make("tr"),
        now = make("td", "", { className: "num" }),
        change_ = make("td", "", { className: "num" });
      line.append(
        make("th", one.name.replaceAll("_", " "), { scope: "row" }),
        now,
        make("td", shown(one), { className: "num muted" }),
        change_,
      );
      table.append(line);
      return { now, change: change_ };
    }

    function numbersPanel() {
      const box = make("div", "", { className: "live-numbers" }),
        groups = new Map();
      for (const one of [...offered].sort((a, b) => order(a) - order(b))) {
        if (!groups.has(one.group)) {
          const fold = make("details", "", { open: groups.size < 2 });
          fold.append(make("summary", one.group.replaceAll("_", " ")));
          groups.set(one.group, fold);
          box.append(fold);
        }
        groups.get(one.group).append(numberRow(one));
      }
      return box;
    }
    function order(one) {
      return one.role === "speed"
        ? 0
        : one.group === "motion and loads"
          ? 1
          : one.group === data.crank
            ? 2
            : one.group === "ground"
              ? 4
              : 3;
    }

    /** A slider and a box for one number, in the file's unit. */
    function numberRow(one) {
      const reach = one.value
        ? Math.abs(one.value) / (one.role === "scale" ? 1 : 2)
        : one.unit === length.unit
          ? extent / 4
          : 10;
      const words = `${one.group} ${one.label}, ${one.unit}`.replaceAll("_", " "),
        by = nice(reach / 50),
        line = make("div", "", { className: "live-number" });
      const slider = make("input", "", {
        type: "range",
        min: one.value - reach,
        max: one.value + reach,
        step: "any",
        ariaLabel: words,
      });
      const box = make("input", "", { type: "number", step: "any", ariaLabel: `${words}, exactly` });
      slider.addEventListener("input", () => preview({ [one.name]: tidy(Math.round(slider.value / by) * by) }));
      slider.addEventListener("change", () => commit());
      box.addEventListener("change", () => {
        if (box.value !== "" && Number.isFinite(box.valueAsNumber)) {
          preview({ [one.name]: box.valueAsNumber });
          commit();
        }
      });
      line.append(
        make("span", one.label.replaceAll("_", " ")),
        slider,
        box,
        make("span", one.unit, { className: "muted" }),
      );
      rows.set(one.name, { slider, box, line });
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
      return (
        (data.pulls[name] ?? []).length > 0 &&
        data.pulls[name].every(({ body, about }) =>
          [name, about]
            .filter(Boolean)
            .every((point) =>
              ["x", "y"].every(
                (axis) =>
                  (point === about && point !== name && !isOrigin(body, name)) ||
                  byName.get(`${body}.${point}.${axis}`)?.offered,
              ),
            ),
        )
      );
    }
    function isOrigin(body, point) {
      return data.bodies[body][point].every((value) => value === 0);
    }
    function begin(name) {
      play(false);
      pull = { name, design, share, frame: scheme.frame(), grid: Number(step.value) };
      last ??= design;
    }
    function move(name, target) {
      if (!pull) return;
      const values = {},
        { frame, grid } = pull,
        snap = (value) => tidy(Math.round(value / grid) * grid);
      for (const { body, way, about } of data.pulls[name]) {
        const own = (point) => scheme.local(pull.design, body, point, data.bodies[body][point]);
        const put = (point, spot) => {
          ["x", "y"].forEach((axis, k) => {
            values[`${body}.${point}.${axis}`] = spot[k];
          });
        };
        if (way === "place") {
          const { origin, angle } = frame.frames[body],
            x = target[0] - origin[0],
            y = target[1] - origin[1];
          put(
            name,
            [x * Math.cos(angle) + y * Math.sin(angle), y * Math.cos(angle) - x * Math.sin(angle)].map((value) =>
              snap(value / length.size),
            ),
          );
          continue;
        }
        const there = frame.points[about],
          way_ = [target[0] - there[0], target[1] - there[1]],
          long = Math.max(snap(Math.hypot(...way_) / length.size), grid);
        const [moved, fixed] = isOrigin(body, name) ? [about, name] : [name, about];
        const [p, q] = [own(moved), own(fixed)].map((spot) => spot.map((value) => value / length.size)),
          was = Math.hypot(p[0] - q[0], p[1] - q[1]);
        if (was)
          put(
            moved,
            [0, 1].map((k) => tidy(q[k] + ((p[k] - q[k]) / was) * long)),
          );
        if (way === "crank" && motion.turns) {
          const start = frame.points[name],
            turn = Math.atan2(way_[1], way_[0]) - Math.atan2(start[1] - there[1], start[0] - there[0]);
          share = (((pull.share + turn / (over.phi.at(-1) - over.phi[0])) % 1) + 1) % 1;
        }
      }
      preview(Object.fromEntries(Object.entries(values).filter(([number]) => byName.get(number)?.offered)));
    }
    function end() {
      pull = null;
      commit();
    }

    /* What is shown. */
    /** Draw before the next frame, with key figures as sampled; what comes to rest first is drawn with them closed in. */
    function refresh() {
      if (isDirty) return;
      isDirty = true;
      requestAnimationFrame(() => {
        if (!isDirty) return;
        const start = performance.now();
        render(true);
        element.dataset.frame = (performance.now() - start).toFixed(2);
      });
    }
    function render(isQuick = false) {
      isDirty = false;
      over = Object.keys(design).length ? model.whole(design) : before;
      const figures = over === before ? figuresBefore : model.figures(over, isQuick);
      figures.forEach((one, n) => {
        cells[n].now.textContent = shown(one);
        cells[n].change.textContent = changed(one.value, figuresBefore[n].value);
      });
      for (const [name, { slider, box, line }] of rows) {
        const value = model.value(design, byName.get(name));
        if (value < slider.min) slider.min = value;
        if (value > slider.max) slider.max = value;
        if (Number(slider.value) !== value) slider.value = value;
        if (document.activeElement !== box && box.value !== String(value)) box.value = value;
        line.classList.toggle("changed", name in design);
      }
      scheme.trace(over, design, "path");
      curves.draw(over, before, told);
      show(share);
      undoButton.disabled = !done.length;
      redoButton.disabled = !undone.length;
      resetButton.disabled = !Object.keys(design).length;
      return figures;
    }
    function settle() {
      const figures = render(),
        first = figures[0];
      if (!scheme.holds(over, design)) {
        scheme.fit(over, design);
        scheme.trace(before, {}, "before");
        render();
      }
      if (first)
        tell(
          !over.isWhole
            ? "The linkage does not pass its whole motion with these numbers."
            : `${first.name} ${shown(first)}${Object.keys(design).length ? `, ${changed(first.value, figuresBefore[0].value) || "0.0 %"} against the file` : ""}.`,
        );
    }
    function tell(words) {
      spoken.textContent = words;
    }
    /** A place of the axis in words. */
    function told(place_) {
      return motion.steady ? angle(place_) : `${Number((place_ / Math.abs(model.pace(design))).toPrecision(3))} s`;
    }
    /** Show a share of the axis of the curves. */
    function scrub(share_) {
      const [low, high] = curves.ends(over, before),
        [first, last] = curves.ends(over);
      play(false);
      show(Math.min(1, Math.max(0, (low + share_ * (high - low) - first) / (last - first))));
    }

    /** The position at a share of the motion; where there is none, the nearest one that there is. */
    function show(now) {
      share = now;
      let phi = over.phiAt(share),
        found = model.placed(design, phi),
        red = [];
      const halted = !found[model.moving];
      if (halted) {
        const spots = over.stops,
          nearest = spots.length ? spots.reduce((a, b) => (gap(a, phi) < gap(b, phi) ? a : b)) : null;
        phi = nearest ?? phi;
        found = nearest === null ? null : model.placed(design, phi);
        const left = data.groups.map((_, k) => (found ? found[model.moving + 1 + k] / largest(k) : 0)),
          least = left.indexOf(Math.min(...left));
        red = [data.groups[least]?.point].filter(Boolean);
        status.textContent =
          nearest === null
            ? "These numbers cannot be assembled at any angle: undo the last change."
            : `Stops at ${angle(phi)}: ${data.groups[least]?.name.replaceAll("_", " ") ?? "a group"} stands at its end. Its reach ends at ${spots.map(angle).join(" and ")}.`;
      } else
        status.textContent = over.isWhole
          ? ""
          : `Does not pass its whole motion: it stops at ${over.stops.map(angle).join(" and ")}.`;
      if (found) scheme.draw(design, found, red);
      else if (scheme.frame()) scheme.svg.classList.add("unmade");
      if (found) scheme.svg.classList.remove("unmade");
      scheme.svg.classList.toggle("halted", halted);
      at.textContent = angle(phi);
      place.value = Math.round(share * STEPS);
      place.setAttribute("aria-valuetext", angle(phi));
      curves.point(over, before, motion.steady ? over.phiAt(share) : share * over.duration);
    }
    function gap(one, two) {
      const d = Math.abs(one - two) % (2 * Math.PI);
      return motion.linear ? Math.abs(one - two) : Math.min(d, 2 * Math.PI - d);
    }
    function largest(k) {
      const count = over.times.length,
        rows_ = over.found.subarray((model.moving + 1 + k) * count, (model.moving + 2 + k) * count);
      return rows_.reduce((most, value, i) => (over.moves[i] && value > most ? value : most), 0) || 1;
    }
    function angle(phi) {
      if (motion.linear) return `${Number((phi / length.size).toPrecision(4))} ${length.unit}`.replace("-", "−");
      return `${((phi * 180) / Math.PI).toFixed(1).replace("-", "−")}°`;
    }

    function play(on) {
      playing = on;
      clock = 0;
      playButton.textContent = on ? "Pause" : "Play";
      if (on) requestAnimationFrame(tick);
    }
    function tick(now) {
      if (!playing || !element.isConnected) return;
      const way = clock ? (now - clock) / 1000 / SECONDS : 0;
      clock = now;
      show((share + way) % 1);
      requestAnimationFrame(tick);
    }

    /* Words and numbers. */
    function tidy(value) {
      return Number(value.toPrecision(12)) + 0;
    }
    /** A key figure with its unit, to four digits. */
    function shown({ value, unit }) {
      if (!Number.isFinite(value)) return "–";
      const size = Math.abs(value),
        text = size >= 1e6 || (size && size < 1e-3) ? value.toExponential(3) : value.toPrecision(4);
      const plain = size >= 1e4 && size < 1e6 ? String(Number(text)) : text.replace("e+", "e");
      return `${(unit === "deg" ? `${value.toFixed(2)}°` : `${size ? plain : "0"} ${unit}`).replaceAll("-", "−")}`;
    }
    function changed(now, was) {
      if (!Number.isFinite(now) || !Number.isFinite(was) || !was || now === was) return "";
      const share_ = 100 * (now / was - 1);
      return Math.abs(share_) < 0.05 ? "" : `${share_ > 0 ? "+" : "−"}${Math.abs(share_).toFixed(1)} %`;
    }

    /* Back to work. */
    /** The file with the new numbers, or an empty text where it has no place for them. */
    function file() {
      const values = new Map(
        data.numbers
          .filter((one) => !["sketch", "speed", "scale"].includes(one.role) && model.value(design, one) !== one.value)
          .map((one) => [one.name, model.value(design, one)]),
      );
      const [was, now] = [{}, design].map((one) => scheme.posed(one, model.placed(one, data.sketch)).points);
      for (const one of values.size ? data.numbers.filter(({ role }) => role === "sketch") : []) {
        const [, point, axis] = /^sketch\.(.*)\.(.)$/.exec(one.name),
          k = "xy".indexOf(axis),
          way = (now[point]?.[k] - was[point]?.[k]) / length.size;
        if (Math.abs(way) > extent / 100) values.set(one.name, Number((one.value + way).toPrecision(4)));
      }
      const found = data.files.find(({ literals }) => [...values.keys()].every((name) => name in literals));
      const written = (name) => (values.has(name) ? String(values.get(name)) : found.literals[name]);
      return found ? found.parts.map((part, k) => (k % 2 ? written(part) : part)).join("") : "";
    }
    function copy() {
      const text = file(),
        speed = "speed" in design ? ` --speed ${design.speed}` : "";
      const reach = motion.range
        ? ` --from=${(over.phiAt(0) * 180) / Math.PI} --to=${(over.phiAt(1) * 180) / Math.PI}`
        : "";
      if (!text) {
        tell("The file has no place for these numbers: write them into it once, and open the page again.");
        return;
      }
      hand(
        text,
        `Copied. Save it as ${data.name}.toml; linkproof results ${data.name}.toml${speed}${reach} prints these numbers.`,
      );
    }
    function link() {
      history.replaceState(null, "", `#${new URLSearchParams(Object.entries(design))}`);
      hand(location.href, "The address of these numbers is copied.");
    }
    /** To the clipboard; where there is none, into a box to copy from. */
    function hand(text, words) {
      copied.value = text;
      const show_ = () => {
        copied.hidden = false;
        copied.focus();
        copied.select();
        tell(`${words.replace("Copied.", "Press Ctrl+C.").replace("is copied", "is in the box")}`);
      };
      if (navigator.clipboard) navigator.clipboard.writeText(text).then(() => tell(words), show_);
      else show_();
    }
    function save() {
      const count = over.times.length,
        columns = data.results.map(({ name, unit, size }, k) => [
          `${name} [${unit}]`,
          (i) => over.found[k * count + i] / size,
        ]);
      const own = [
        ["time [s]", (i) => over.times[i] / model.pace(design)],
        [motion.linear ? "phi [m]" : "phi [rad]", (i) => over.phi[i]],
      ];
      const quoted = (word) => (/[",]/.test(word) ? `"${word.replaceAll('"', '""')}"` : word),
        lines = [[...own, ...columns].map(([name]) => quoted(name)).join(",")];
      for (let i = 0; i < count; i += 1) lines.push([...own, ...columns].map(([, value]) => value(i)).join(","));
      const address = URL.createObjectURL(new Blob([`${lines.join("\n")}\n`], { type: "text/csv" }));
      Object.assign(make("a"), { href: address, download: `${data.name}.csv` }).click();
      setTimeout(() => URL.revokeObjectURL(address), 1000);
    }
    function fromAddress() {
      const found = {};
      for (const [name, value] of new URLSearchParams(location.hash.slice(1))) {
        if (byName.get(name)?.offered && value.trim() !== "" && Number.isFinite(Number(value)))
          found[name] = Number(value);
      }
      return found;
    }
  });
});
