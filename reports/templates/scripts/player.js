"use strict";
// A mechanism in motion: play, pause, drag. The drawing, the read-out and a line on every figure over the same axis
// show one instant.
(() => {
  const SECONDS = 6; // that the whole motion takes
  const EVERY = 6; // frames between two read-outs while it plays

  linkproof.widget("player", (element, data) => {
    const last = data.axis.values.length - 1;
    const bodies = element.getAnimations({ subtree: true });
    const figures = [...(element.closest("main > section") ?? document).querySelectorAll(`figure[data-axis="${data.axis.kind}"]`)];
    const cursors = figures.map(addCursor);
    const { button, slider, cells } = addControls(element, data, last);
    let place = 0, frame = 0, before = 0, playing = false;

    bodies.forEach((body) => body.pause());
    const show = (share, quick) => {
      place = share;
      const sample = Math.round(share * last);
      const pose = 0.99999 * between(data.poses, share * last);
      bodies.forEach((body) => { body.currentTime = pose * Number(body.effect.getTiming().duration); });
      const at = data.axis.shares[sample];
      cursors.forEach((line, n) => {
        const [left, right] = [Number(figures[n].dataset.left), Number(figures[n].dataset.right)];
        line.style.left = `${100 * (left + at * (right - left))}%`;
      });
      if (!quick) {
        slider.value = sample;
        const words = `${data.axis.name} ${data.axis.values[sample]} ${data.axis.unit}`.trim().replace(" °", "°");
        slider.setAttribute("aria-valuetext", words);
        cells.forEach((cell, row) => { cell.textContent = row ? told(data.rows[row - 1], sample) : words; });
      }
    };
    const step = (now) => {
      if (!playing) return;
      const share = (place + (before ? (now - before) / 1000 / SECONDS : 0)) % 1;
      before = now;
      frame += 1;
      show(share, frame % EVERY !== 0);
      requestAnimationFrame(step);
    };
    const play = (on) => {
      playing = on;
      before = 0;
      button.textContent = on ? "Pause" : "Play";
      if (on) requestAnimationFrame(step); else show(place);
    };
    button.addEventListener("click", () => play(!playing));
    slider.addEventListener("input", () => { place = Number(slider.value) / last; play(false); });
    figures.forEach((figure) => drag(figure, (at) => {
      const off = data.axis.shares.map((share) => Math.abs(share - at));
      place = off.indexOf(Math.min(...off)) / last;
      play(false);
    }));
    play(!matchMedia("(prefers-reduced-motion: reduce)").matches);
  });

  // A list of shares at a place between two of its entries; a step back is a turn's end.
  const between = (list, place) => {
    const before = Math.floor(place);
    const [low, high] = [list[before], list[Math.min(before + 1, list.length - 1)]];
    const step = Math.abs(high - low) > 0.5 ? high - low - Math.sign(high - low) : high - low;
    return (low + (place - before) * step + 1) % 1 || (place >= list.length - 1 ? low : 0);
  };

  const told = (row, sample) => {
    const value = row.values[sample];
    const digits = value !== null && value !== 0 && Math.abs(value) < 1e-3 ? value.toExponential(3) : String(value);
    return value === null ? "–" : `${digits.replace(/^-/, "−")} ${row.unit}`;
  };

  function addControls(element, data, last) {
    const { make, labelled } = linkproof.controls;
    const button = make("button", "", { type: "button" });
    const slider = make("input", "", { type: "range", min: 0, max: last, step: 1 });
    const controls = make("div", "", { className: "controls" }), list = make("dl", "", { className: "readout" });
    controls.append(button, labelled(`${data.axis.name} `, slider));
    const cells = [{ name: "at" }, ...data.rows].map((row) => {
      const [pair, cell] = [make("div"), make("dd")];
      pair.append(make("dt", row.name), cell);
      list.append(pair);
      return cell;
    });
    element.append(controls, list);
    return { button, slider, cells };
  }

  function addCursor(figure) {
    const line = linkproof.controls.make("span", "", { className: "cursor" });
    figure.querySelector(".picture").append(line);
    return line;
  }

  // A drag across a figure moves the mechanism; a click alone stays what it is.
  function drag(figure, move) {
    const picture = figure.querySelector(".picture");
    const [left, right] = [Number(figure.dataset.left), Number(figure.dataset.right)];
    let start = null, dragged = false;
    picture.addEventListener("dragstart", (event) => event.preventDefault());
    picture.addEventListener("pointerdown", (event) => { start = event.clientX; dragged = false; });
    picture.addEventListener("pointermove", (event) => {
      if (start === null || event.buttons === 0 || (!dragged && Math.abs(event.clientX - start) < 4)) return;
      if (!dragged) picture.setPointerCapture(event.pointerId);
      dragged = true;
      const box = picture.getBoundingClientRect();
      move(Math.min(1, Math.max(0, ((event.clientX - box.left) / box.width - left) / (right - left))));
    });
    picture.addEventListener("click", (event) => { if (dragged) event.preventDefault(); start = null; });
  }
})();
