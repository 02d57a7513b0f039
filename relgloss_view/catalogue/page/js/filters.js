// What is asked for, which rows meet it, and how it is written in the address.

import { COLUMN, COLUMNS, COUNT, labOf, valuesOf } from "./data.js";
import { deltaE2000 } from "./difference.js";

export const RANGES = ["gloss_20", "gloss_60", "gloss_75", "gloss_85", "haze", "s_deg_1",
  "gloss_ratio", "L_star", "a_star", "b_star"];
export const CHOICES = ["quality", "kind", "marks", "is_ratio_kept"];
export const SIZES = [64, 96, 128, 160, 192, 256];
export const MOST_PICKED = 6;

export function unasked() {
  return {
    text: "", ranges: {}, choices: {}, lab: null, within: 3, sort: "rank", down: false,
    view: "grid", size: 128, picked: [],
  };
}

/** Whether there is a filter or an order to clear. */
export function isAsked({ text, ranges, choices, lab, sort, down }) {
  return Boolean(text || lab || down) || sort !== "rank" || [ranges, choices].some((one) => Object.keys(one).length > 0);
}

/** The words of a choice's values, a set a row: marks are a list in one text. */
export function namesIn(name, value) {
  if (name === "marks") return value ? value.split(",").map((one) => one.trim()) : [""];
  return [value ?? ""];
}

let lowered = null;

/** The texts of each row that words are looked for in. */
function searched() {
  lowered ??= Array.from({ length: COUNT }, (_, row) => ["name", "path", "source", "model"]
    .map((name) => valuesOf(name)[row] ?? "").join("\n").toLocaleLowerCase());
  return lowered;
}

const distances = new Float64Array(COUNT);
let distancesTo = "";

/** dE2000 of each row to a colour; NaN where a row has none. Valid until it is asked again. */
export function distancesOf(lab) {
  if (distancesTo !== lab.join()) {
    for (let row = 0; row < COUNT; row++) distances[row] = deltaE2000(lab, labOf(row));
    distancesTo = lab.join();
  }
  return distances;
}

/** The rows that meet what is asked, in their order. */
export function found(asked) {
  const wanted = asked.text.toLocaleLowerCase().split(/\s+/).filter(Boolean);
  const ranges = Object.entries(asked.ranges).map(([name, [low, high]]) => [valuesOf(name), low, high]);
  const choices = Object.entries(asked.choices).map(([name, names]) => [name, valuesOf(name), names]);
  const far = asked.lab ? distancesOf(asked.lab) : null;
  const rows = [], texts = wanted.length ? searched() : [];
  next: for (let row = 0; row < COUNT; row++) {
    for (const [values, low, high] of ranges) {
      if (!(values[row] >= low && values[row] <= high)) continue next;
    }
    if (far && !(far[row] <= asked.within)) continue;
    for (const [name, values, names] of choices) {
      if (!namesIn(name, values[row]).some((one) => names.includes(one))) continue next;
    }
    for (const word of wanted) if (!texts[row].includes(word)) continue next;
    rows.push(row);
  }
  return sorted(rows, asked, far);
}

/** Missing values come last, whichever way the others are sorted. */
function sorted(rows, { sort, down }, far) {
  const sign = down ? -1 : 1;
  if (sort === "rank" || (sort === "distance" && !far)) return down ? rows.reverse() : rows;
  const values = sort === "distance" ? far : valuesOf(sort);
  if (sort !== "distance" && COLUMN.get(sort).kind !== "number") {
    const order = new Intl.Collator("en", { numeric: true }).compare;
    return rows.sort((p, q) => (!values[p] - !values[q]) || sign * order(values[p] ?? "", values[q] ?? "") || p - q);
  }
  return rows.sort((p, q) => (Number.isNaN(values[p]) - Number.isNaN(values[q]))
    || sign * (values[p] - values[q]) || p - q);
}

/** What is asked, as the part of an address after #. */
export function asFragment(asked) {
  const plain = unasked(), words = new URLSearchParams();
  if (asked.text) words.set("text", asked.text);
  for (const [name, [low, high]] of Object.entries(asked.ranges)) words.set(name, `${low}..${high}`);
  for (const [name, names] of Object.entries(asked.choices)) words.set(name, names.join("|"));
  if (asked.lab) words.set("lab", asked.lab.join());
  if (asked.lab && asked.within !== plain.within) words.set("within", asked.within);
  for (const name of ["sort", "view", "size"]) if (asked[name] !== plain[name]) words.set(name, asked[name]);
  if (asked.down) words.set("down", "1");
  if (asked.picked.length) words.set("picked", asked.picked.join());
  return words.toString();
}

/** The way back. An address is anyone's: what is no number, column or row in it is left out. */
export function ofFragment(text) {
  const asked = unasked(), words = new URLSearchParams(text);
  const numbers = (word, count) => {
    const parts = word.split(",").map((one) => (one.trim() === "" ? NaN : Number(one)));
    return parts.length === count && parts.every(Number.isFinite) ? parts : null;
  };
  asked.text = (words.get("text") ?? "").slice(0, 200);
  for (const name of RANGES) {
    const pair = numbers((words.get(name) ?? "").replace("..", ","), 2);
    if (pair) asked.ranges[name] = pair;
  }
  for (const name of CHOICES) {
    if (words.has(name)) asked.choices[name] = words.get(name).slice(0, 500).split("|");
  }
  asked.lab = numbers(words.get("lab") ?? "", 3);
  const within = numbers(words.get("within") ?? "", 1);
  if (within && within[0] >= 0) [asked.within] = within;
  const sort = words.get("sort");
  if (sort === "distance" || COLUMNS.some(({ name }) => name === sort)) asked.sort = sort;
  asked.down = words.get("down") === "1";
  if (words.get("view") === "table") asked.view = "table";
  if (SIZES.includes(Number(words.get("size")))) asked.size = Number(words.get("size"));
  const rows = (words.get("picked") ?? "").split(",").filter((one) => /^\d{1,7}$/.test(one)).map(Number);
  asked.picked = [...new Set(rows)].filter((row) => row < COUNT).slice(0, MOST_PICKED);
  return asked;
}
