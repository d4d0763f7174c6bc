"use strict";
/* Vega-Lite charts, drawn when they come near to view; their colours are CSS, so light and dark need nothing. */

const views = new Map();

/* Expressions are interpreted and not compiled, so the page's security policy can forbid making code from text. */
const EMBEDDING = {
  mode: "vega-lite", actions: false, ast: true, defaultStyle: false,
  tooltip: { theme: "custom", disableDefaultStyle: true },
};

const placeOf = (name) => document.querySelector(`.chart[data-figure="${name}"]`);

/* The view of a chart, which is drawn now if it is not yet. */
function chart(name) {
  if (!views.has(name)) views.set(name, drawn(name));
  return views.get(name);
}

async function drawn(name) {
  const element = placeOf(name);
  const { spec, tables, renderer } = page.figures[name];
  const datasets = Object.fromEntries(Object.entries(tables).map(([key, table]) => [key, rowsOf(table)]));
  asked.add(element);
  tell();
  const { view } = await vegaEmbed(element, { ...spec, datasets }, { ...EMBEDDING, renderer });
  element.style.minHeight = "";
  element.dataset.drawn = "yes";
  element.dispatchEvent(new Event("drawn"));
  asked.delete(element);
  tell();
  return view;
}

/* Does something with a chart's view when it is drawn, without asking for that. */
function whenDrawn(name, act) {
  const element = placeOf(name);
  if (element.dataset.drawn === "yes") chart(name).then(act);
  else element.addEventListener("drawn", () => chart(name).then(act), { once: true });
}

/* What is in view or was asked for, and is not drawn. The page says data-drawn="yes" while there is nothing of it. */
const asked = new Set();

function tell() {
  document.documentElement.dataset.drawn = asked.size ? "no" : "yes";
}

const untouched = (element) => !views.has(element.dataset.figure);

function fromView(element) {
  const { top, bottom } = element.getBoundingClientRect();
  return Math.max(top - innerHeight, -bottom, 0);
}

/* One after the other, the nearest first, with pauses in which the browser paints and listens. */
let busy = false;
async function drawNearest() {
  if (busy) return;
  busy = true;
  for (;;) {
    await new Promise((resume) => { setTimeout(resume); });
    const [next] = [...asked].filter(untouched).sort((a, b) => fromView(a) - fromView(b));
    if (!next) break;
    await chart(next.dataset.figure).catch(reportError);
  }
  busy = false;
}

const charts = [...document.querySelectorAll(".chart")];

/* As high as it will be, about, so that what is read does not move when a chart above it is drawn. */
for (const element of charts) {
  const { height } = page.figures[element.dataset.figure].spec;
  if (typeof height === "number") element.style.minHeight = `${height + 90}px`;
}

/* Two screens ahead: who reads on finds charts that are there. */
const nearby = new IntersectionObserver((entries) => {
  for (const { target, isIntersecting } of entries) {
    if (!untouched(target)) nearby.unobserve(target);
    else if (isIntersecting) asked.add(target);
    else asked.delete(target);
  }
  tell();
  drawNearest();
}, { rootMargin: "200% 0px" });
for (const element of charts) nearby.observe(element);
if (!charts.length) tell();

/* On paper all is in view. Whoever takes pictures of a page asks for it by the event "draw-all". */
function drawAll() {
  for (const element of charts.filter(untouched)) {
    if (element.getClientRects().length) chart(element.dataset.figure).catch(reportError);
  }
}
addEventListener("beforeprint", drawAll);
matchMedia("print").addEventListener("change", ({ matches }) => { if (matches) drawAll(); });
document.addEventListener("draw-all", drawAll);

/* One of several figures is shown, chosen by the controls of their group. */
for (const group of document.querySelectorAll("[data-choose]")) {
  const figures = [...group.querySelectorAll("[data-choice]")];
  group.addEventListener("change", () => {
    const chosen = [...group.querySelectorAll("input:checked, select")].map((control) => control.value).join(" ");
    const shown = figures.find((figure) => figure.dataset.choice === chosen);
    for (const figure of figures) figure.hidden = figure !== shown;
    for (const element of shown.querySelectorAll(".chart")) {
      chart(element.dataset.figure).then(() => {
        /* A chart that was hidden while the window changed has missed it. */
        if (Math.abs(element.clientWidth - element.querySelector("svg").clientWidth) > 1) {
          dispatchEvent(new Event("resize"));
        }
      });
    }
  });
}
