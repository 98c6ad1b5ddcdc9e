/* All errors and all curves of a mechanism's runs: regime, quantity, axis, engines and settings are chosen. */
"use strict";
(() => {
  linkproof.widget("curves", (element, data) => {
    const { errorPlot, curvePlot, SIGNS } = linkproof.runPlots, { make, choice, toggles, swatch } = linkproof.controls;
    const changed = () => show();
    const coloured = (name) => swatch(data.looks[name][0], data.looks[name][2]);
    const sign = (name) => make("span", ` ${SIGNS[name] || SIGNS.tuned}`, { ariaHidden: "true" });
    const isUsual = (name) => name !== "naive" || data.settings.length < 2;

    const [regime, regimeLabel] = choice("Regime", data.regimes.map((one, n) => [n, one.name]), changed);
    const [quantity, quantityLabel] = choice("Quantity", [], changed);
    const over = [["time", "time"], ["angle", data.axis[0].split(",")[0]]];
    const [axis, axisLabel] = choice("Over", over, changed);
    const [engines, engineSet] = toggles("Engines", data.engines, () => true, coloured, changed);
    const [settings, settingSet] = toggles("Settings", data.settings, isUsual, sign, changed);
    const controls = make("div", "", { className: "controls" });
    const plot = make("div", "", { className: "plot" });
    const words = make("p", "", { className: "small" });
    words.setAttribute("aria-live", "polite");
    regimeLabel.hidden = data.regimes.length < 2;
    controls.append(regimeLabel, quantityLabel, axisLabel, engineSet, settingSet);
    element.replaceChildren(controls, plot, words, linkproof.saveButton(plot, "errors"));

    /* The quantities of the regime; the one that was chosen stays so where this regime has it. */
    function offerQuantities() {
      const before = quantity.selectedOptions[0]?.textContent;
      const offered = [...data.regimes[regime.value].quantities.entries()].filter(([, one]) => one.curves);
      quantity.replaceChildren(make("option", "all errors", { value: "" }),
        ...offered.map(([n, one]) => make("option", one.title, { value: n, selected: one.title === before })));
      quantity.dataset.regime = regime.value;
    }

    function draw([traces, layout, told]) {
      words.textContent = told;
      linkproof.plot(plot, traces, layout).then((drawn) => {
        if (!drawn || plot.dataset.answers) return;
        plot.dataset.answers = "yes";
        plot.on("plotly_click", ({ points: [{ data: trace, customdata }] }) => {
          if (trace.meta !== "errors" || !data.regimes[regime.value].quantities[customdata[0]].curves) return;
          quantity.value = customdata[0];
          show();
          quantity.focus();
        });
      });
    }

    function show() {
      if (quantity.dataset.regime !== regime.value) offerQuantities();
      const asked = `${regime.value}-${quantity.value}`, at = data.regimes[regime.value];
      const shown = { engines: engines(), settings: settings() };
      axisLabel.hidden = quantity.value === "";
      if (quantity.value === "") {
        draw(errorPlot(data, at, shown, element.clientWidth < 600));
        return;
      }
      const found = asked === data.first ? Promise.resolve(data.curves) : linkproof.load(element, asked);
      found.then((curves) => {
        if (asked !== `${regime.value}-${quantity.value}`) return;
        draw(curvePlot(data, at, at.quantities[quantity.value], curves, { ...shown, axis: axis.value }));
      }, (error) => { words.textContent = `${error.message}: write the report again.`; });
    }

    /* The curves that the address asks for, by regime and quantity; without any, those that the page begins with. */
    function follow() {
      const asked = new URLSearchParams(location.hash.slice(1)).get("curve");
      const [name, ...rest] = (asked ?? data.opens).split("/");
      const n = data.regimes.findIndex((one) => one.name === name);
      const wanted = n < 0 ? -1 : data.regimes[n].quantities.findIndex((one) => one.name === rest.join("/") && one.curves);
      if (wanted >= 0) {
        regime.value = n;
        offerQuantities();
        quantity.value = wanted;
        if (asked) element.scrollIntoView();
      }
      show();
    }
    window.addEventListener("hashchange", follow);
    follow();
  });
})();
