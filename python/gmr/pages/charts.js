"use strict";
/* Vega-Lite charts, drawn when they first come to be seen; their colours are CSS, so light and dark need nothing. */

const views = new Map();

/* Expressions are interpreted and not compiled, so the page's security policy can forbid making code from text. */
const EMBEDDING = {
  mode: "vega-lite", actions: false, ast: true, defaultStyle: false,
  tooltip: { theme: "custom", disableDefaultStyle: true },
};

function chart(name) {
  if (!views.has(name)) {
    const element = document.querySelector(`.chart[data-figure="${name}"]`);
    const { spec, tables, renderer } = page.figures[name];
    const datasets = Object.fromEntries(Object.entries(tables).map(([key, table]) => [key, rowsOf(table)]));
    views.set(name, vegaEmbed(element, { ...spec, datasets }, { ...EMBEDDING, renderer }).then(({ view }) => {
      element.dataset.drawn = "yes";
      return view;
    }));
  }
  return views.get(name);
}

/* One after the other, with a pause in which the browser paints: the words come first. */
(async () => {
  for (const element of document.querySelectorAll(".chart")) {
    await new Promise((resume) => { setTimeout(resume); });
    if (!element.closest("[hidden]")) await chart(element.dataset.figure);
  }
  document.documentElement.dataset.drawn = "yes";
})();

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
