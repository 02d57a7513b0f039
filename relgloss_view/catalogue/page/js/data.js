// The rows: columns as arrays, thumbnails that are decoded when they are asked for.

import { byId } from "../../../base/js/elements.js";

const table = JSON.parse(byId("rows").textContent);

/** name, label, unit, decimals and kind ("number" or "text") of each column. */
export const COLUMNS = table.columns;
export const COUNT = table.count;
export const COLUMN = new Map(COLUMNS.map((column) => [column.name, column]));
export const MISSING = "\u2013";

/** Values of a column by row; numbers are NaN where they are missing. */
const arrays = new Map(COLUMNS.map(({ name, kind }) => {
  const values = table.values[name] ?? new Array(COUNT).fill(null); // no row has a value
  return [name, kind === "number" ? Float64Array.from(values, (v) => (v === null ? NaN : v)) : values];
}));

export function valuesOf(name) {
  return arrays.get(name);
}

const FACTS = "facts", later = {};

/** Facts that are read when an item is opened; their block ends the page. */
function further(name) {
  if (!later.read && byId(FACTS)) later.read = JSON.parse(byId(FACTS).textContent);
  return later.read?.[name];
}

/** A fact of a row that is no column: "ratio_cut", "warned"; "link", "proof", "command", "warnings" of an opened item. */
export function fact(name, row) {
  return (table.marked[name] ?? further(name))?.[row] ?? "";
}

/** A value as people read it, without its unit. */
export function words(name, row) {
  const { kind, decimals } = COLUMN.get(name), value = arrays.get(name)[row];
  if (kind !== "number") return value === null || value === "" ? MISSING : String(value);
  return Number.isNaN(value) ? MISSING : value.toFixed(decimals);
}

/** An error as people read it: rounded up, so that it is never 0. */
function roundedUp(error, decimals) {
  const step = 10 ** -decimals;
  return (step * Math.max(1, Math.ceil(error / step - 1e-9))).toFixed(decimals);
}

/** A value with its standard error and unit. */
export function wholeWords(name, row) {
  const { unit, decimals } = COLUMN.get(name), errors = further("errors")?.[name];
  const text = words(name, row);
  if (text === MISSING) return text;
  const error = errors && errors[row] !== null ? ` \u00b1 ${roundedUp(errors[row], decimals)}` : "";
  return `${text}${error}${unit ? ` ${unit}` : ""}`;
}

export function labOf(row) {
  return ["L_star", "a_star", "b_star"].map((name) => arrays.get(name)[row]);
}

const held = [];

/** The address of a row's thumbnail; "" where it has none, null where its part is still to come. */
export function pictureOf(row) {
  const part = Math.floor(row / table.part);
  if (!held[part]) {
    const block = byId(`pictures-${part}`);
    if (!block) return null;
    held[part] = JSON.parse(block.textContent);
    block.remove();
  }
  const text = held[part][row - part * table.part];
  return text ? `data:image/webp;base64,${text}` : "";
}
