// What is asked, by hand or in the address, and what is shown of it.

import { COLUMNS, COUNT, wholeWords, words, valuesOf } from "./data.js";
import { MOST_PICKED, SIZES, asFragment, distancesOf, found, isAsked, ofFragment, unasked } from "./filters.js";
import { byId, make } from "../../../base/js/elements.js";
import { say } from "../../../base/js/sentences.js";
import { announce, button, copyButton } from "./dom.js";
import { openItem, showTray } from "./details.js";
import { List } from "./list.js";
import { mountPanel } from "./panel.js";

let asked = ofFragment(location.hash.slice(1)), rows = [], waiting = false, spoken = 0, noted = 0;
const acts = {
  open: (row) => openItem(row, { near: (lab) => change({ lab: lab.map((v) => Number(v.toFixed(2))), sort: "distance", down: false }),
    pick: (one) => acts.pick(one, true) }),
  pick(row, on) {
    const rest = asked.picked.filter((one) => one !== row);
    if (on && rest.length >= MOST_PICKED) announce(say("compare.most", { count: MOST_PICKED }));
    change({ picked: on ? [...rest, row].slice(0, MOST_PICKED) : rest });
  },
  clear: () => change({ picked: [] }),
  sort: (name) => change({ sort: name, down: asked.sort === name ? !asked.down : false }),
};

/** Text that a spreadsheet would take for a formula begins with an apostrophe. */
function cell(value) {
  const text = typeof value === "number" ? String(value) : value ?? "";
  const safe = typeof value === "string" && /^[=+\-@\t\r]/.test(text) ? `'${text}` : text;
  return /[",\n\r]/.test(safe) ? `"${safe.replaceAll('"', '""')}"` : safe;
}

function asCsv() {
  const head = COLUMNS.map(({ name }) => name).join();
  const lines = rows.map((row) => COLUMNS.map(({ name }) => {
    const value = valuesOf(name)[row];
    return Number.isNaN(value) ? "" : cell(value);
  }).join());
  return `${[head, ...lines].join("\r\n")}\r\n`;
}

const sortBy = make("select", { class: "field", id: "sort", "aria-label": say("sort"), on: { change: () => change({ sort: sortBy.value }) } },
  ...[...COLUMNS.filter(({ sorted }) => sorted).map(({ name, label }) => [name, label]), ["distance", say("distance")]]
    .map(([value, text]) => make("option", { value, text })));
const way = button("", () => change({ down: !asked.down }), { id: "way" });
const views = Object.fromEntries(["grid", "table"].map((view) =>
  [view, button(say(`view.${view}`), () => change({ view }), { class: "segment", "data-view": view })]));
const size = make("input", {
  type: "range", min: 0, max: SIZES.length - 1, step: 1, "aria-label": say("size"),
  on: { input: () => change({ size: SIZES[size.value] }) },
});
byId("tools").replaceChildren(make("output", { id: "count" }), make("label", { class: "row" }, make("span", { text: say("sort") }), sortBy), way,
  make("div", { class: "segments", role: "group", "aria-label": say("view") }, views.grid, views.table),
  make("label", { class: "row size" }, make("span", { text: say("size") }), size),
  copyButton(say("csv"), asCsv), button(say("clear"), () => {
    const { view, size: kept, picked } = asked;
    asked = { ...unasked(), view, size: kept, picked };
    change({});
  }, { id: "clear" }));

byId("static")?.remove();
document.documentElement.dataset.live = "yes";
const list = new List(acts);
const showPanel = mountPanel(() => asked, change);
const fold = byId("fold");
// Beside the hits where there is room; above them they would take the hits' place.
const wide = matchMedia("(min-width: 900px)");
fold.open = wide.matches;
wide.addEventListener("change", () => { fold.open = wide.matches; });

function change(part) {
  if (["text", "ranges", "choices", "lab", "sort", "down"].some((key) => key in part)) list.place.scrollTop = 0;
  asked = { ...asked, ...part };
  if (waiting) return;
  waiting = true;
  requestAnimationFrame(show);
}

function show() {
  waiting = false;
  rows = found(asked);
  list.show(rows, asked, asked.lab ? distancesOf(asked.lab) : null);
  showPanel(asked);
  showTray(asked.picked, acts);
  const count = say(COUNT === 1 ? "count.one" : "count", { hits: rows.length, all: COUNT });
  byId("count").textContent = count;
  sortBy.value = asked.sort;
  way.textContent = say(asked.down ? "way.down" : "way.up");
  for (const [view, element] of Object.entries(views)) element.setAttribute("aria-pressed", String(view === asked.view));
  size.value = SIZES.indexOf(asked.size);
  size.setAttribute("aria-valuetext", say("size.px", { size: asked.size }));
  byId("tools").dataset.view = asked.view;
  document.documentElement.toggleAttribute("data-asked", isAsked(asked));
  clearTimeout(spoken);
  spoken = setTimeout(() => announce(count), 700);
  clearTimeout(noted);
  noted = setTimeout(() => {
    const words = asFragment(asked);
    if (words !== location.hash.slice(1)) history.replaceState(null, "", `#${words}`);
  }, 200);
}

addEventListener("hashchange", () => {
  asked = ofFragment(location.hash.slice(1));
  show();
});
// Pictures that come after the script are there by then.
document.addEventListener("DOMContentLoaded", () => list.anew());
window.relgloss = {
  ready: new Promise((done) => { addEventListener("load", () => done()); }),
  asked: () => asked, rows: () => rows, csv: asCsv, words: (name, row) => [words(name, row), wholeWords(name, row)],
};
show();
