"use strict";
/* The page's data: tables of packed columns, unpacked when first asked for. */

const page = JSON.parse(document.getElementById("data").textContent);

const ARRAYS = {
  u1: Uint8Array, i2: Int16Array, u2: Uint16Array, i4: Int32Array, f4: Float32Array, f8: Float64Array,
};

function unpacked(packed) {
  const bytes = Uint8Array.from(atob(packed.bytes), (letter) => letter.charCodeAt(0));
  const values = new ARRAYS[packed.type](bytes.buffer);
  if (packed.step === undefined) return values;
  return Float64Array.from(values, (value) => (value === 65535 ? NaN : packed.low + value * packed.step));
}

const columnsOf = (() => {
  const known = new Map();
  return (name) => {
    if (!known.has(name)) {
      const columns = {};
      for (const [key, packed] of Object.entries(page.tables[name].columns)) {
        const values = unpacked(packed);
        columns[key] = packed.labels ? Array.from(values, (number) => packed.labels[number]) : values;
      }
      known.set(name, columns);
    }
    return known.get(name);
  };
})();

function rowsOf(name) {
  const columns = Object.entries(columnsOf(name));
  return Array.from({ length: page.tables[name].length }, (_, row) =>
    Object.fromEntries(columns.map(([key, values]) => [key, values[row]])));
}
