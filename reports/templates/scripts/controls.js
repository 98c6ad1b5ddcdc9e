/* What is chosen with on a page: lists and boxes with their labels. */
"use strict";
linkproof.controls = (() => {
  const make = (tag, text = "", options = {}) => Object.assign(document.createElement(tag), { textContent: text }, options);
  const labelled = (...parts) => {
    const label = make("label");
    label.append(...parts);
    return label;
  };

  /* A list to choose one from, with its label. */
  function choice(words, options, changed) {
    const select = make("select");
    select.append(...options.map(([value, text]) => new Option(text, value)));
    select.addEventListener("change", changed);
    return [select, labelled(`${words} `, select)];
  }

  /* Names to be shown or left out: what tells the shown ones, and the set of boxes. */
  function toggles(words, names, isShown, mark, changed) {
    const set = make("fieldset", "", { hidden: names.length < 2 });
    set.append(make("legend", words), ...names.map((name) => {
      const box = make("input", "", { type: "checkbox", checked: isShown(name), value: name });
      box.addEventListener("change", changed);
      return labelled(box, mark(name), ` ${name}`);
    }));
    return [() => [...set.querySelectorAll("input:checked")].map((box) => box.value), set];
  }

  /* A sign in a colour of the page. */
  function swatch(colour, sign = "●") {
    const mark = make("span", sign, { className: "swatch", ariaHidden: "true" });
    mark.style.color = `var(--${colour})`;
    return mark;
  }

  /* A colour of the page by its name; an engine's symbol at a setting: open, filled, or outlined. */
  const inked = (colours, name) => (/^c\d$/.test(name) ? colours.c[name[1]] : colours[name]);
  const marker = (colours, ink, symbol, setting, size) => ({
    color: inked(colours, ink), size, symbol: setting === "naive" ? `${symbol}-open` : symbol,
    line: { color: colours.ink, width: setting === "best" ? 1.5 : 0 } });

  return { make, labelled, choice, toggles, swatch, inked, marker };
})();
