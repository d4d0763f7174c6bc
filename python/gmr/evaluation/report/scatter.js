"use strict";
/* The coverage scatter: the clips chosen stand out, and the nearest point tells its clip and time. */

function coverageScatter(select) {
  const name = "coverage_scatter";
  const table = page.figures[name].tables.windows;
  const clips = columnsOf(table).clip;

  function highlighted() {
    if (select.value === "") return null;
    const [kind, number] = select.value.split(":");
    return new Set(kind === "clip" ? [page.clips[number]] : page.clipGroups[number]);
  }

  select.addEventListener("change", async () => {
    const view = await chart(name);
    const chosen = highlighted();
    const rows = chosen === null ? [] : rowsOf(table).filter((_, row) => chosen.has(clips[row]));
    view.signal("dimmed", chosen !== null).data("chosen", rows);
    await view.runAsync();
    document.getElementById("chosen-count").textContent =
      chosen === null ? "" : `${rows.length.toLocaleString("en")} of ${clips.length.toLocaleString("en")} points`;
  });

  whenDrawn(name, (view) => {
    const { speed, turn_rate_deg: turn, time } = columnsOf(table);
    const reach = 18;

    function nearest(event) {
      const box = view.container().querySelector("canvas").getBoundingClientRect();
      const left = view.origin()[0] + view.padding().left, top = view.origin()[1] + view.padding().top;
      const x = view.scale("x"), y = view.scale("y");
      const chosen = highlighted();
      let best = -1, least = reach * reach;
      for (let row = 0; row < clips.length; row += 1) {
        const dx = x(turn[row]) + left - (event.clientX - box.left);
        const dy = y(speed[row]) + top - (event.clientY - box.top);
        const distance = dx * dx + dy * dy;
        if (distance < least && (chosen === null || chosen.has(clips[row]))) {
          best = row;
          least = distance;
        }
      }
      return best;
    }

    function tell(event) {
      const row = nearest(event);
      view.tooltip()(null, event, null, row < 0 ? null : {
        Clip: clips[row],
        "At second": time[row].toFixed(2),
        "Speed, m/s": speed[row].toFixed(2),
        "Turn rate, deg/s": turn[row].toFixed(0),
      });
    }

    const canvas = view.container();
    canvas.addEventListener("pointermove", tell);
    canvas.addEventListener("pointerdown", tell);
    canvas.addEventListener("pointerleave", (event) => view.tooltip()(null, event, null, null));
  });
}

const clipSelect = document.getElementById("clip-select");
if (clipSelect) coverageScatter(clipSelect);
