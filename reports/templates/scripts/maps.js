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

  function copied(text) {
    if (navigator.clipboard) return navigator.clipboard.writeText(text);
    const field = make("textarea");
    field.value = text;
    document.body.append(field);
    field.select();
    const done = document.execCommand("copy");
    field.remove();
    return done ? Promise.resolve() : Promise.reject(new Error("not copied"));
  }

  function copyButton(text) {
    const button = make("button", { type: "button" }, "Copy the command");
    button.onclick = () => copied(text).then(() => "Copied", () => "Select the command and copy it")
      .then((words) => { button.textContent = words; });
    return button;
  }

  /* The grid of one row; a cell is reached by the arrow keys and told by a click, Enter or the space bar. */
  function grid(map, block, signs, tell) {
    const head = make("tr", {}, make("th", { scope: "col" }, "engine"), make("th", { scope: "col" }, "usage"),
      ...map.values.map((value) => make("th", { scope: "col", class: "value" }, value)));
    const table = make("table", { class: "map", role: "grid" }, make("caption", {}, make("span", {}, block.row)), make("thead", {}, head));
    const lines = [], body = make("tbody");
    for (const [number, line] of block.lines.entries()) {
      const row = make("tr"), isFirst = number === 0 || block.lines[number - 1].engine !== line.engine;
      const span = block.lines.filter((other) => other.engine === line.engine).length;
      if (isFirst) row.append(make("th", { scope: "rowgroup", rowspan: span }, line.engine));
      row.append(make("th", { scope: "row" }, line.usage));
      lines.push(line.cells.map((cell, column) => {
        const sign = cell && signs[cell.verdict], look = cell ? dressed(sign) : { class: "" };
        if (line.bars.includes(column)) look.class += " bar";
        const place = make("td", cell ? { ...look, tabindex: -1, "aria-label": sign.word, title: `${map.values[column]}: ${sign.word}` } : look, cell ? sign.sign : "");
        if (cell) place.onclick = () => tell(place, { map, block, line, cell, value: map.values[column] });
        row.append(place);
        return place;
      }));
      body.append(row);
    }
    table.append(body);
    table.onkeydown = (event) => move(event, lines);
    return { table, lines, box: make("div", { class: "scroll", role: "region", "aria-label": block.row }, table) };
  }

  function move(event, lines) {
    const step = { ArrowLeft: [0, -1], ArrowRight: [0, 1], ArrowUp: [-1, 0], ArrowDown: [1, 0] }[event.key];
    const y = lines.findIndex((line) => line.includes(event.target));
    if (y < 0) return;
    if (event.key === "Enter" || event.key === " ") event.target.click();
    else if (!step) return;
    let [row, column] = [y, lines[y].indexOf(event.target)];
    do { row += step?.[0] ?? 0; column += step?.[1] ?? 0; } while (step && lines[row]?.[column] && !lines[row][column].hasAttribute("tabindex"));
    event.preventDefault();
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
      make("dl", { class: "facts" }, ...Object.entries(facts).flatMap(([name, words]) => [make("dt", {}, name), make("dd", {}, words)])),
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
    (places.find((place) => place.textContent !== signs[0].sign) ?? places[0])?.click();
  }

  linkproof.widget("maps", (element, data) => {
    const names = Object.entries(data.axes).map(([key, title]) => make("option", { value: key }, title));
    const select = make("select", {}, ...names);
    const key = make("ul", { class: "maps-key" }, ...data.signs.filter((sign) => sign.occurs)
      .map((sign) => make("li", { title: sign.meaning }, make("span", dressed(sign), sign.sign), sign.word)));
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
      const axis = decodeURIComponent(location.hash).replace(/^#map-/, "");
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
