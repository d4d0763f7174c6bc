"use strict";
/* A cell of a trial map replays its trial: by a click, or by the arrow keys and Enter. */

const marked = { film: -1, trial: -1 };
document.addEventListener("replayed", ({ detail }) => Object.assign(marked, detail));

async function mapOf(name) {
  const view = await chart(name);
  const { speed, turn_rate_deg: turn, trial } = columnsOf(page.figures[name].tables.trials);
  const across = view.scale("x"), up = view.scale("y"), padding = view.padding();
  const left = view.origin()[0] + padding.left, top = view.origin()[1] + padding.top;
  return {
    turns: across.domain(), speeds: up.domain(),
    boxOf: (speed_, turn_) => ({
      left: left + across(turn_), top: top + up(speed_), width: across.bandwidth(), height: up.bandwidth(),
    }),
    trialAt: (speed_, turn_) => {
      const row = trial.findIndex((_, k) => speed[k] === speed_ && turn[k] === turn_);
      return row < 0 ? -1 : trial[row];
    },
    cellOf: (wanted) => {
      const row = trial.indexOf(wanted);
      return row < 0 ? null : [speed[row], turn[row]];
    },
  };
}

function trialMap(element) {
  /* A map of all datasets replays the one that the player shows. */
  const own = Number(element.dataset.film);
  const filmNow = () => (own < 0 ? Math.max(marked.film, 0) : own);
  const drawing = element.querySelector(".chart"), name = drawing.dataset.figure;
  const ring = document.createElement("div"), cursor = document.createElement("div");
  const said = document.createElement("span");
  ring.className = "cell-ring";
  cursor.className = "cell-ring cursor";
  said.className = "spoken";
  said.setAttribute("role", "status");
  element.append(ring, cursor, said);
  element.tabIndex = 0;
  element.setAttribute("role", "application");
  element.setAttribute("aria-label", "Map of the trials: the arrow keys choose a cell, Enter replays its trial");
  let at = null;

  function put(mark, map, cell) {
    mark.hidden = cell === null;
    if (cell === null) return;
    for (const [side, value] of Object.entries(map.boxOf(...cell))) mark.style[side] = `${value}px`;
  }

  /* The cells move when the chart takes a new width, which it does after its box has. */
  whenDrawn(name, (view) => {
    view.addSignalListener("width", () => view.runAfter(marks));
    marks();
  });

  async function marks() {
    if (drawing.dataset.drawn !== "yes" || element.clientWidth === 0) return;
    const map = await mapOf(name);
    put(ring, map, marked.film === filmNow() ? map.cellOf(marked.trial) : null);
    put(cursor, map, document.activeElement === element ? at : null);
  }

  function replay(trial) {
    if (trial < 0) return;
    document.dispatchEvent(new CustomEvent("replay", { detail: { film: filmNow(), trial, from: element } }));
  }

  element.addEventListener("click", async (event) => {
    const map = await mapOf(name);
    const box = element.getBoundingClientRect();
    const [x, y] = [event.clientX - box.left, event.clientY - box.top];
    for (const speed of map.speeds) {
      for (const turn of map.turns) {
        const cell = map.boxOf(speed, turn);
        if (x >= cell.left && x < cell.left + cell.width && y >= cell.top && y < cell.top + cell.height) {
          at = [speed, turn];
          replay(map.trialAt(speed, turn));
        }
      }
    }
  });

  element.addEventListener("keydown", async (event) => {
    const ways = { ArrowLeft: [0, -1], ArrowRight: [0, 1], ArrowUp: [-1, 0], ArrowDown: [1, 0] };
    if (event.key !== "Enter" && !ways[event.key]) return;
    event.preventDefault();
    const map = await mapOf(name);
    if (event.key === "Enter") {
      if (at) replay(map.trialAt(...at));
      return;
    }
    const clamped = (value, length) => Math.min(Math.max(value, 0), length - 1);
    const [down, right] = ways[event.key];
    at = [map.speeds[clamped(map.speeds.indexOf(at[0]) + down, map.speeds.length)],
      map.turns[clamped(map.turns.indexOf(at[1]) + right, map.turns.length)]];
    marks();
    const index = map.trialAt(...at);
    const told = page.films[filmNow()].trials.find((each) => each.index === index);
    said.textContent = told ? `${told.label}: ${told.away.toFixed(2)} m off` : "";
  });

  element.addEventListener("focus", async () => {
    const map = await mapOf(name);
    if (at === null) {
      const first = marked.film === filmNow() ? map.cellOf(marked.trial) : null;
      at = first ?? [map.speeds[0], map.turns[0]];
    }
    marks();
  });
  element.addEventListener("blur", marks);
  document.addEventListener("replayed", marks);
  new ResizeObserver(marks).observe(element);
}

for (const element of document.querySelectorAll("[data-film].map")) trialMap(element);
