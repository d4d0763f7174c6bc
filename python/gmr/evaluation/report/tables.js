"use strict";
/* Tables sort by their headers, and are saved as CSV, made here in the browser. */

for (const header of document.querySelectorAll("th button")) {
  header.addEventListener("click", () => {
    const cell = header.closest("th");
    const body = header.closest("table").tBodies[0];
    const text = cell.classList.contains("text");
    const before = cell.getAttribute("aria-sort");
    const order = before === null ? (text ? "ascending" : "descending")
      : before === "ascending" ? "descending" : "ascending";
    for (const other of cell.parentElement.children) other.removeAttribute("aria-sort");
    cell.setAttribute("aria-sort", order);
    const sign = order === "descending" ? -1 : 1;
    const value = (row) => row.children[cell.cellIndex].dataset.value;
    const number = (row) => (value(row) === "" ? -Infinity : Number(value(row)));
    const compare = text
      ? (a, b) => value(a).localeCompare(value(b), "en", { numeric: true })
      : (a, b) => number(a) - number(b) || 0;
    const rows = [...body.rows].sort((a, b) => sign * compare(a, b));
    body.append(...rows);
  });
}

function csv(name) {
  const columns = columnsOf(name);
  const quoted = (value) => (/[",\r\n]/.test(value) ? `"${value.replaceAll('"', '""')}"` : value);
  const cell = (value) => (typeof value === "string" ? quoted(value) : Number.isNaN(value) ? "" : String(value));
  const lines = [Object.keys(columns).map(quoted).join(",")];
  for (let row = 0; row < page.tables[name].length; row += 1) {
    lines.push(Object.values(columns).map((values) => cell(values[row])).join(","));
  }
  return lines.join("\n") + "\n";
}

for (const button of document.querySelectorAll("[data-save]")) {
  button.addEventListener("click", () => {
    const link = document.createElement("a");
    link.href = URL.createObjectURL(new Blob([csv(button.dataset.save)], { type: "text/csv" }));
    link.download = `${button.dataset.save}.csv`;
    link.click();
    /* The browser reads the data after the click; freeing it at once would save nothing. */
    setTimeout(() => URL.revokeObjectURL(link.href), 10000);
  });
}
