// One item with all its numbers, and several beside each other.

import { COLUMNS, MISSING, fact, labOf, pictureOf, wholeWords, words } from "./data.js";
import { deltaE2000 } from "./difference.js";
import { byId, make } from "../../../base/js/elements.js";
import { say } from "../../../base/js/sentences.js";
import { button, copyButton } from "./dom.js";

function picture(row) {
  const source = pictureOf(row);
  const kept = fact("ratio_cut", row) ? make("p", { class: "cut", text: say("ratio-cut") }) : null;
  const image = source ? make("img", { src: source, alt: say("picture.of", { name: words("name", row) }), width: 256, height: 256 })
    : make("p", { class: "no-picture", text: say("no-picture") });
  return make("div", { class: "large" }, image, kept);
}

function links(row) {
  const list = make("p", { class: "links" });
  for (const [key, text] of [["proof", say("open.proof")], ["link", say("open.material")]]) {
    const address = fact(key, row);
    if (address) list.append(make("a", { href: address, text, rel: "noreferrer" }), " ");
  }
  const command = fact("command", row);
  const line = command ? make("div", { class: "command" }, make("p", { class: "quiet", text: say("command") }),
    make("code", { text: command }), copyButton(say("copy"), () => command)) : null;
  return [list, line];
}

/** Opens a window over the page; it goes with Escape, and the focus goes back. */
function openBox(...children) {
  const before = document.activeElement;
  const box = make("dialog", { class: "dialog" }, button(say("close"), () => box.close(), { class: "button close" }), ...children);
  box.addEventListener("close", () => {
    box.remove();
    before?.focus?.();
  });
  document.body.append(box);
  box.showModal();
  return box;
}

/** acts: {near(lab), pick(row)}. */
export function openItem(row, acts) {
  const facts = COLUMNS.filter(({ name }) => !["rank", "name"].includes(name) && words(name, row) !== MISSING).map(({ name, label }) =>
    make("div", {}, make("dt", { text: label }), make("dd", {}, make("bdi", { text: wholeWords(name, row) }))));
  const warnings = fact("warnings", row) || [];
  const near = labOf(row).every(Number.isFinite);
  const box = openBox(make("h2", { tabindex: -1, autofocus: true }, make("bdi", { text: words("name", row) })),
    make("div", { class: "item" }, picture(row), make("div", {},
      ...links(row),
      make("p", { class: "row" },
        button(say("pick"), () => { box.close(); acts.pick(row); }),
        near ? button(say("near"), () => { box.close(); acts.near(labOf(row)); }) : null),
      warnings.length ? make("ul", { class: "warnings", "aria-label": say("warnings") },
        ...warnings.map((text) => make("li", { text }))) : null,
      make("dl", { class: "facts" }, ...facts))));
  box.setAttribute("aria-label", words("name", row));
}

export function openComparison(rows) {
  const columns = COLUMNS.filter(({ kind, name }) => kind === "number" && name !== "rank"
    && rows.some((row) => words(name, row) !== MISSING));
  const line = (label, cells) => make("tr", {}, make("th", { scope: "row", text: label }),
    ...cells.map((text) => make("td", {}, make("bdi", { text }))));
  const first = labOf(rows[0]);
  const lines = columns.map(({ name, label }) => line(label, rows.map((row) => wholeWords(name, row))));
  lines.push(line(say("distance.first"), rows.map((row) => {
    const far = deltaE2000(first, labOf(row));
    return Number.isNaN(far) ? MISSING : far.toFixed(2);
  })));
  const heads = rows.map((row) => make("th", { scope: "col" }, picture(row), make("bdi", { text: words("name", row) })));
  const box = openBox(make("h2", { tabindex: -1, autofocus: true, text: say("compare") }), make("div", { class: "wide" },
    make("table", { class: "compared" }, make("thead", {}, make("tr", {}, make("td"), ...heads)),
      make("tbody", {}, ...lines))));
  box.setAttribute("aria-label", say("compare"));
}

let shown = null;

/** The tray of picked items. acts: {pick(row, on), clear()}. */
export function showTray(rows, acts) {
  if (shown === rows.join()) return;
  shown = rows.join();
  const tray = byId("tray");
  tray.hidden = rows.length === 0;
  tray.replaceChildren(...rows.map((row) => make("button", {
    type: "button", class: "picked", "aria-label": say("compare.not", { name: words("name", row) }),
    on: { click: () => acts.pick(row, false) },
  }, make("img", { src: pictureOf(row) || null, alt: "", width: 48, height: 48 }), make("bdi", { text: words("name", row) }))),
  button(say("compare.all", { count: rows.length }), () => openComparison(rows), { class: "button first" }),
  button(say("compare.clear"), () => acts.clear()));
}
