"use strict";
/* The worst trial: the skeleton moves along its path, beside the path that was planned. */

function player(root) {
  const replay = page.replay;
  const { rate, steps, joints, parents, sides, head, unit } = replay;
  const [positions, path, plan, offset, clip, seconds, jumped] =
    ["positions", "path", "reference", "offset", "clip", "seconds", "jumped"].map((name) => unpacked(replay[name]));
  const duration = (steps - 1) / rate;
  const worst = offset.indexOf(offset.reduce((most, value) => Math.max(most, value), 0));
  const find = (name) => root.querySelector(`[data-part="${name}"]`);
  const stage = find("stage"), strip = find("strip"), scrubber = find("scrubber"), play = find("play");
  const camera = { turn: 0.7, tilt: 0.42, zoom: 1, follow: true };
  let time = worst / rate, playing = false, before = 0, colours = {};

  /* Pose at a time between two steps: (x, y, z) of every joint. */
  const pose = new Float32Array(joints * 3);
  function takePose(at) {
    const step = Math.min(Math.floor(at), steps - 1), next = Math.min(step + 1, steps - 1), part = at - step;
    const between = (values, width, place) =>
      values[step * width + place] * (1 - part) + values[next * width + place] * part;
    const x = between(path, 2, 0), z = between(path, 2, 1);
    for (let joint = 0; joint < joints; joint += 1) {
      pose[joint * 3] = between(positions, joints * 3, joint * 3) * unit + x;
      pose[joint * 3 + 1] = between(positions, joints * 3, joint * 3 + 1) * unit;
      pose[joint * 3 + 2] = between(positions, joints * 3, joint * 3 + 2) * unit + z;
    }
    return { x, z, planX: between(plan, 2, 0), planZ: between(plan, 2, 1), offset: between(offset, 1, 0), step };
  }

  /* The middle and the reach of both paths: what the camera looks at when it does not follow. */
  const span = [0, 1].map((axis) => {
    let low = Infinity, high = -Infinity;
    for (const way of [path, plan]) {
      for (let step = 0; step < steps; step += 1) {
        low = Math.min(low, way[step * 2 + axis]);
        high = Math.max(high, way[step * 2 + axis]);
      }
    }
    return { middle: (low + high) / 2, reach: (high - low) / 2 };
  });
  const overview = Math.max(3, Math.hypot(span[0].reach, span[1].reach));

  const NEAR = 0.2;
  let view = null;
  function look(now, width, height) {
    const target = camera.follow ? [now.x, 0.85, now.z] : [span[0].middle, 0, span[1].middle];
    const focal = Math.min(width, height * 1.2) * 1.15;
    const distance = (camera.follow ? 4.6 : overview * 2.6) / camera.zoom;
    const [sinTurn, cosTurn, sinTilt, cosTilt] =
      [Math.sin(camera.turn), Math.cos(camera.turn), Math.sin(camera.tilt), Math.cos(camera.tilt)];
    view = {
      focal, distance, target,
      /* Camera space: x to the right, y up, z away from the eye. Left of the character is +X, so x is mirrored. */
      seen(x, y, z) {
        const dx = x - target[0], dy = y - target[1], dz = z - target[2];
        const along = dx * sinTurn + dz * cosTurn;
        return [-(dx * cosTurn - dz * sinTurn), dy * cosTilt + along * sinTilt,
          distance + along * cosTilt - dy * sinTilt];
      },
      drawn([x, y, depth]) {
        return [width / 2 + (x / depth) * focal, height * (camera.follow ? 0.54 : 0.56) - (y / depth) * focal];
      },
    };
  }

  /* A line from a to b in camera space, cut where it comes behind the eye; false where nothing is left. */
  function line(context, a, b) {
    if (a[2] < NEAR && b[2] < NEAR) return false;
    const cut = (from, to) => {
      if (from[2] >= NEAR) return from;
      const part = (NEAR - from[2]) / (to[2] - from[2]);
      return from.map((value, axis) => value + part * (to[axis] - value));
    };
    context.moveTo(...view.drawn(cut(a, b)));
    context.lineTo(...view.drawn(cut(b, a)));
    return true;
  }

  function ground(context, now) {
    const reach = camera.follow ? 9 : Math.ceil(overview * 1.3);
    const cell = camera.follow || overview < 12 ? 1 : 5;
    const middle = [view.target[0], view.target[2]].map((value) => Math.round(value / cell) * cell);
    context.strokeStyle = colours.line;
    context.lineWidth = 1;
    for (let k = -Math.ceil(reach / cell); k <= Math.ceil(reach / cell); k += 1) {
      context.globalAlpha = camera.follow ? Math.max(0, 1 - Math.abs(k * cell) / reach) : 0.7;
      context.beginPath();
      const [x, z] = [middle[0] + k * cell, middle[1] + k * cell];
      line(context, view.seen(x, 0, middle[1] - reach), view.seen(x, 0, middle[1] + reach));
      line(context, view.seen(middle[0] - reach, 0, z), view.seen(middle[0] + reach, 0, z));
      context.stroke();
    }
    context.globalAlpha = 1;
  }

  function way(context, points, from, to, colour, width, dashes) {
    context.strokeStyle = colour;
    context.lineWidth = width;
    context.setLineDash(dashes);
    context.beginPath();
    const stride = Math.max(1, Math.round(rate / 15));
    let last = view.seen(points[from * 2], 0, points[from * 2 + 1]);
    for (let step = from + stride; step < to + stride; step += stride) {
      const at = Math.min(step, to);
      const next = view.seen(points[at * 2], 0, points[at * 2 + 1]);
      line(context, last, next);
      last = next;
    }
    context.stroke();
    context.setLineDash([]);
  }

  function ring(context, x, z, radius, colour) {
    context.strokeStyle = colour;
    context.lineWidth = 2.5;
    context.beginPath();
    for (let k = 0; k < 24; k += 1) {
      const [a, b] = [k, k + 1].map((place) => (place / 12) * Math.PI);
      line(context, view.seen(x + radius * Math.sin(a), 0, z + radius * Math.cos(a)),
        view.seen(x + radius * Math.sin(b), 0, z + radius * Math.cos(b)));
    }
    context.stroke();
  }

  function skeleton(context) {
    const bones = [];
    for (let joint = 0; joint < joints; joint += 1) {
      const parent = parents[joint];
      if (parent < 0) continue;
      const [a, b] = [parent, joint].map((end) => view.seen(pose[end * 3], pose[end * 3 + 1], pose[end * 3 + 2]));
      if (Math.min(a[2], b[2]) > NEAR) bones.push({ a, b, side: sides[joint], depth: a[2] + b[2] });
    }
    context.lineCap = "round";
    context.globalAlpha = 0.13;
    context.strokeStyle = colours.ink;
    context.lineWidth = Math.max(2, (0.09 * view.focal) / view.distance);
    context.beginPath();
    for (let joint = 0; joint < joints; joint += 1) {
      const parent = parents[joint];
      if (parent < 0) continue;
      line(context, view.seen(pose[parent * 3], 0, pose[parent * 3 + 2]), view.seen(pose[joint * 3], 0, pose[joint * 3 + 2]));
    }
    context.stroke();
    context.globalAlpha = 1;
    bones.sort((first, second) => second.depth - first.depth);
    for (const { a, b, side, depth } of bones) {
      const width = Math.max(2, (0.062 * view.focal * 2) / depth);
      for (const [colour, extra] of [[colours.panel, 2.5], [[colours.ink, colours.left, colours.right][side], 0]]) {
        context.strokeStyle = colour;
        context.lineWidth = width + extra;
        context.beginPath();
        context.moveTo(...view.drawn(a));
        context.lineTo(...view.drawn(b));
        context.stroke();
      }
    }
    if (head.length) {
      const middle = [0, 1, 2].map((axis) =>
        pose[head[0] * 3 + axis] * 0.5 + pose[head[1] * 3 + axis] * 0.5 + (axis === 1 && head[0] === head[1] ? 0.08 : 0));
      const seen = view.seen(...middle);
      if (seen[2] > NEAR) {
        context.fillStyle = colours.ink;
        context.beginPath();
        context.arc(...view.drawn(seen), Math.max(2, (0.105 * view.focal) / seen[2]), 0, 2 * Math.PI);
        context.fill();
      }
    }
    context.lineCap = "butt";
  }

  function sized(canvas) {
    const ratio = window.devicePixelRatio || 1;
    const width = canvas.clientWidth, height = canvas.clientHeight;
    if (canvas.width !== Math.round(width * ratio) || canvas.height !== Math.round(height * ratio)) {
      canvas.width = Math.round(width * ratio);
      canvas.height = Math.round(height * ratio);
    }
    const context = canvas.getContext("2d");
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
    context.clearRect(0, 0, width, height);
    return { context, width, height };
  }

  function drawStage(now) {
    const { context, width, height } = sized(stage);
    look(now, width, height);
    ground(context, now);
    way(context, plan, 0, steps - 1, colours.plan, 2, [8, 6]);
    context.globalAlpha = 0.35;
    way(context, path, now.step, steps - 1, colours.path, 1.5, []);
    context.globalAlpha = 1;
    way(context, path, 0, now.step, colours.path, 3, []);
    context.strokeStyle = colours.plan;
    context.lineWidth = 2;
    context.beginPath();
    line(context, view.seen(now.x, 0, now.z), view.seen(now.planX, 0, now.planZ));
    context.stroke();
    ring(context, now.planX, now.planZ, 0.22, colours.plan);
    skeleton(context);
  }

  /* The offset over the whole trial, with a tick for every jump. */
  function drawStrip() {
    const { context, width, height } = sized(strip);
    const base = height - 12, top = 14, most = Math.max(offset[worst], 0.05);
    const across = (step) => (step / Math.max(steps - 1, 1)) * width;
    context.fillStyle = colours.plan;
    context.globalAlpha = 0.28;
    context.beginPath();
    context.moveTo(0, base);
    for (let step = 0; step < steps; step += 1) context.lineTo(across(step), base - (offset[step] / most) * (base - top));
    context.lineTo(width, base);
    context.fill();
    context.globalAlpha = 0.75;
    context.strokeStyle = colours.soft;
    context.lineWidth = 1;
    context.beginPath();
    for (let step = 0; step < steps; step += 1) {
      if (!jumped[step]) continue;
      context.moveTo(across(step), base + 3);
      context.lineTo(across(step), base + 9);
    }
    context.stroke();
    context.globalAlpha = 1;
    context.strokeStyle = colours.line;
    context.beginPath();
    context.moveTo(0, base + 0.5);
    context.lineTo(width, base + 0.5);
    context.stroke();
    context.fillStyle = colours.soft;
    context.font = "12px system-ui, sans-serif";
    const label = `${offset[worst].toFixed(2)} m`;
    const wide = context.measureText(label).width;
    context.fillText(label, Math.min(Math.max(across(worst) - wide / 2, 0), width - wide), 11);
    context.strokeStyle = colours.ink;
    context.lineWidth = 2;
    context.beginPath();
    context.moveTo(across(time * rate), top - 2);
    context.lineTo(across(time * rate), height);
    context.stroke();
  }

  function draw() {
    const now = takePose(Math.min(time * rate, steps - 1));
    drawStage(now);
    drawStrip();
    find("offset").textContent = `${now.offset.toFixed(2)} m`;
    find("time").textContent = `${time.toFixed(1)} of ${duration.toFixed(1)} s`;
    find("clip").textContent = replay.clips[clip[now.step]];
    find("source").textContent = `at ${seconds[now.step].toFixed(2)} s of the clip`;
    scrubber.value = String(Math.round(time * rate));
    scrubber.setAttribute("aria-valuetext",
      `${time.toFixed(1)} seconds, ${now.offset.toFixed(2)} metres from the plan`);
    root.dataset.time = time.toFixed(3);
  }

  function dress() {
    const style = getComputedStyle(document.documentElement);
    const colour = (name) => style.getPropertyValue(`--${name}`).trim();
    colours = {
      ink: colour("ink"), soft: colour("ink-soft"), line: colour("line"), panel: colour("panel"),
      path: colour("accent"), plan: colour("reference"), left: colour("kind-0"), right: colour("kind-1"),
    };
    draw();
  }

  function setPlaying(on) {
    if (on && time >= duration) time = 0;
    playing = on;
    play.textContent = on ? "Pause" : "Play";
    if (on) {
      before = performance.now();
      requestAnimationFrame(advance);
    }
  }

  function advance(now) {
    if (!playing) return;
    /* The first frame's time can lie before the click that it follows. */
    const passed = Math.max(now - before, 0) / 1000;
    time = Math.min(time + passed * Number(find("pace").value), duration);
    before = now;
    draw();
    if (time >= duration) setPlaying(false);
    else requestAnimationFrame(advance);
  }

  function goTo(seconds_) {
    time = Math.min(Math.max(seconds_, 0), duration);
    draw();
  }

  function turnCamera(turn, tilt) {
    camera.turn += turn;
    camera.tilt = Math.min(Math.max(camera.tilt + tilt, 0.05), 1.5);
    draw();
  }

  play.addEventListener("click", () => setPlaying(!playing));
  scrubber.max = String(steps - 1);
  scrubber.addEventListener("input", () => goTo(Number(scrubber.value) / rate));
  find("start").addEventListener("click", () => goTo(0));
  find("worst").addEventListener("click", () => goTo(worst / rate));
  find("follow").addEventListener("change", (event) => {
    camera.follow = event.target.checked;
    draw();
  });
  find("nearer").addEventListener("click", () => { camera.zoom = Math.min(camera.zoom * 1.25, 5); draw(); });
  find("farther").addEventListener("click", () => { camera.zoom = Math.max(camera.zoom / 1.25, 0.2); draw(); });
  find("reset").addEventListener("click", () => {
    Object.assign(camera, { turn: 0.7, tilt: 0.42, zoom: 1, follow: true });
    find("follow").checked = true;
    draw();
  });

  let grip = null;
  stage.addEventListener("pointerdown", (event) => {
    grip = { x: event.clientX, y: event.clientY };
    stage.setPointerCapture(event.pointerId);
  });
  stage.addEventListener("pointermove", (event) => {
    if (grip === null) return;
    turnCamera((event.clientX - grip.x) * 0.008, (event.clientY - grip.y) * 0.006);
    grip = { x: event.clientX, y: event.clientY };
  });
  for (const end of ["pointerup", "pointercancel"]) stage.addEventListener(end, () => { grip = null; });
  stage.addEventListener("keydown", (event) => {
    const turns = { ArrowLeft: [-0.1, 0], ArrowRight: [0.1, 0], ArrowUp: [0, 0.1], ArrowDown: [0, -0.1] };
    if (event.key === " ") setPlaying(!playing);
    else if (turns[event.key]) turnCamera(...turns[event.key]);
    else return;
    event.preventDefault();
  });

  new ResizeObserver(draw).observe(stage);
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", dress);
  /* Printed in the colours of paper, whatever the screen's are. */
  addEventListener("beforeprint", () => { document.documentElement.classList.add("printing"); dress(); });
  addEventListener("afterprint", () => { document.documentElement.classList.remove("printing"); dress(); });
  dress();
}

for (const root of document.querySelectorAll(".player")) player(root);
