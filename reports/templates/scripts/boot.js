/* Starts every widget of a page, loads further data, draws with Plotly in the page's colours. */
"use strict";
window.linkproof = (() => {
  const kinds = new Map(), waiting = new Map(), arrived = new Map(), plots = new Map();
  const dark = window.matchMedia("(prefers-color-scheme: dark)");
  let isReady = false;

  function start(element) {
    if (element.dataset.started || !kinds.has(element.dataset.kind) || element.closest("[hidden]")) return;
    element.dataset.started = "yes";
    const data = JSON.parse(element.querySelector(':scope > script[type="application/json"]').textContent);
    kinds.get(element.dataset.kind)(element, data);
  }

  function startAll() {
    isReady = true;
    document.querySelectorAll(".widget[data-kind]").forEach(start);
  }

  function widget(kind, starter) {
    kinds.set(kind, starter);
    if (isReady) startAll();
  }

  /* Data of another file, as a promise; a file is requested once. */
  function load(element, key) {
    const place = element.closest(".widget"), name = `${place.dataset.name}.${key}`;
    if (arrived.has(name)) return Promise.resolve(arrived.get(name));
    if (!waiting.has(name)) {
      let settle;
      const promise = new Promise((resolve, reject) => { settle = { resolve, reject }; });
      waiting.set(name, { promise, ...settle });
      const script = document.createElement("script");
      script.src = `${place.dataset.files}${encodeURIComponent(name)}.js`;
      script.onerror = () => { waiting.delete(name); settle.reject(new Error(`${script.src} is missing`)); };
      document.head.append(script);
    }
    return waiting.get(name).promise;
  }

  function loaded(name, data) {
    arrived.set(name, data);
    waiting.get(name)?.resolve(data);
    waiting.delete(name);
  }

  const FULL_SHARE = 65534;

  /* Columns out of their ends and of shares of the way between, 16 bits each in base64; null where there is none. */
  function unpacked({ ends, shares }) {
    const bytes = Uint8Array.from(atob(shares), (letter) => letter.charCodeAt(0));
    const all = new Uint16Array(bytes.buffer), count = all.length / ends.length;
    return ends.map(([low, high], column) => Array.from(all.subarray(column * count, (column + 1) * count),
      (share) => (share > FULL_SHARE ? null : low + share / FULL_SHARE * (high - low))));
  }

  function colours() {
    const style = getComputedStyle(document.documentElement), named = (name) => style.getPropertyValue(`--${name}`).trim();
    const found = { c: [0, 1, 2, 3, 4, 5, 6, 7, 8].map((number) => named(`c${number}`)) };
    for (const name of ["ink", "muted", "line", "faint", "paper", "limit", "reference"]) found[name] = named(name);
    return found;
  }

  const LEGIBLE = { tickfont: { size: 14 } }; // exponents are 0.875 of it

  /* A layout in the page's colours; what the caller gives goes before. */
  function dressed(layout) {
    const { ink, muted, line, paper, c } = colours();
    const axis = { gridcolor: line, linecolor: muted, zerolinecolor: line, tickcolor: muted, automargin: true };
    const result = {
      paper_bgcolor: "rgba(0,0,0,0)", plot_bgcolor: "rgba(0,0,0,0)", colorway: c, autosize: true,
      font: { family: getComputedStyle(document.body).fontFamily, size: 13, color: ink }, margin: { l: 64, r: 16, t: 24, b: 48 },
      hoverlabel: { bgcolor: paper, bordercolor: muted, font: { color: ink, size: 13 }, align: "left" }, ...layout,
    };
    for (const name of new Set(["xaxis", "yaxis", ...Object.keys(layout).filter((key) => /^[xy]axis\d*$/.test(key))]))
      result[name] = { ...axis, ...(layout[name]?.exponentformat === "power" && LEGIBLE), ...layout[name] };
    return result;
  }

  /* Draws, and again when the colour scheme changes; traces and layout may be functions of the colours. */
  function plot(element, traces, layout = {}) {
    if (!window.Plotly) return Promise.resolve(null);
    plots.set(element, [traces, layout]);
    const now = (given) => (typeof given === "function" ? given(colours()) : given);
    const config = { displayModeBar: false, responsive: true, displaylogo: false };
    return window.Plotly.react(element, now(traces), dressed(now(layout)), config).then(() => {
      if (!element.dataset.fits) element.on("plotly_afterplot", () => fit(element));
      element.dataset.fits = "yes";
      fit(element);
      return element;
    });
  }

  /* What lets a plot shrink to a sheet of paper: the style sheet does. */
  function fit(element) {
    const { width, height } = element._fullLayout;
    element.style.setProperty("--shape", `${width} / ${height}`);
    for (const drawing of element.querySelectorAll(".main-svg")) drawing.setAttribute("viewBox", `0 0 ${width} ${height}`);
  }

  function redraw() {
    for (const [element, [traces, layout]] of plots) if (element.isConnected) plot(element, traces, layout);
  }

  /* A button that saves a plot as a drawing. */
  function saveButton(element, name) {
    const button = document.createElement("button");
    button.type = "button";
    button.textContent = "Save as SVG";
    button.onclick = () => window.Plotly?.downloadImage(element, {
      format: "svg", filename: name, width: element.clientWidth, height: element.clientHeight });
    return button;
  }

  /* Boxes that need no scrolling are no stop of the Tab key and no landmark. */
  function stops() {
    for (const box of document.querySelectorAll(".scroll")) {
      const scrolls = box.scrollWidth > box.clientWidth + 1;
      box.setAttribute("role", scrolls ? "region" : "group");
      if (scrolls) box.tabIndex = 0; else box.removeAttribute("tabindex");
    }
  }

  /* Text as letters of an address, and back. */
  async function through(stream, bytes) {
    const flow = new Response(new Blob([bytes]).stream().pipeThrough(stream));
    return new Uint8Array(await flow.arrayBuffer());
  }
  async function packedText(text) {
    const bytes = await through(new CompressionStream("deflate-raw"), new TextEncoder().encode(text));
    const letters = Array.from(bytes, (one) => String.fromCharCode(one)).join("");
    return btoa(letters).replaceAll("+", "-").replaceAll("/", "_").replaceAll("=", "");
  }
  async function unpackedText(letters) {
    const plain = atob(letters.replaceAll("-", "+").replaceAll("_", "/"));
    const bytes = Uint8Array.from(plain, (letter) => letter.charCodeAt(0));
    return new TextDecoder().decode(await through(new DecompressionStream("deflate-raw"), bytes));
  }

  /* A linkage that the address holds, in place of what is on the page. */
  async function openModel() {
    const letters = /^#model=([\w-]+)$/.exec(location.hash)?.[1], { make } = linkproof.controls;
    if (!letters) return;
    const main = document.getElementById("main"), element = make("div", "", { className: "widget" });
    const back = make("a", "Leave it for the page that was here.", { href: location.pathname });
    const note = make("p", "This linkage came with the address. ", { className: "subtitle" });
    note.append(back);
    try {
      const model = JSON.parse(await unpackedText(letters));
      if (!model.program || !model.data.results) throw new Error("no linkage");
      main.replaceChildren(make("h1", model.title), note, element);
      await kinds.get("live")(element, { ...model.data, opened: model });
    } catch {
      main.replaceChildren(make("h1", "This address has no linkage that this page can read"), note);
    }
  }

  function begin() {
    openModel();
    startAll();
    stops();
  }

  /* Calls back when what is drawn by a script has to be drawn anew: another size, other colours. */
  function redrawn(callback) {
    window.addEventListener("resize", callback);
    dark.addEventListener("change", callback);
  }

  dark.addEventListener("change", redraw);
  window.matchMedia("print").addEventListener("change", redraw);
  document.addEventListener("DOMContentLoaded", begin);
  window.addEventListener("hashchange", openModel);
  window.addEventListener("resize", stops);
  document.addEventListener("toggle", stops, true);
  return { widget, load, loaded, unpacked, packedText, plot, colours, saveButton, redrawn };
})();
