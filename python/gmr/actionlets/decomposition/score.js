"use strict";
/* The score: systems of staves, as many seconds in each as the window is wide enough for. */

const SCORE = (() => {
  const HOLDER = document.querySelector(".score");
  const TIP = document.querySelector(".score-tip");
  const STAFF = 36, ABOVE = 22, BELOW = 14, HEAD = 26, LEFT = 14, RIGHT = 16;
  const EASY = 190;     /* pixels a second that are easy to read */
  const SVG = "http://www.w3.org/2000/svg";

  const { seconds, frames, staves } = page.score;
  const frameTimes = unpacked(frames);
  const drawn = staves.map((stave) => {
    const recorded = unpacked(stave.recorded);
    const angles = unpacked(stave.angles);
    const all = [...recorded, ...angles];
    return {
      ...stave, recorded, angles, times: unpacked(stave.times), skews: unpacked(stave.skews),
      low: Math.min(...all), high: Math.max(...all),
    };
  });
  const widest = Math.max(1e-9, ...drawn.flatMap(({ angles }) =>
    Array.from(angles).slice(1).map((angle, n) => Math.abs(angle - angles[n]))));

  const bell = (u, T) => (u <= T ? 1 - Math.cos(Math.PI * u / T) : 1 + Math.cos(Math.PI * (u - T) / (1 - T))) / 2;
  const share = (u, T) => (u <= T
    ? u - T / Math.PI * Math.sin(Math.PI * u / T)
    : u + (1 - T) / Math.PI * Math.sin(Math.PI * (u - T) / (1 - T)));

  function make(parent, tag, attributes, content) {
    const made = document.createElementNS(SVG, tag);
    for (const [name, value] of Object.entries(attributes)) made.setAttribute(name, value);
    if (content !== undefined) made.textContent = content;
    parent.append(made);
    return made;
  }
  const n1 = (value) => value.toFixed(1);
  const degrees = (value, digits = Math.abs(value) < 10 ? 1 : 0) =>
    `${value < 0 ? "−" : ""}${Math.abs(value).toFixed(digits)}°`;

  /* Of a piece, the points of a curve between two times: `at(u)` gives y. */
  function course(stave, piece, from, to, x, at) {
    const begin = stave.times[piece], length = stave.times[piece + 1] - begin;
    const u0 = Math.max(0, (from - begin) / length), u1 = Math.min(1, (to - begin) / length);
    if (u1 <= u0) return [];
    const count = Math.max(6, Math.ceil((x(begin + u1 * length) - x(begin + u0 * length)) / 3));
    return Array.from({ length: count + 1 }, (_, k) => {
      const u = u0 + (u1 - u0) * k / count;
      return `${n1(x(begin + u * length))},${n1(at(u))}`;
    });
  }

  function drawStave(parent, stave, number, from, to, x, top) {
    const bottom = top + STAFF, middle = top + STAFF / 2;
    const group = make(parent, "g", { class: `side-${stave.side}` });
    for (let line = 0; line < 5; line += 1) {
      const y = Math.round(top + STAFF * line / 4) + 0.5;
      make(group, "line", { class: line === 2 ? "middle" : "staff", x1: x(from), x2: x(to), y1: y, y2: y });
    }
    const y = (angle) => bottom - (angle - stave.low) / Math.max(stave.high - stave.low, 1e-9) * STAFF;
    const composed = [];
    for (let piece = 0; piece < stave.skews.length; piece += 1) {
      if (stave.times[piece + 1] <= from || stave.times[piece] >= to) continue;
      const a = stave.angles[piece], way = stave.angles[piece + 1] - a, T = stave.skews[piece];
      composed.push(...course(stave, piece, from, to, x, (u) => y(a + way * share(u, T))));
      const known = { "data-stave": number, "data-piece": piece };
      if (way === 0) {
        const centre = x((Math.max(from, stave.times[piece]) + Math.min(to, stave.times[piece + 1])) / 2);
        make(group, "rect", { class: "rest", x: n1(centre - 7), y: middle, width: 14, height: 5, ...known });
        continue;
      }
      const tall = Math.sign(way) * Math.sqrt(Math.abs(way) / widest) * STAFF * 0.62;
      const points = course(stave, piece, from, to, x, (u) => middle - tall * bell(u, T));
      const first = points[0].split(",")[0], last = points[points.length - 1].split(",")[0];
      make(group, "path", { class: "bell", d: `M${first},${n1(middle)}L${points.join("L")}L${last},${n1(middle)}Z`, ...known });
    }
    const seen = Array.from(stave.recorded, (angle, n) => [frameTimes[n], angle])
      .filter(([time]) => time >= from - 0.02 && time <= to + 0.02)
      .map(([time, angle]) => `${n1(x(Math.min(Math.max(time, from), to)))},${n1(y(angle))}`);
    make(group, "path", { class: "recorded", d: `M${seen.join("L")}` });
    make(group, "path", { class: "composed", d: `M${composed.join("L")}` });
    stave.times.forEach((time, n) => {
      if (time >= from - 1e-6 && time <= to + 1e-6) {
        make(group, "circle", { class: "turn", cx: n1(x(time)), cy: n1(y(stave.angles[n])), r: 1.7 });
      }
    });
    /* Whole stretches of a stave can be pointed at, also with a finger. */
    for (let piece = 0; piece < stave.skews.length; piece += 1) {
      const begin = Math.max(from, stave.times[piece]), end = Math.min(to, stave.times[piece + 1]);
      if (end <= begin) continue;
      make(group, "rect", {
        class: "hit", x: n1(x(begin)), width: n1(x(end) - x(begin)), y: top - 7, height: STAFF + 14,
        "data-stave": number, "data-piece": piece,
      });
    }
    const label = make(group, "text", { x: x(from), y: top - 8 });
    if (number === 0 || drawn[number - 1].joint !== stave.joint) {
      const joint = document.createElementNS(SVG, "tspan");
      joint.setAttribute("class", "joint");
      joint.setAttribute("style", "font-size:14px;font-weight:600;fill:var(--ink)");
      joint.textContent = `${stave.joint}  `;
      label.append(joint);
    }
    const movement = document.createElementNS(SVG, "tspan");
    movement.setAttribute("style", "font-style:italic;font-size:13px");
    movement.textContent = stave.movement;
    label.append(movement);
    make(group, "text", { class: "range", x: x(to), y: top - 8 }, `${degrees(stave.low)} to ${degrees(stave.high)}`);
  }

  function drawSystem(from, to, width, pixels, isLast) {
    const step = STAFF + ABOVE + BELOW;
    const height = HEAD + drawn.length * step;
    const svg = make(HOLDER, "svg", { viewBox: `0 0 ${width} ${height}`, height });
    const x = (time) => LEFT + (time - from) * pixels;
    const top = HEAD + ABOVE, bottom = HEAD + drawn.length * step - BELOW;
    for (let second = Math.ceil(from - 1e-9); second <= to + 1e-9; second += 1) {
      const at = Math.round(x(second)) + 0.5;
      if (second > from) make(svg, "line", { class: "bar", x1: at, x2: at, y1: top, y2: bottom });
      make(svg, "text", { class: "second", x: Math.max(at, LEFT + 6), y: 14 }, `${second} s`);
    }
    make(svg, "line", { class: "bar", x1: x(from), x2: x(from), y1: top, y2: bottom });
    if (isLast) {
      make(svg, "line", { class: "bar", x1: x(to) + 5, x2: x(to) + 5, y1: top, y2: bottom });
      make(svg, "line", { class: "bar last", x1: x(to) + 10, x2: x(to) + 10, y1: top, y2: bottom });
    }
    drawn.forEach((stave, n) => drawStave(svg, stave, n, from, to, x, HEAD + ABOVE + n * step));
    for (let first = 0; first < drawn.length;) {
      let end = first + 1;
      while (end < drawn.length && drawn[end].joint === drawn[first].joint) end += 1;
      const y0 = HEAD + ABOVE + first * step, y1 = HEAD + ABOVE + (end - 1) * step + STAFF;
      make(svg, "path", { class: "brace", d: `M${LEFT - 4},${y0 - 2}h-5V${y1 + 2}h5` });
      first = end;
    }
  }

  let width = 0;
  function draw() {
    const wide = Math.floor(HOLDER.clientWidth);
    if (wide === width || !wide) return;
    width = wide;
    HOLDER.replaceChildren();
    const room = wide - LEFT - RIGHT;
    const systems = Math.max(1, Math.ceil(seconds * EASY / room));
    /* Bar lines stay where they are: all systems but the last hold the same time. */
    const each = systems === 1 ? seconds : Math.max(0.5, Math.floor(room / EASY * 2) / 2);
    const pixels = room / each;
    for (let from = 0; from < seconds - 1e-6; from += each) {
      const to = Math.min(from + each, seconds);
      drawSystem(from, to, wide, pixels, to >= seconds - 1e-6);
    }
    HOLDER.dataset.drawn = "yes";
  }

  function tell(event) {
    const at = event.target.closest?.("[data-piece]");
    for (const old of HOLDER.querySelectorAll(".chosen")) old.classList.remove("chosen");
    if (!at) { TIP.hidden = true; return; }
    const { stave: number, piece } = at.dataset;
    for (const same of HOLDER.querySelectorAll(`[data-stave="${number}"][data-piece="${piece}"]`)) same.classList.add("chosen");
    const stave = drawn[Number(number)], k = Number(piece);
    const [t0, t1, a0, a1] = [stave.times[k], stave.times[k + 1], stave.angles[k], stave.angles[k + 1]];
    const title = document.createElement("strong");
    title.textContent = `${stave.joint}, ${stave.movement}`;
    const words = document.createElement("span");
    words.textContent = a0 === a1
      ? `silence at ${degrees(a0, 1)} for ${(t1 - t0).toFixed(3)} s, from ${t0.toFixed(2)} s`
      : `${degrees(a0, 1)} to ${degrees(a1, 1)} in ${(t1 - t0).toFixed(3)} s, from ${t0.toFixed(2)} s; T = ${stave.skews[k].toFixed(2)}; RMS of the stave ${stave.rms.toFixed(2)}°`;
    TIP.replaceChildren(title, words);
    TIP.hidden = false;
    const box = TIP.getBoundingClientRect();
    TIP.style.left = `${Math.max(8, Math.min(event.clientX + 14, innerWidth - box.width - 8))}px`;
    TIP.style.top = `${event.clientY + 18 + box.height > innerHeight ? event.clientY - box.height - 12 : event.clientY + 18}px`;
  }

  HOLDER.addEventListener("pointermove", tell);
  HOLDER.addEventListener("pointerdown", tell);
  HOLDER.addEventListener("pointerleave", () => tell({ target: HOLDER }));
  addEventListener("resize", draw);
  draw();
})();
