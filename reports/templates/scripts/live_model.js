"use strict";
// A linkage computed anew: its printed formulas over its motion, tops closed in between the instants, key figures.
/**
 * @typedef {{name: string, group: string, label: string, unit: string, value: number, si: number, size: number,
 *   role: "given"|"table"|"sketch"|"speed"|"scale", load: number|null, offered: boolean}} LiveNumber
 * @typedef {Object<string, number>} Design changed numbers by name, in the units of the file
 * @typedef {{name: string, value: number, unit: string, isOpen: boolean, signal: string, time: number}} Figure
 */
linkproof.liveModel = (formulas, data) => {
  const STEP = Math.PI / 360, FEWEST = 720, MOST = 2880; // rad, and intervals of a motion
  const NARROW = 4, LOOKS = 9, TOPS = 3, SAME = 1e-12; // times a bracket shrinks to a quarter
  const AT_END = 1e-3; // of a motion's way
  const PARTS = 24, GAUSS = [[0.5 - Math.sqrt(0.15), 5 / 18], [0.5, 4 / 9], [0.5 + Math.sqrt(0.15), 5 / 18]];
  const { motion, results } = data, places = new Map(results.map((one, k) => [one.name, k]));
  const moving = results.length, width = results.length + 1 + data.groups.length;
  const given = data.numbers.filter((one) => one.role === "given");
  const byName = new Map(data.numbers.map((one) => [one.name, one]));
  const scales = data.numbers.filter((one) => one.role === "scale");

  /** φ, or a derivative of it, at a time of pieces of a motion. */
  function along(segments, time, order) {
    let segment = segments[0];
    for (const one of segments) if (time >= one[0]) segment = one;
    const x = time - segment[0];
    return segment[2].reduceRight((sum, c, k) => {
      let factor = k >= order ? 1 : 0;
      for (let n = 0; n < order; n += 1) factor *= k - n;
      return k >= order ? sum * x + factor * c : sum;
    }, 0);
  }

  /** Pieces of a motion with its instants, and φ and its derivatives there. */
  function course(segments, duration) {
    let way = 0;
    for (let i = 0; i < FEWEST; i += 1) {
      way += Math.abs(along(segments, ((i + 1) * duration) / FEWEST, 0) - along(segments, (i * duration) / FEWEST, 0));
    }
    const count = motion.linear ? FEWEST : Math.min(MOST, Math.max(FEWEST, Math.ceil(way / STEP - 1e-6)));
    const times = Float64Array.from({ length: count + 1 }, (_, i) => (i < count ? i * (duration / count) : duration));
    const known = followed(segments, times);
    return { segments, duration, times, followed: known, corners: cornersOf(segments, times, known[0]) };
  }

  /** The times at which a motion passes a corner of a load over φ: peaks are there, and means change. */
  function cornersOf(segments, times, phi) {
    const passed = new Set();
    for (const { corners, period } of data.laws)
      for (const corner of corners)
        for (let i = 1; i < times.length; i += 1) {
          const turn = period ? period * Math.floor((Math.max(phi[i - 1], phi[i]) - corner) / period) : 0;
          const place = corner + turn;
          if (phi[i - 1] < place !== phi[i] < place) passed.add(timeOf(segments, place, times[i - 1], times[i]));
        }
    return [...passed].sort((one, other) => one - other);
  }

  /** When a motion passes a value of φ, by bisection between two times. */
  function timeOf(segments, place, before, after) {
    const isBelow = along(segments, before, 0) < place;
    for (let n = 0; n < 50; n += 1) {
      const middle = (before + after) / 2;
      if (along(segments, middle, 0) < place === isBelow) before = middle;
      else after = middle;
    }
    return after;
  }
  const followed = (segments, time) =>
    [0, 1, 2].map((order) => Float64Array.from(time, (t) => along(segments, t, order)));
  const own = { ...course(motion.segments, motion.duration), open: motion.open };

  /** The motion of a design: the file's, or one over the range that the design reaches, short of its limits. */
  function courseOf(design) {
    if (!motion.range || !Object.keys(design).length) return own;
    const reach = [-1, 1].map((way) => {
      const angles = Float64Array.from({ length: FEWEST }, (_, i) => data.sketch + way * i * 2 * STEP);
      const flags = still(design, angles).subarray(moving * FEWEST, (moving + 1) * FEWEST);
      const end = flags.findIndex((flag) => !flag);
      return end > 0 ? endOf(design, angles[end - 1], angles[end]) : null;
    });
    if (reach.includes(null)) return own;
    const margin = motion.range * (reach[1] - reach[0]), speed = motion.segments[0][2][1];
    const [first, last] = speed < 0 ? [reach[1] - margin, reach[0] + margin] : [reach[0] + margin, reach[1] - margin];
    const segments = [[0, (last - first) / speed, [first, speed]]];
    return { ...course(segments, (last - first) / speed), open: [first, last] };
  }

  /** The last φ where the linkage moves, by bisection between one where it does and one where it does not. */
  function endOf(design, good, bad) {
    for (let n = 0; n < 50; n += 1) {
      const middle = (good + bad) / 2;
      if (still(design, [middle])[moving]) good = middle;
      else bad = middle;
    }
    return good;
  }

  const factor = (design, load) => design[scales[load].name] ?? 1;
  const value = (design, { name, load, value: own_ }) =>
    load === null ? (design[name] ?? own_) : own_ * factor(design, load);
  const inSI = (design, one) => (value(design, one) === one.value ? one.si : value(design, one) * one.size);
  const pace = (design) => (motion.speed ? (design.speed ?? motion.speed) / motion.speed : 1);

  /** A load over φ: one of the cubics between its knots. */
  function looked({ knots, pieces, period, load }, component, phi, design) {
    const last = knots[knots.length - 1];
    const at = period ? phi - period * Math.floor((phi - knots[0]) / period) : Math.min(Math.max(phi, knots[0]), last);
    let piece = 0;
    while (piece + 1 < pieces.length && at >= knots[piece + 1]) piece += 1;
    const [a, b, c, d] = pieces[piece][component], x = at - knots[piece];
    return (a + x * (b + x * (c + x * d))) * factor(design, load);
  }

  /** The output's coordinate at the top dead centre of a design, from which loads over S count. */
  let zeroKnown = { of: "", zero: 0 };
  function zeroOfS(design) {
    const of = JSON.stringify(design);
    if (data.overTravel && zeroKnown.of !== of) {
      const times = Float64Array.from({ length: FEWEST + 1 }, (_, i) => (2 * Math.PI * i) / FEWEST);
      const at = (phi) => compute(design, phi, new Float64Array(phi.length), new Float64Array(phi.length), 0);
      const coordinate = (s) => (Number.isNaN(s) ? -Infinity : -s);
      zeroKnown = { of, zero: top({ times, found: at(times), corners: [], at }, places.get("S"), coordinate).height };
    }
    return zeroKnown.zero;
  }

  /** Results at values of φ, (results, count), with speeds and accelerations. */
  function compute(design, phi, speed, acceleration, zero = zeroOfS(design)) {
    const count = phi.length, found = new Float64Array(width * count);
    const rows = new Float64Array((4 + data.rows.length) * count);
    rows.set(phi);
    rows.set(speed, count);
    rows.set(acceleration, 2 * count);
    rows.fill(zero, 3 * count, 4 * count);
    data.rows.forEach(([law, component], row) => {
      for (let i = 0; i < count; i += 1)
        rows[(4 + row) * count + i] = looked(data.laws[law], component, phi[i], design);
    });
    formulas(Float64Array.from(given, (one) => inSI(design, one)), rows, found, count);
    return found;
  }

  /** A force from outside: constant, or looked up over φ or over the output's travel. */
  function load({ number, force, law: ofTravel }, phi, travel, design) {
    const law = ofTravel ?? data.laws.find((one) => one.load === number), at = ofTravel ? travel : phi;
    return [0, 1].map((k) => (law ? looked(law, k, at, design) : force[k] * factor(design, number)));
  }

  /** Results at times of a motion; a change of speed makes all of it faster. */
  function at(design, { segments, times, followed: known }, time) {
    const k = pace(design), [phi, speed, acceleration] = time === times ? known : followed(segments, time);
    return compute(design, phi, speed.map((one) => one * k), acceleration.map((one) => one * k * k));
  }

  /** Results at values of φ with the crank at rest. */
  const still = (design, phi) => compute(design, phi, new Float64Array(phi.length), new Float64Array(phi.length));

  /** Results at a crank angle with the crank at rest: where everything is. */
  const placed = (design, phi) => still(design, [phi]);

  /** The highest value of a measure of one result, and its time: sampled, or closed in between the samples. */
  function top(over, row, measure, isQuick = false) {
    const count = over.times.length, sampled = over.found.subarray(row * count, (row + 1) * count);
    const height = (i) => measure(sampled[i]), best = [];
    if (isQuick) {
      let place = 0;
      for (let i = 1; i < count; i += 1) if (height(i) > height(place)) place = i;
      return { height: height(place), time: over.times[place] };
    }
    for (let i = 0; i < count; i += 1) {
      if ((i === 0 || height(i) > height(i - 1)) && (i === count - 1 || height(i) >= height(i + 1))) best.push(i);
    }
    const highest = Math.max(...best.map(height)), size = Math.abs(highest);
    const near = best.filter((i) => height(i) >= highest - 1e-3 * size).sort((i, j) => height(j) - height(i));
    const between = (i) => climb(over.times[Math.max(i - 1, 0)], over.times[Math.min(i + 1, count - 1)]);
    const cornered = over.corners.map((time) => ({ height: measure(over.at([time])[row]), time }));
    const climbed = [...near.slice(0, TOPS).map(between), ...cornered].sort((one, two) => one.time - two.time);
    const most = Math.max(...climbed.map((one) => one.height));
    return climbed.find((one) => one.height >= most - SAME * Math.abs(most)) ?? { height: NaN, time: 0 };

    function climb(low, high) {
      let x = [], y = [], j = 0;
      for (let n = 0; n < NARROW; n += 1) {
        x = Array.from({ length: LOOKS }, (_, i) => low + ((high - low) * i) / (LOOKS - 1));
        const seen = over.at(x);
        y = x.map((_, i) => measure(seen[row * LOOKS + i]));
        j = y.indexOf(Math.max(...y));
        if (j < 0) return { height: NaN, time: low };
        [low, high] = [x[Math.max(j - 1, 0)], x[Math.min(j + 1, LOOKS - 1)]];
      }
      const inner = Math.min(Math.max(j, 1), LOOKS - 2), [before, here, after] = y.slice(inner - 1, inner + 2);
      const bend = before - 2 * here + after, rise = bend < 0 ? -((after - before) ** 2) / (8 * bend) : 0;
      const isTop = j === inner && rise <= 1e-6 * Math.abs(here);
      return { height: isTop ? here + rise : y[j], time: x[j] };
    }
  }

  /** The mean of a measure of one result over a turn: of even samples where it is smooth, else between its corners. */
  function mean(over, row, measure, isQuick) {
    const count = over.times.length;
    if (isQuick || !over.corners.length)
      return over.found.subarray(row * count, (row + 1) * count - 1).reduce((sum, one) => sum + measure(one), 0) / (count - 1);
    const ends = [0, ...over.corners, over.duration];
    let sum = 0;
    for (let cell = 1; cell < ends.length; cell += 1) {
      const width = (ends[cell] - ends[cell - 1]) / PARTS, time = [], weights = [];
      for (let part = 0; part < PARTS; part += 1)
        for (const [place, weight] of GAUSS) {
          time.push(ends[cell - 1] + width * (part + place));
          weights.push(width * weight);
        }
      const seen = over.at(time);
      weights.forEach((weight, i) => { sum += weight * measure(seen[row * time.length + i]); });
    }
    return sum / over.duration;
  }

  /** The whole motion of a design: results, where S counts from, whether and between which angles it moves. */
  function whole(design) {
    const way = courseOf(design), { times } = way, found = at(design, way, times), count = times.length;
    const moves = found.subarray(moving * count, (moving + 1) * count);
    const over = { ...way, found, moves, phi: way.followed[0], at: (time) => at(design, way, time), stops: [] };
    over.phiAt = (share) => along(way.segments, share * way.duration, 0);
    over.pace = pace(design);
    over.placed = (share) => placed(design, over.phiAt(share));
    for (let i = 1; i < count; i += 1) {
      const [good, bad] = moves[i] ? [i, i - 1] : [i - 1, i];
      if (!moves[i] !== !moves[i - 1]) over.stops.push(endOf(design, over.phi[good], over.phi[bad]));
    }
    over.isWhole = !over.stops.length && moves[0] > 0;
    if (places.has("S")) shift(design, over);
    return over;
  }

  /** S counts from the farthest place: of the turn where there is one, else of the motion. */
  function shift(design, over) {
    const row = places.get("S"), count = over.times.length, raw = over.at;
    let wide = over;
    if (!motion.turns && !motion.linear) {
      const turn = Float64Array.from({ length: FEWEST + 1 }, (_, i) => (2 * Math.PI * i) / FEWEST);
      const found = still(design, turn);
      if (found.subarray(moving * turn.length, (moving + 1) * turn.length).every(Boolean))
        wide = { times: turn, found, corners: [], at: (phi) => still(design, phi) };
    }
    const farthest = top(wide, row, (s) => (Number.isNaN(s) ? -Infinity : -s)).height;
    for (let i = 0; i < count; i += 1) over.found[row * count + i] += farthest;
    over.at = (time) => {
      const found = raw(time);
      for (let i = 0; i < time.length; i += 1) found[row * time.length + i] += farthest;
      return found;
    };
  }

  /** Whether a peak is at an end of the motion beside a dead position, where it says only where the motion is cut off. */
  function isAtOpenEnd(over, time) {
    const way = Math.abs(over.phiAt(1) - over.phiAt(0)), phi = along(over.segments, time, 0);
    return over.isWhole && over.open.some((end) => Math.abs(phi - end) <= AT_END * way);
  }

  /** @returns {Figure[]} key figures in the file's units; not numbers where the linkage does not pass its motion */
  function figures(over, isQuick = false) {
    const list = [];
    const put = (name, signal, measure, sign = 1) => {
      const { unit, size } = results[places.get(signal)];
      const peak = over.isWhole ? top(over, places.get(signal), measure, isQuick) : { height: NaN, time: 0 };
      const there = over.isWhole && sign === 0 ? over.at([peak.time])[places.get(signal)] : 1;
      const value = ((sign === 0 ? Math.sign(there) : sign) * peak.height) / size;
      list.push({ name, unit, value, isOpen: isAtOpenEnd(over, peak.time), signal, time: peak.time });
    };
    const putMean = (name, signal, measure, of) => {
      const { unit, size } = results[places.get(signal)];
      const value = over.isWhole ? of(mean(over, places.get(signal), measure, isQuick)) / size : NaN;
      list.push({ name, unit, value, isOpen: false, signal: "", time: 0 });
    };
    const force = motion.linear ? "force" : "torque";
    if (places.has("Mkr")) {
      put(`peak ${force}`, "Mkr", Math.abs, 0);
      put("peak power", "Peq", (power) => power);
      put("peak braking power", "Peq", (power) => -power, -1);
      if (motion.turns) {
        putMean(`RMS ${force}`, "Mkr", (torque) => torque * torque, Math.sqrt);
        putMean("mean Jeq", "Jeq", (inertia) => inertia, (one) => one);
      }
    }
    if (places.has("S")) {
      put("stroke", "S", (s) => s);
      const least = top(over, places.get("S"), (s) => -s, isQuick), stroke = list.at(-1);
      if (over.isWhole) stroke.value += least.height / results[places.get("S")].size;
      stroke.isOpen ||= isAtOpenEnd(over, least.time);
      put("peak v", "v", Math.abs, 0);
      put("peak a", "a", Math.abs, 0);
    }
    for (const { name } of results) {
      const words = name.replace("joint_force:", "force in ").replace("shaking_force:", "shaking force:");
      if (name.endsWith(":magnitude")) put(words.replace(":magnitude", ""), name, (one) => one);
      if (name === "shaking_moment") put("shaking moment", name, Math.abs, 0);
      if (name.startsWith("transmission_angle:"))
        put(`least transmission angle, ${name.slice(19)}`, name, (angle) => -angle, -1);
    }
    return list;
  }

  return { placed, whole, figures, top, load, value, inSI, byName, places, moving, pace };
};

