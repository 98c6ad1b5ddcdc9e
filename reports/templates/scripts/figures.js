/* Figures made in Python as plain data of Plotly, of which one is chosen; a colour "ink:c0" is the page's own. */
"use strict";
linkproof.widget("figures", (element, { what, figures, words }) => {
  const { make, choice, inked: inkOf } = linkproof.controls, plot = make("div"), controls = make("div", "", { className: "controls" });
  const [chosen, label] = choice(what, figures.map(({ name }, n) => [n, name]), () => draw());
  const inked = (part, colours) => JSON.parse(JSON.stringify(part), (_, value) => {
    return typeof value === "string" && value.startsWith("ink:") ? inkOf(colours, value.slice(4)) : value;
  });

  function draw() {
    const { data, layout } = figures[chosen.value];
    linkproof.plot(plot, (colours) => inked(data, colours), (colours) => inked(layout, colours)).then((drawn) => {
      if (!drawn || plot.dataset.answers) return;
      plot.dataset.answers = "yes";
      plot.on("plotly_click", ({ points: [{ customdata }] }) => { if (customdata) location.href = customdata; });
    });
  }
  controls.append(label);
  element.replaceChildren(controls, plot, make("p", words, { className: "small" }), linkproof.saveButton(plot, "errors"));
  draw();
});
