"use strict";
/* One trial of one dataset: the skeleton moves along its path, beside the path that was planned. */

async function player(root) {
  const find = (name) => root.querySelector(`[data-part="${name}"]`);
  const stage = find("stage"), strip = find("strip"), scrubber = find("scrubber"), play = find("play");
  const camera = { turn: 0.7, tilt: 0.42, zoom: 1, follow: true };
  let film, trial, body, pose, worst, duration, overview, middle;
  let time = 0, playing = false, before = 0, colours = {};

  const opening = new Map();
  function opened(number) {
    if (!opening.has(number)) opening.set(number, openFilm(page.films[number]));
    return opening.get(number);
  }

  /* Shows the trial number `index` of the table of a dataset, at the step where it is farthest from its plan. */
  async function show(number, index) {
    const next = await opened(number);
    const place = next.film.trials.findIndex((told) => told.index === index);
    if (place < 0) return false;
    film = next;
    trial = film.trial(place);
    body = { parents: film.film.parents, sides: film.film.sides, head: film.film.head };
    pose = new Float32Array(film.joints * 3);
    worst = trial.offset.indexOf(trial.offset.reduce((most, value) => Math.max(most, value), 0));
    duration = (trial.steps - 1) / film.rate;
    ({ overview, middle } = whole(trial));
    time = worst / film.rate;
    scrubber.max = String(trial.steps - 1);
    find("sentence").textContent = trial.told.sentence;
    listTrials(number);
    find("trial").value = String(index);
    root.dataset.film = String(number);
    root.dataset.trial = String(index);
    setPlaying(false);
    draw();
    document.dispatchEvent(new CustomEvent("replayed", { detail: { film: number, trial: index } }));
    return true;
  }

  function listTrials(number) {
    const select = find("trial");
    if (select.dataset.film === String(number)) return;
    select.dataset.film = String(number);
    find("dataset").value = String(number);
    const { trials, sets } = page.films[number];
    const groups = new Map();
    for (const told of trials) {
      if (!groups.has(told.set)) groups.set(told.set, []);
      groups.get(told.set).push(new Option(`${told.label}: ${told.away.toFixed(2)} m off`, told.index));
    }
    select.replaceChildren(...[...groups].flatMap(([set, options]) => {
      if (groups.size === 1) return options;
      const group = document.createElement("optgroup");
      group.label = sets[set];
      group.append(...options);
      return [group];
    }));
  }

  /* The middle and the reach of both paths: what the camera looks at when it does not follow. */
  function whole({ path, plan, steps }) {
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
    return {
      overview: Math.max(3, Math.hypot(span[0].reach, span[1].reach)),
      middle: [span[0].middle, 0, span[1].middle],
    };
  }

  function eye(now, width, height) {
    return eyeOf({
      turn: camera.turn, tilt: camera.tilt, width, height,
      distance: (camera.follow ? 4.6 : overview * 2.6) / camera.zoom,
      target: camera.follow ? [now.x, 0.85, now.z] : middle,
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
    const { path, plan, steps } = trial;
    const seen = eye(now, width, height);
    const stride = Math.max(1, Math.round(film.rate / 15));
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
    drawShadow(context, seen, pose, body.parents, colours.ink);
    drawSkeleton(context, seen, pose, body, colours);
  }

  /* The offset over the whole trial, with a tick for every jump. */
  function drawStrip() {
    const { context, width, height } = sized(strip);
    const { offset, steps, jumps } = trial;
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
    for (const step of jumps) {
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
    context.moveTo(across(time * film.rate), top - 2);
    context.lineTo(across(time * film.rate), height);
    context.stroke();
  }

  function draw() {
    if (!trial) return;
    const now = trial.poseAt(Math.min(time * film.rate, trial.steps - 1), pose);
    drawStage(now);
    drawStrip();
    const source = trial.sourceAt(now.step);
    find("offset").textContent = `${now.offset.toFixed(2)} m`;
    find("time").textContent = `${time.toFixed(1)} of ${duration.toFixed(1)} s`;
    find("clip").textContent = source.clip;
    find("source").textContent = `at ${source.seconds.toFixed(2)} s of the clip`;
    scrubber.value = String(Math.round(time * film.rate));
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
  scrubber.addEventListener("input", () => goTo(Number(scrubber.value) / film.rate));
  find("start").addEventListener("click", () => goTo(0));
  find("worst").addEventListener("click", () => goTo(worst / film.rate));
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

  const firstOf = (number) => page.films[number].trials[page.films[number].first].index;
  const dataset = find("dataset");
  dataset.replaceChildren(...page.films.map((each, number) => new Option(each.dataset, number)));
  find("dataset-label").hidden = page.films.length < 2;
  dataset.addEventListener("change", async () => {
    const number = Number(dataset.value), same = Number(root.dataset.trial);
    if (!await show(number, same)) await show(number, firstOf(number));
  });
  find("trial").addEventListener("change", () => show(Number(root.dataset.film), Number(find("trial").value)));
  find("farthest").addEventListener("click", () => {
    const number = Number(root.dataset.film);
    show(number, firstOf(number));
  });

  /* Asked for from a map: it is brought to view and played from its start; a button leads back. */
  let origin = null;
  document.addEventListener("replay", async (event) => {
    if (!await show(event.detail.film, event.detail.trial)) {
      find("sentence").textContent = "This trial is not among those that the page holds.";
    }
    origin = event.detail.from;
    find("back").hidden = false;
    root.closest("section").scrollIntoView();
    stage.focus({ preventScroll: true });
    if (matchMedia("(prefers-reduced-motion: reduce)").matches) return;
    goTo(0);
    setPlaying(true);
  });
  find("back").addEventListener("click", () => {
    origin.scrollIntoView({ block: "center" });
    origin.focus({ preventScroll: true });
    find("back").hidden = true;
  });

  new ResizeObserver(draw).observe(stage);
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", dress);
  /* Printed in the colours of paper, whatever the screen's are. */
  addEventListener("beforeprint", () => { document.documentElement.classList.add("printing"); dress(); });
  addEventListener("afterprint", () => { document.documentElement.classList.remove("printing"); dress(); });
  dress();
  if (typeof DecompressionStream === "undefined") {
    find("sentence").textContent = "This browser is too old to unpack the trials (it lacks DecompressionStream).";
    return;
  }
  await show(0, firstOf(0));
  root.dataset.ready = "yes";
}

for (const root of document.querySelectorAll(".player")) player(root);