// The same of a linkage whose motion is known at samples alone: nothing changes, and peaks are those of the samples.
linkproof.sampledModel = ({ samples }, data) => {
  const { results, further, motion } = data, names = [...results.map(({ name }) => name), ...further];
  const places = new Map(names.map((name, k) => [name, k])), moving = names.length;
  const [phi, ...columns] = linkproof.unpacked(samples).map((one) => Float64Array.from(one, (value) => value ?? NaN));
  const count = phi.length, { duration } = motion, found = new Float64Array((moving + 1) * count).fill(1);
  columns.forEach((column, k) => found.set(column, k * count));
  const times = Float64Array.from(phi, (_, i) => (i / (count - 1)) * duration);
  const between = (row, share) => {
    const i = Math.min(Math.floor(share * (count - 1)), count - 2), part = share * (count - 1) - i;
    return row[i] + part * (row[i + 1] - row[i]);
  };
  const row = (k) => found.subarray(k * count, (k + 1) * count), phiAt = (share) => between(phi, share);
  const placed = (share) => Float64Array.from({ length: moving + 1 }, (_, k) => between(row(k), share));
  const over = { times, found, phi, duration, phiAt, placed, pace: 1, moves: row(moving), stops: [], isWhole: true };

  function top(_, number, measure) {
    const height = row(number).map(measure), most = height.reduce((a, b) => (b > a ? b : a), -Infinity);
    return { height: most > 0 ? row(number)[height.indexOf(most)] : NaN, time: times[height.indexOf(most)] };
  }

  return { whole: () => over, figures: () => [], top, byName: new Map(), places, moving, pace: () => 1 };
};
