"use strict";
// Arrows at the points of a drawing: forces in joints, loads, velocities and accelerations, each kind to its own scale.
linkproof.liveArrows = (data, model, scheme) => {
  const LONG = 80, FACTORS = [[0.25, "× 0.25"], [0.5, "× 0.5"], [1, "× 1"], [2, "× 2"], [4, "× 4"]]; // px
  const { make, choice, toggles, swatch } = linkproof.controls, { length, joints } = data;
  const { isSampled } = data;
  const loads = data.loads.filter(({ number, force: own, law }) => isSampled || own || law || data.laws.some((law) => law.load === number));
  const points = [...new Set(data.results.map(({ name }) => /^point:(.*):x$/.exec(name)?.[1]).filter(Boolean))];
  const at = (over, name, i) => over.found[model.places.get(name) * over.times.length + i];
  const along = (name, over, i) => ["x", "y"].map((axis) => at(over, `${name}:${axis}`, i));

  /** The difference of a point's places, of first or second order, over the steps between three samples. */
  function differences(order, over, i, design) {
    const last = over.times.length - 1, k = Math.min(Math.max(i, 1), last - 1);
    const step = over.duration / last / Math.abs(model.pace(design));
    return points.map((point) => {
      const [before, here, after] = [k - 1, k, k + 1].map((one) => along(`point:${point}`, over, one));
      return [point, [0, 1].map((n) => (order === 1
        ? (after[n] - before[n]) / (2 * step) : (after[n] - 2 * here[n] + before[n]) / step ** 2))];
    });
  }
  const force = data.results.find(({ name }) => name.startsWith("joint_force:"));
  const { unit, size } = force ?? { unit: "N", size: 1 };
  const inJoints = (over, i) => joints.map(({ name, point }) => [point, along(`joint_force:${name}`, over, i)]);
  const sampled = (kind) => (over, i) => points.map((point) => [point, along(`${kind}:${point}`, over, i)]);
  /** A load in the ground's frame, of which a link's own goes with it; one of a stroke acts on its way alone. */
  function outside(over, i, design) {
    const [travel, rate] = ["S", "v"].map((name) => (model.places?.has(name) ? at(over, name, i) : 0));
    return loads.map((load) => {
      const { number, point, frame, when } = load;
      if (isSampled) return [point, along(`load:${number}`, over, i)];
      if (when && (when === "advance") !== (rate >= 0)) return [point, [0, 0]];
      const [x, y] = model.load(load, over.phi[i], travel, design), turn = frame === "ground" ? 0 : at(over, `link:${frame}:angle`, i);
      return [point, [x * Math.cos(turn) - y * Math.sin(turn), x * Math.sin(turn) + y * Math.cos(turn)]];
    });
  }
  const moved = (kind, order) => (isSampled ? sampled(kind) : (...where) => differences(order, ...where));
  const kinds = {
    "joint forces": { ink: "c1", unit, size, list: inJoints },
    loads: { ink: "c3", unit, size, list: outside },
    velocity: { ink: "c2", unit: `${length.unit}/s`, size: length.size, list: moved("velocity", 1) },
    acceleration: { ink: "c4", unit: `${length.unit}/s²`, size: length.size, list: moved("acceleration", 2) },
  };
  if (!force) delete kinds["joint forces"];
  if (!loads.length) delete kinds.loads;
  let longest = {}, redrawn = () => {};

  const [shown, set] = toggles("Arrows", Object.keys(kinds), () => false, (name) => swatch(kinds[name].ink), () => redrawn());
  const [factor, factorLabel] = choice("Size", FACTORS, () => redrawn());
  const scale = make("span", "", { className: "small" });
  factor.value = 1;
  factorLabel.hidden = true;
  set.hidden = !Object.keys(kinds).length;
  const controls = make("div", "", { className: "controls live-arrows" });
  controls.append(set, factorLabel, scale);

  /** Take the longest arrow of every kind that is shown. */
  function measure(over, design) {
    longest = {};
    for (const name of shown()) {
      let most = 0;
      for (let i = 0; i < over.times.length; i += 1)
        if (over.moves[i])
          for (const [, way] of kinds[name].list(over, i, design)) most = Math.max(most, Math.hypot(...way) || 0);
      longest[name] = most;
    }
    factorLabel.hidden = !shown().length;
    const words = shown().map((name) => {
      const { size: one, unit: of } = kinds[name];
      return `${name} ${Number((longest[name] / one).toPrecision(3))} ${of}`;
    });
    const acts = joints.map(({ name, on }) => `in ${name} on ${on}`).join(", ");
    scale.textContent = words.length ? `Longest: ${words.join(", ")}.` : "";
    scale.title = "joint forces" in longest ? `The force acts ${acts}.` : "";
  }

  /** Draw those of one sample. */
  function draw(over, share, design) {
    const i = Math.round(share * (over.times.length - 1));
    const list = over.moves[i] ? Object.keys(longest).filter((name) => longest[name]) : [];
    scheme.arrows(list.flatMap((name) => kinds[name].list(over, i, design).map(([point, way]) => (
      { point, ink: kinds[name].ink, way: way.map((one) => (one / longest[name]) * LONG * Number(factor.value)) }))));
  }

  return { controls, measure, draw, onChange: (callback) => { redrawn = callback; } };
};
