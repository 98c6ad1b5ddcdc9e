/* Error over cost: mechanism, quantity, cost and engines are chosen; pointing at a point tells all of it. */
"use strict";
(() => {
  // Name, words, a point's value.
  const AXES = [
    ["set-up and stepping", "set-up and stepping, s", (one) => one.setup_seconds + one.seconds],
    ["stepping alone", "stepping alone, s", (one) => one.seconds],
    ["time steps", "time steps, over all runs of a point", (one) => one.steps],
  ];

  linkproof.widget("bench", (element, given) => {
    const { make, choice, toggles, swatch } = linkproof.controls, changed = () => draw();
    const engines = given.engines.map(([name, label, ink, symbol, sign]) => (
      { name, label, ink, symbol, sign, isControl: label !== name }));
    const coloured = (label) => {
      const { ink, sign } = engines.find((one) => one.label === label);
      return swatch(ink, sign);
    };
    const [place, placeLabel] = choice("Mechanism", given.places, () => show());
    const [quantity, quantityLabel] = choice("Quantity", [], changed);
    const [axis, axisLabel] = choice("Over", AXES.map(([name], number) => [number, name]), changed);
    const [shown, engineSet] = toggles("Engines", engines.map(({ label }) => label), () => true, coloured, changed);
    const controls = make("div", "", { className: "controls" }), plot = make("div");
    let data = given.first;

    function draw() {
      const [, title, value] = AXES[axis.value], { drawn, traces, layout } = linkproof.bench;
      const asked = data.quantities.find(([key]) => key === quantity.value), on = shown();
      const parts = (colours) => engines.map((engine) => drawn(
        data, asked, value, { ...engine, isOn: on.includes(engine.label) }, colours));
      linkproof.plot(plot, (colours) => traces(parts(colours)),
        (colours) => layout(parts(colours), title));
    }

    async function show() {
      const kept = quantity.value;
      data = place.selectedIndex ? await linkproof.load(element, place.value) : given.first;
      quantity.replaceChildren(...data.quantities.map(([key, words]) => new Option(words, key, false, key === kept)));
      draw();
    }

    controls.append(placeLabel, quantityLabel, axisLabel, engineSet);
    element.append(controls, plot, linkproof.saveButton(plot, "work-precision"));
    show();
  });
})();
