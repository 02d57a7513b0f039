// The hits as a grid of pictures or as a table: only the lines in view are elements.

import { COLUMN, COLUMNS, COUNT, MISSING, fact, pictureOf, words } from "./data.js";
import { byId, make } from "../../../base/js/elements.js";
import { say } from "../../../base/js/sentences.js";

const BEYOND_PX = 600; // drawn above and below what is in view, once there is time; one line until then
const REST_MS = 120; // after which there is
const CAPTION_PX = 80, GAP_PX = 8, TABLE_LINE_PX = 56, MOST_PRINTED = 2000;
const MOST_KEPT = 600; // elements that are kept, so that a picture is decoded once

export class List {
  /** acts: {open(row), pick(row, on), sort(name)}; each list has one place in the page. */
  constructor(acts) {
    this.acts = acts;
    this.place = byId("list");
    this.rows = [];
    this.at = 0; // index of the hit that the keys move from
    this.asked = null;
    this.printing = false;
    this.made = new Map(); // elements by row
    this.listen();
    this.place.addEventListener("scroll", () => this.later(), { passive: true });
    this.place.addEventListener("keydown", (event) => this.key(event));
    new ResizeObserver(() => this.later()).observe(this.place);
    for (const [event, on] of [["beforeprint", true], ["afterprint", false]]) {
      addEventListener(event, () => {
        this.printing = on;
        this.draw();
      });
    }
  }

  /** One listener for all hits: their elements are used again for other places in the list. */
  listen() {
    this.place.addEventListener("click", ({ target }) => {
      const opener = target.closest?.(".open");
      if (opener) this.acts.open(Number(opener.dataset.row));
    });
    this.place.addEventListener("change", ({ target }) => {
      if (target.dataset.act === "pick") this.acts.pick(Number(target.dataset.row), target.checked);
    });
    this.place.addEventListener("focusin", ({ target }) => {
      const index = target.classList.contains("open") ? this.rows.indexOf(Number(target.dataset.row)) : -1;
      if (index < 0) return;
      this.at = index;
      for (const other of this.body.querySelectorAll('.open[tabindex="0"]')) other.tabIndex = -1;
      target.tabIndex = 0;
    });
  }

  /** Show hits. far: dE2000 by row, or null. */
  show(rows, asked, far) {
    const anew = !this.asked || this.asked.view !== asked.view;
    Object.assign(this, { rows, asked, far });
    this.at = Math.min(this.at, Math.max(rows.length - 1, 0));
    if (anew) this.frame();
    this.draw(this.line);
    clearTimeout(this.rest);
    this.rest = setTimeout(() => this.draw(), REST_MS);
  }

  /** Pictures have come that were not there. */
  anew() {
    this.made.clear();
    this.later();
  }

  later() {
    if (this.waiting) return;
    this.waiting = true;
    requestAnimationFrame(() => {
      this.waiting = false;
      if (this.asked) this.draw();
    });
  }

  get columns() {
    return COLUMNS.filter(({ shown }) => shown);
  }

  frame() {
    this.made.clear();
    [this.above, this.below] = [this.space(), this.space()];
    if (this.asked.view === "grid") {
      this.body = make("div", { class: "grid", role: "list", "aria-label": say("hits") });
      this.body.append(this.above, this.below);
      this.place.replaceChildren(this.body);
      return;
    }
    this.heads = new Map();
    const heads = this.columns.map(({ name, label, unit, kind }) => {
      const head = make("th", { scope: "col", class: kind }, make("button", {
        type: "button", class: "head", text: label, title: unit || null,
        on: { click: () => this.acts.sort(name) },
      }));
      this.heads.set(name, head);
      return head;
    });
    this.body = make("tbody", {}, this.above, this.below);
    this.table = make("table", { class: "rows", "aria-label": say("hits") },
      make("thead", {}, make("tr", {}, make("th", { scope: "col", class: "picked-in" },
        make("span", { class: "unseen", text: say("compare") })), make("th", { scope: "col", class: "picture" },
        make("span", { class: "unseen", text: say("picture") })), ...heads)), this.body);
    this.place.replaceChildren(this.table);
  }

