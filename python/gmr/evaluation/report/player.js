"use strict";
/* The worst trial: the skeleton moves along its path, beside the path that was planned. */

function player(root) {
  const replay = page.replay;
  const { rate, steps, joints, unit } = replay;
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

  function eye(now, width, height) {
    return eyeOf({
      turn: camera.turn, tilt: camera.tilt, width, height,
      distance: (camera.follow ? 4.6 : overview * 2.6) / camera.zoom,
      target: camera.follow ? [now.x, 0.85, now.z] : [span[0].middle, 0, span[1].middle],
      middle: camera.follow ? 0.54 : 0.56,
    });
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
    const seen = eye(now, width, height);
    const stride = Math.max(1, Math.round(rate / 15));
    const pen = (colour, size, alpha = 1, dashes = []) => {
      context.strokeStyle = colour;
      context.lineWidth = size;
      context.globalAlpha = alpha;
      context.setLineDash(dashes);
    };
    const reach = camera.follow ? 9 : Math.ceil(overview * 1.3);
    const cell = camera.follow || overview < 12 ? 1 : 5;
    drawGround(context, seen, { colour: colours.line, reach, cell, fading: camera.follow });
    pen(colours.plan, 2, 1, [8, 6]);
    drawWay(context, seen, plan, 0, steps - 1, stride);
    pen(colours.path, 1.5, 0.35);
    drawWay(context, seen, path, now.step, steps - 1, stride);
    pen(colours.path, 3);
    drawWay(context, seen, path, 0, now.step, stride);
    pen(colours.plan, 2.5);
    context.beginPath();
    seen.line(context, seen.seen(now.x, 0, now.z), seen.seen(now.planX, 0, now.planZ));
    context.stroke();
    drawRing(context, seen, now.planX, now.planZ, 0.22);
    drawShadow(context, seen, pose, replay.parents, colours.ink);
    drawSkeleton(context, seen, pose, replay, colours);
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
