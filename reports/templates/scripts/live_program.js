"use strict";
// A list of operations as a function: numbers of a design and of rows to results at every row. The list is data, so that
// it may come out of an address; the script made of it has numbers and these operations alone.
(() => {
  const MOST = 20_000; // operations
  const FORMS = {
    add: (x, y) => `${x} + ${y}`, subtract: (x, y) => `${x} - ${y}`, multiply: (x, y) => `${x} * ${y}`,
    divide: (x, y) => `${x} / ${y}`, negative: (x) => `-${x}`, absolute: (x) => `Math.abs(${x})`,
    sign: (x) => `Math.sign(${x})`, sqrt: (x) => `Math.sqrt(${x})`, sin: (x) => `Math.sin(${x})`,
    cos: (x) => `Math.cos(${x})`, hypot: (x, y) => `Math.sqrt(${x} * ${x} + ${y} * ${y})`,
    arctan2: (x, y) => `Math.atan2(${x}, ${y})`, maximum: (x, y) => `Math.max(${x}, ${y})`,
    minimum: (x, y) => `Math.min(${x}, ${y})`, less: (x, y) => `${x} < ${y}`, less_equal: (x, y) => `${x} <= ${y}`,
    greater: (x, y) => `${x} > ${y}`, greater_equal: (x, y) => `${x} >= ${y}`, and: (x, y) => `${x} && ${y}`,
    or: (x, y) => `${x} || ${y}`, not: (x) => `!${x}`, where: (x, y, z) => `${x} ? ${y} : ${z}`,
  };
  const waiting = [];

  /** The text of (given, rows, results, count) => ...: what follows from the design alone is computed once. */
  function programSource({ given, rows, constants, names, operations, results }) {
    const first = given + rows + constants.length, size = first + operations.length;
    const isBefore = (end) => (number) => Number.isInteger(number) && number >= 0 && number < end;
    const isRight = isBefore(MOST)(size) && names.every((name) => Object.hasOwn(FORMS, name))
      && results.every(isBefore(size)) && operations.every(([name, ...from], n) =>
      isBefore(names.length)(name) && from.length === FORMS[names[name]].length && from.every(isBefore(first + n)));
    if (!isRight) throw new Error("this is no list of operations");
    const isOfRow = new Uint8Array(size).fill(1, given, given + rows);
    const once = Array.from({ length: given }, (_, k) => `const v${k} = given[${k}];`);
    const each = Array.from({ length: rows }, (_, k) => `const v${given + k} = rows[${k} * count + i];`);
    constants.forEach((one, k) => once.push(`const v${given + rows + k} = ${Object.is(one, -0) ? "-0" : Number(one)};`));
    operations.forEach(([name, ...from], n) => {
      isOfRow[first + n] = Number(from.some((one) => isOfRow[one]));
      const words = FORMS[names[name]](...from.map((one) => `v${one}`));
      (isOfRow[first + n] ? each : once).push(`const v${first + n} = ${words};`);
    });
    results.forEach((one, k) => each.push(`results[${k} * count + i] = v${one};`));
    const body = [...once, "for (let i = 0; i < count; i += 1) {", ...each, "}"].join("\n");
    return `(given, rows, results, count) => {\n${body}\n}`;
  }

  /** The function, which a script of this page's own making gives. */
  function liveProgram(program) {
    const number = waiting.length, script = document.createElement("script");
    const text = `"use strict";\nlinkproof.programMade(${number}, ${programSource(program)});`;
    script.src = URL.createObjectURL(new Blob([text], { type: "text/javascript" }));
    return new Promise((resolve, reject) => {
      waiting.push(resolve);
      script.onerror = reject;
      document.head.append(script);
    });
  }

  Object.assign(linkproof, { programSource, liveProgram, programMade: (number, made) => waiting[number](made) });
})();
