/* A stability map: its axis is chosen, and a cell tells what came of it and how to repeat it. */
"use strict";
(() => {
  function make(name, attributes = {}, ...children) {
    const element = document.createElement(name);
    for (const [key, value] of Object.entries(attributes)) if (value !== "") element.setAttribute(key, value);
    element.append(...children);
    return element;
  }

  const dressed = (sign) => ({ class: sign.fixed ? "sign fixed" : "sign", style: `--fill:${sign.fill};--mark:${sign.ink}` });

  function copyButton(text) {
    const button = make("button", { type: "button" }, "Copy the command");
    const copied = async () => navigator.clipboard.writeText(text);
    button.onclick = () => copied().then(() => "Copied", () => "Select the command and copy it")
      .then((words) => { button.textContent = words; });
    return button;
  }

  /* The grid of one row; a cell is reached by the arrow keys and told by a click, Enter or the space bar. */
  function grid(map, block, signs, tell) {
    const heads = ["engine", "usage"].map((name) => make("th", { scope: "col" }, name));
    const values = map.values.map((value) => make("th", { scope: "col", class: "value" }, value));
    const table = make("table", { class: "map", role: "grid" }, make("caption", {}, make("span", {}, block.row)),
      make("thead", {}, make("tr", {}, ...heads, ...values)));
    const lines = block.lines.map((line) => line.cells.map((cell, column) => {
      const bar = line.bars.includes(column) ? " bar" : "";
      if (!cell) return make("td", { class: bar });
      const sign = signs[cell.verdict], look = dressed(sign), value = map.values[column];
      const place = make("td", { ...look, class: look.class + bar, tabindex: -1, "aria-label": sign.word, title: `${value}: ${sign.word}` }, sign.symbol);
      place.onclick = () => tell(place, { map, block, line, cell, value });
      return place;
    }));
    for (const engine of new Set(block.lines.map((line) => line.engine))) {
      const own = block.lines.filter((line) => line.engine === engine);
      table.append(make("tbody", {}, ...own.map((line, number) => make("tr", {},
        ...(number ? [] : [make("th", { scope: "rowgroup", rowspan: own.length }, engine)]),
        make("th", { scope: "row" }, line.usage), ...lines[block.lines.indexOf(line)]))));
    }
    table.onkeydown = (event) => move(event, lines);
    return { table, lines, box: make("div", { class: "scroll", role: "region", "aria-label": block.row }, table) };
  }

  function move(event, lines) {
    let row = lines.findIndex((line) => line.includes(event.target));
    const step = { ArrowLeft: [0, -1], ArrowRight: [0, 1], ArrowUp: [-1, 0], ArrowDown: [1, 0] }[event.key];
    if (row < 0 || !(step || event.key === "Enter" || event.key === " ")) return;
    event.preventDefault();
    if (!step) return event.target.click();
    let column = lines[row].indexOf(event.target);
    do { row += step[0]; column += step[1]; } while (lines[row]?.[column] && !lines[row][column].onclick);
    if (lines[row]?.[column]) focusOn(lines, lines[row][column]).focus();
  }

  /* One cell of a grid is a stop of the Tab key. */
  function focusOn(lines, place) {
    for (const other of lines.flat()) if (other.tabIndex === 0) other.tabIndex = -1;
    place.tabIndex = 0;
    return place;
  }

  function story(panel, signs, { map, block, line, cell, value }) {
    const sign = signs[cell.verdict];
    const facts = { ...cell.story, ...(line.border ? { "Border of this line: last within limit": line.border } : {}) };
    panel.replaceChildren(
      make("h3", {}, `${line.engine}, ${line.usage}: ${sign.word}`),
      make("p", { class: "small" }, `${block.row}; ${map.label} ${value}. ${sign.word}: ${sign.meaning}.`),
      make("dl", { class: "facts" }, ...Object.entries(facts).flatMap(([name, words]) =>
        [make("dt", {}, name), ...words.split("; ").map((part) => make("dd", {}, part))])),
      make("pre", {}, make("code", {}, cell.command)), copyButton(cell.command));
  }

  function show(parts, map, signs) {
    let chosen = null;
    const tell = (place, told) => {
      chosen?.removeAttribute("aria-selected");
      chosen = place;
      place.setAttribute("aria-selected", "true");
      focusOn(grids.find((one) => one.table.contains(place)).lines, place);
      story(parts.story, signs, told);
    };
    const grids = map.blocks.map((block) => grid(map, block, signs, tell));
    for (const { lines } of grids) lines.flat().filter((place) => place.onclick).slice(0, 1).forEach((place) => focusOn(lines, place));
    parts.about.textContent = `${map.about} Columns: ${map.label}${map.easy ? `, easiest at ${map.easy}` : ""}.`;
    parts.blocks.replaceChildren(...grids.map((one) => one.box));
    const places = grids.flatMap((one) => one.lines.flat()).filter((place) => place.onclick);
    (places.find((place) => place.textContent !== signs[0].symbol) ?? places[0])?.click();
  }

  linkproof.widget("maps", (element, data) => {
    const names = Object.entries(data.axes).map(([key, title]) => make("option", { value: key }, title));
    const select = make("select", {}, ...names);
    const key = make("ul", { class: "maps-key" }, ...data.signs.filter((sign) => sign.occurs)
      .map((sign) => make("li", { title: sign.meaning }, make("span", dressed(sign), sign.symbol), sign.word)));
    const parts = { about: make("p"), blocks: make("div", { class: "blocks" }), story: make("section", { class: "story", "aria-label": "The chosen cell", "aria-live": "polite", tabindex: 0 }) };
    element.append(make("div", { class: "controls" }, make("label", {}, "What is varied ", select)), parts.about, key,
      make("div", { class: "maps" }, parts.blocks, parts.story));
    const choose = (axis) => {
      select.value = axis;
      const map = axis === data.map.axis ? Promise.resolve(data.map) : linkproof.load(element, axis);
      map.then((found) => { if (select.value === axis) show(parts, found, data.signs); },
        (fault) => { parts.about.textContent = `${fault.message}: write the report again.`; });
    };
    const follow = () => {
      const axis = decodeURIComponent(location.hash).replace(/^#(stress-)?map-/, "");
      if (!(axis in data.axes)) return false;
      choose(axis);
      element.scrollIntoView();
      return true;
    };
    select.onchange = () => choose(select.value);
    window.addEventListener("hashchange", follow);
    if (!follow()) choose(data.map.axis);
  });
})();