  get across() {
    if (this.asked.view === "table") return 1;
    return Math.max(1, Math.floor((this.place.clientWidth - GAP_PX) / (this.asked.size + 2 * GAP_PX)));
  }

  get line() {
    return this.asked.view === "table" ? TABLE_LINE_PX : this.asked.size + CAPTION_PX + GAP_PX;
  }

  /** Draws the lines in view, and those that are up to `beyond` pixels away. */
  draw(beyond = BEYOND_PX) {
    const { across, line, rows } = this, lines = Math.ceil(rows.length / across);
    const high = this.place.clientHeight;
    // Fewer lines than there were: the place that was scrolled to may be no more.
    const top = Math.min(this.place.scrollTop, Math.max(0, lines * line - high));
    let first = Math.max(0, Math.floor((top - beyond) / line));
    let last = Math.min(lines, Math.ceil((top + high + beyond) / line));
    if (this.printing) [first, last] = [0, Math.min(lines, Math.ceil(MOST_PRINTED / across))];
    const focused = this.place.contains(document.activeElement) ? document.activeElement : null;
    const kind = focused?.dataset.act, row = Number(focused?.dataset.row);
    const elements = [];
    for (let index = first * across; index < Math.min(rows.length, last * across); index++) elements.push(this.element(index));
    if (!rows.length) elements.push(this.nothing());
    this.above.style.height = `${first * line}px`;
    this.below.style.height = `${Math.max(0, lines - last) * line}px`;
    this.arrange(elements);
    if (this.asked.view === "grid") {
      this.body.style.setProperty("--size", `${this.asked.size}px`);
      this.body.style.setProperty("--across", across);
    } else {
      this.table.setAttribute("aria-rowcount", rows.length + 1);
      for (const [name, head] of this.heads) {
        const way = this.asked.down ? "descending" : "ascending";
        head.setAttribute("aria-sort", this.asked.sort === name ? way : "none");
      }
    }
    if (kind && document.activeElement !== focused) {
      this.body.querySelector(`[data-act="${kind}"][data-row="${row}"]`)?.focus({ preventScroll: true });
    }
  }

  /** Puts elements between the two spaces; those that are in their places stay untouched. */
  arrange(elements) {
    const wanted = new Set(elements);
    for (const one of [...this.body.children]) {
      if (one !== this.above && one !== this.below && !wanted.has(one)) one.remove();
    }
    let next = this.above.nextSibling;
    for (const one of elements) {
      if (one === next) next = next.nextSibling;
      else this.body.insertBefore(one, next);
    }
    if (this.made.size > MOST_KEPT) for (const [row, { element }] of this.made) if (!wanted.has(element)) this.made.delete(row);
  }

  /** The element of the hit at an index: the one that the row has, brought up to date. */
  element(index) {
    const row = this.rows[index], table = this.asked.view === "table";
    let one = this.made.get(row);
    if (!one) {
      one = table ? this.tableLine(row) : this.tile(row);
      this.made.set(row, one);
    }
    one.opener.tabIndex = index === this.at ? 0 : -1;
    one.box.checked = this.asked.picked.includes(row);
    if (table) one.element.setAttribute("aria-rowindex", index + 2);
    else {
      one.element.setAttribute("aria-posinset", index + 1);
      one.element.setAttribute("aria-setsize", this.rows.length);
      const text = this.caption(row);
      if (one.number.textContent !== text) one.number.textContent = text;
    }
    return one.element;
  }

  nothing() {
    const empty = byId("failed") ? "none.read" : "none.at.all"; // of a page without samples
    const text = make("p", { class: "none", text: say(COUNT ? "none" : empty) });
    return this.asked.view === "grid" ? text : make("tr", {}, make("td", { colspan: this.columns.length + 2 }, text));
  }

  space() {
    return this.asked.view === "grid"
      ? make("div", { class: "space", "aria-hidden": "true" }) : make("tr", { class: "space", "aria-hidden": "true" });
  }

