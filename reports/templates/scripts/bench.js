/* Error over cost: mechanism, quantity, cost and engines are chosen; pointing at a point tells all of it. */
"use strict";
(() => {
  // Name, words, a point's value, whether it is the same for all engines.
  const AXES = [
    ["stepping", "stepping alone, s", (one) => one.stepping, true],
    ["all of a run", "set-up, stepping and read-out, s", (one) => one.setup + one.stepping + one.readout, true],
    ["time steps", "time steps, over all runs of a point", (one) => one.steps, true],
    ["solver work", "the constraint solver's work, in each engine's own unit", (one) => one.work, false],
  ];

  function choice(words, options) {
    const label = document.createElement("label"), select = document.createElement("select");
    const fill = (given) => select.replaceChildren(...given.map(([value, text]) => new Option(text, value)));
    label.append(words, select);
    fill(options);
    return { label, select, fill };
  }

  function toggle(words, isOn, colour, act) {
    const button = document.createElement("button");
    Object.assign(button, { type: "button", textContent: words, onclick: () => press(!button.isOn) });
    const set = (now) => { button.isOn = now; button.setAttribute("aria-pressed", now); };
    const press = (now) => { set(now); act(now); };
    if (colour) button.style.borderBottom = `4px solid var(--${colour})`;
    set(isOn);
    return button;
  }

  linkproof.widget("bench", (element, given) => {
    const engines = given.engines.map(([name, label, ink]) => ({ name, label, ink, isOn: true, isControl: label !== name }));
    const place = choice("mechanism", given.places), quantity = choice("quantity", []);
    const axis = choice("over", AXES.map(([name], number) => [number, name]));
    const controls = document.createElement("div"), plot = document.createElement("div");
    let data = given.first, efforts = false;
    const more = toggle("other solver efforts", false, "", (now) => { efforts = now; draw(); });

    function draw() {
      const [, title, value, isShared] = AXES[axis.select.value];
      const asked = data.quantities.find(([key]) => key === quantity.select.value);
      const parts = (colours) => engines.map((engine) => linkproof.bench.drawn(data, asked, value, engine, efforts, colours));
      linkproof.plot(plot, (colours) => linkproof.bench.traces(parts(colours), isShared, colours),
        (colours) => linkproof.bench.layout(parts(colours), title));
    }

    async function show() {
      const kept = quantity.select.value;
      data = place.select.selectedIndex ? await linkproof.load(element, place.select.value) : given.first;
      quantity.fill(data.quantities);
      if (data.quantities.some(([key]) => key === kept)) quantity.select.value = kept;
      more.hidden = data.sweeps.every((sweep) => sweep.own);
      draw();
    }

    place.select.onchange = show;
    quantity.select.onchange = axis.select.onchange = draw;
    controls.className = "controls";
    controls.append(...[place, quantity, axis].map((one) => one.label), ...engines.map((engine) =>
      toggle(engine.label, true, engine.isControl ? "muted" : `c${engine.ink}`, (now) => { engine.isOn = now; draw(); })),
      more, linkproof.saveButton(plot, "work-precision"));
    element.append(controls, plot);
    show();
  });
})();
