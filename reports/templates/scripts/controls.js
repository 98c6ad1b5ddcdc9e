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

  function swatch(colour) {
    const mark = make("span", "", { className: "swatch" });
    mark.style.background = `var(--${colour})`;
    return mark;
  }

  return { make, labelled, choice, toggles, swatch };
})();