  picture(row) {
    const source = pictureOf(row);
    if (source === null) return make("span", { class: "no-picture" });
    if (!source) return make("span", { class: "no-picture", text: say("no-picture") });
    return make("img", { src: source, alt: "", width: 128, height: 128 });
  }

  opener(row, ...children) {
    return make("button", { type: "button", class: "open", "data-act": "open", "data-row": row }, ...children);
  }

  picker(row) {
    return make("input", {
      type: "checkbox", "data-act": "pick", "data-row": row, tabindex: -1,
      "aria-label": say("compare.this", { name: words("name", row) }),
    });
  }

  marks(row) {
    const texts = [], quality = words("quality", row);
    if (![MISSING, "good"].includes(quality)) texts.push(quality);
    if (fact("ratio_cut", row)) texts.push(say("ratio-cut.short"));
    if (fact("warned", row) && [MISSING, "good"].includes(quality)) texts.push(say("warnings.short"));
    return texts.length ? make("span", { class: "marks", text: texts.join(" \u00b7 ") }) : null;
  }

  /** The number below a picture: the one that the hits are sorted by. */
  caption(row) {
    const number = ["rank", "name", "path"].includes(this.asked.sort) ? "gloss_60" : this.asked.sort;
    const label = number === "distance" ? say("distance.short") : COLUMN.get(number).label;
    const unit = number === "distance" ? "" : COLUMN.get(number).unit, value = this.value(number, row);
    return `${label} ${value}${unit && value !== MISSING ? ` ${unit}` : ""}`;
  }

  tile(row) {
    const number = make("span", { class: "number" }), box = this.picker(row);
    const name = words("name", row);
    const opener = this.opener(row, this.picture(row), make("bdi", { class: "name", text: name, title: name }), number, this.marks(row));
    return { opener, box, number, element: make("div", { class: "tile", role: "listitem" }, opener, make("label", { class: "pick" }, box)) };
  }

  value(name, row) {
    if (name !== "distance") return words(name, row);
    return this.far && !Number.isNaN(this.far[row]) ? this.far[row].toFixed(1) : MISSING;
  }

  tableLine(row) {
    const box = this.picker(row);
    const opener = this.opener(row, make("bdi", { text: words("name", row), title: words("name", row) }), this.marks(row));
    const cells = this.columns.map(({ name, kind }) => (name === "name" ? make("th", { scope: "row" }, opener)
      : make("td", { class: kind }, make("bdi", { text: words(name, row) }))));
    const element = make("tr", {}, make("td", { class: "picked-in" }, make("label", { class: "pick" }, box)),
      make("td", { class: "picture" }, this.picture(row)), ...cells);
    return { opener, box, element };
  }

  /** Arrows, Home, End and the page keys move among hits; C picks one to compare. */
  key(event) {
    if (event.ctrlKey || event.metaKey || event.altKey || !event.target.dataset.act) return;
    const { across } = this, page = Math.max(1, Math.floor(this.place.clientHeight / this.line)) * across;
    const steps = {
      ArrowRight: 1, ArrowLeft: -1, ArrowDown: across, ArrowUp: -across, PageDown: page, PageUp: -page,
      Home: -this.rows.length, End: this.rows.length,
    };
    const row = this.rows[this.at];
    if (event.key === "c" || event.key === "C") this.acts.pick(row, !this.asked.picked.includes(row));
    else if (event.key in steps) this.move(steps[event.key]);
    else return;
    event.preventDefault();
  }

  move(step) {
    const to = Math.min(Math.max(this.at + step, 0), this.rows.length - 1);
    const top = Math.floor(to / this.across) * this.line;
    const head = this.asked.view === "table" ? TABLE_LINE_PX : 0;
    if (top < this.place.scrollTop) this.place.scrollTop = top;
    const bottom = top + this.line + head - this.place.clientHeight;
    if (bottom > this.place.scrollTop) this.place.scrollTop = bottom;
    this.draw(); // which gives the focus back to where it was
    this.body.querySelector(`.open[data-row="${this.rows[to]}"]`)?.focus({ preventScroll: true });
  }
}
