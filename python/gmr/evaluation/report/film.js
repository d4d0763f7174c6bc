"use strict";
/* The trials of a dataset, unpacked: where the root went, where it was asked to be, and how the body stood. */

async function inflated(base64) {
  const bytes = Uint8Array.from(atob(base64), (letter) => letter.charCodeAt(0));
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate"));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

/* Whole numbers from their bytes, the low ones of all first; the last bit is the sign. */
function wholeNumbers(bytes, layout) {
  const columns = {};
  let from = 0;
  for (const [name, count, width] of layout) {
    const values = new Int32Array(count);
    for (let plane = 0; plane < width; plane += 1) {
      for (let k = 0; k < count; k += 1) values[k] |= bytes[from + k] << (8 * plane);
      from += count;
    }
    for (let k = 0; k < count; k += 1) values[k] = (values[k] >>> 1) ^ -(values[k] & 1);
    columns[name] = values;
  }
  return columns;
}

/* Ranges of rows: where each begins among all rows held, and among the poses held. */
function rangesOf({ rows }, stride) {
  let row = 0, sample = 0;
  return rows.map((count) => {
    const samples = Math.ceil((count - 1) / stride) + 1;
    const range = { row, count, sample, samples };
    row += count;
    sample += samples;
    return range;
  });
}

/* The place of a plan, after `time` seconds, of [seconds, speed, turn rate, drift] one after the other. */
function planned(segments, time) {
  let x = 0, z = 0, heading = 0, left = time;
  segments.forEach(([seconds, speed, rate, drift], k) => {
    const spent = k === segments.length - 1 ? left : Math.min(left, seconds);
    if (spent <= 0) return;
    const half = (rate * spent) / 2;
    const way = speed * spent * (Math.abs(half) < 1e-9 ? 1 : Math.sin(half) / half);
    x += way * Math.sin(heading + drift + half);
    z += way * Math.cos(heading + drift + half);
    heading += 2 * half;
    left -= spent;
  });
  return [x, z];
}

async function openFilm(film) {
  const { rate, stride, unit, wayUnit, parents } = film;
  const joints = parents.length, width = joints * 3;
  const { poses, ways, runs, steps, rows } = wholeNumbers(await inflated(film.packed), film.layout);
  const ranges = rangesOf(film.ranges, stride);
  const held = ranges.reduce((total, range) => total + range.count, 0);
  const samples = ranges.reduce((total, range) => total + range.samples, 0);

  const stands = new Int16Array(samples * width);
  for (let column = 0; column < width; column += 1) {
    for (const range of ranges) {
      let value = 0, change = 0;
      for (let k = 0; k < range.samples; k += 1) {
        const second = poses[column * samples + range.sample + k];
        /* The first is the place itself, and no change to go on from. */
        if (k === 0) value = second;
        else {
          change = k === 1 ? second : change + second;
          value += change;
        }
        stands[(range.sample + k) * width + column] = value;
      }
    }
  }
  const way = new Float64Array(held * 3);
  for (let column = 0; column < 3; column += 1) {
    let change = 0;
    for (let row = 0; row < held; row += 1) {
      change += ways[column * held + row];
      way[row * 3 + column] = change * wayUnit;
    }
  }

  function rangeOf(row) {
    let low = 0, high = ranges.length - 1;
    while (low < high) {
      const middle = (low + high + 1) >> 1;
      if (ranges[middle].row <= row) low = middle;
      else high = middle - 1;
    }
    return low;
  }

  /* Adds the pose at a row, which may lie between two, times a factor, seen from the root. */
  function addPose(range, row, factor, out) {
    const within = Math.min(Math.max(row - range.row, 0), range.count - 1);
    const before = Math.min(Math.floor(within / stride), Math.max(range.samples - 2, 0));
    const after = Math.min(before + 1, range.samples - 1);
    const gap = Math.min(after * stride, range.count - 1) - before * stride;
    const part = gap > 0 ? (within - before * stride) / gap : 0;
    const a = (range.sample + before) * width, b = (range.sample + after) * width;
    const [first, second] = [factor * (1 - part) * unit, factor * part * unit];
    for (let k = 0; k < width; k += 1) out[k] += first * stands[a + k] + second * stands[b + k];
  }

  const firstRun = [0];
  for (const count of runs) firstRun.push(firstRun[firstRun.length - 1] + count);

  function trial(number) {
    const told = film.trials[number];
    const pieces = [];
    let step = 0;
    for (let run = firstRun[number]; run < firstRun[number + 1]; run += 1) {
      const number_ = rangeOf(rows[run]);
      pieces.push({ step, row: rows[run], range: ranges[number_], clip: film.ranges.clip[number_],
        seconds: film.ranges.seconds[number_] });
      step += steps[run];
    }
    const count = step;
    const path = new Float32Array(count * 2), headings = new Float64Array(count);
    const plan = new Float32Array(count * 2), offset = new Float32Array(count);
    const piece = new Uint16Array(count);
    let [x, z, heading] = told.start;
    for (let k = 0, at = 0; k < count; k += 1) {
      if (at + 1 < pieces.length && pieces[at + 1].step === k) at += 1;
      piece[k] = at;
      path.set([x, z], k * 2);
      plan.set(planned(told.segments, k / rate), k * 2);
      headings[k] = heading;
      offset[k] = Math.hypot(x - plan[k * 2], z - plan[k * 2 + 1]);
      const row = (pieces[at].row + k - pieces[at].step) * 3;
      const [left, ahead, turn] = way.subarray(row, row + 3);
      x += ahead * Math.sin(heading) + left * Math.cos(heading);
      z += ahead * Math.cos(heading) - left * Math.sin(heading);
      heading += turn;
    }

    /* At a jump the pose goes on as it was going; what parts it from the new one dies away like a critically damped
       spring. The springs are linear, so every jump of the last second has its share, whichever moment is looked at. */
    const pull = (2 * Math.LN2) / film.halfLife;
    function addSmoothing(at, out) {
      for (let k = piece[Math.floor(at)]; k > 0; k -= 1) {
        const time = (at - pieces[k].step) / rate;
        if (time > 8 * film.halfLife) break;
        const left = pieces[k - 1], entered = pieces[k];
        const last = left.row + entered.step - left.step;
        const fading = Math.exp(-pull * time);
        const place = fading * (1 + pull * time), speed = fading * time * rate;
        addPose(left.range, last, place + speed, out);
        addPose(left.range, last - 1, -speed, out);
        addPose(entered.range, entered.row, speed - place, out);
        addPose(entered.range, entered.row + 1, -speed, out);
      }
    }

    const local = new Float64Array(width);
    /* The pose at a step, which may lie between two, in the world. */
    function poseAt(at, out) {
      const now = Math.min(Math.floor(at), count - 1), next = Math.min(now + 1, count - 1), part = at - now;
      const { row, step: since, range } = pieces[piece[now]];
      local.fill(0);
      addPose(range, row + at - since, 1, local);
      addSmoothing(at, local);
      const between = (values, place) => values[now * 2 + place] * (1 - part) + values[next * 2 + place] * part;
      const turned = headings[now] * (1 - part) + headings[next] * part;
      const [sin, cos] = [Math.sin(turned), Math.cos(turned)];
      const here = { x: between(path, 0), z: between(path, 1), planX: between(plan, 0), planZ: between(plan, 1) };
      for (let joint = 0; joint < width; joint += 3) {
        out[joint] = local[joint] * cos + local[joint + 2] * sin + here.x;
        out[joint + 1] = local[joint + 1];
        out[joint + 2] = local[joint + 2] * cos - local[joint] * sin + here.z;
      }
      return { ...here, step: now, offset: offset[now] * (1 - part) + offset[next] * part };
    }

    function sourceAt(step_) {
      const { row, step: since, range, clip, seconds } = pieces[piece[step_]];
      return { clip: film.clips[clip], seconds: seconds + (row + step_ - since - range.row) / rate };
    }

    return { told, steps: count, path, plan, offset, jumps: pieces.slice(1).map((one) => one.step), poseAt, sourceAt };
  }

  return { film, joints, rate, trial };
}
