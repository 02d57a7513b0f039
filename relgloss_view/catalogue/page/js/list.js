// The hits as a grid of pictures or as a table: only the lines in view are elements.

import { COLUMNS, MISSING, fact, pictureOf, words } from "./data.js";
import { byId, make, say } from "./dom.js";

const BEYOND_PX = 600; // drawn above and below what is in view
const CAPTION_PX = 62, GAP_PX = 8, TABLE_LINE_PX = 56, MOST_PRINTED = 2000;

export class List {
  /** acts: {open(row), pick(row, on), sort(name)}; each list has one place in the page. */
  constructor(acts) {
    this.acts = acts;
    this.place = byId("list");
    this.rows = [];
    this.at = 0; // index of the hit that the keys move from
    this.asked = null;
    this.printing = false;
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

  /** Show hits. far: dE2000 by row, or null. */
  show(rows, asked, far) {
    const anew = !this.asked || this.asked.view !== asked.view;
    Object.assign(this, { rows, asked, far });
    this.at = Math.min(this.at, Math.max(rows.length - 1, 0));
    if (anew) this.frame();
    this.draw();
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
    if (this.asked.view === "grid") {
      this.body = make("div", { class: "grid", role: "list", "aria-label": say("hits") });
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
    this.body = make("tbody");
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

  draw() {
    const { across, line, rows } = this, lines = Math.ceil(rows.length / across);
    const top = this.place.scrollTop, high = this.place.clientHeight;
    let first = Math.max(0, Math.floor((top - BEYOND_PX) / line));
    let last = Math.min(lines, Math.ceil((top + high + BEYOND_PX) / line));
    if (this.printing) [first, last] = [0, Math.min(lines, Math.ceil(MOST_PRINTED / across))];
    const focused = this.place.contains(document.activeElement) ? document.activeElement : null;
    const kind = focused?.dataset.act, row = Number(focused?.dataset.row);
    const elements = [];
    for (let index = first * across; index < Math.min(rows.length, last * across); index++) {
      elements.push(this.asked.view === "table" ? this.tableLine(index) : this.tile(index));
    }
    const [above, below] = [first * line, Math.max(0, lines - last) * line].map((px) => this.space(px));
    if (!rows.length) elements.push(this.nothing());
    this.body.replaceChildren(above, ...elements, below);
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
    if (kind) this.body.querySelector(`[data-act="${kind}"][data-row="${row}"]`)?.focus({ preventScroll: true });
  }

  nothing() {
    const text = make("p", { class: "none", text: say("none") });
    return this.asked.view === "grid" ? text : make("tr", {}, make("td", { colspan: this.columns.length + 2 }, text));
  }

  space(px) {
    const inner = this.asked.view === "grid"
      ? make("div", { class: "space", "aria-hidden": "true" }) : make("tr", { class: "space", "aria-hidden": "true" });
    inner.style.height = `${px}px`;
    return inner;
  }

  picture(row) {
    const source = pictureOf(row);
    if (!source) return make("span", { class: "no-picture", text: say("no-picture") });
    return make("img", { src: source, alt: "", width: 128, height: 128, decoding: "async" });
  }

  opener(index, ...children) {
    const row = this.rows[index];
    return make("button", {
      type: "button", class: "open", "data-act": "open", "data-row": row,
      tabindex: index === this.at ? 0 : -1,
      on: {
        click: () => this.acts.open(row),
        focus: () => {
          this.place.querySelector('.open[tabindex="0"]')?.setAttribute("tabindex", -1);
          this.place.querySelector(`.open[data-row="${row}"]`)?.setAttribute("tabindex", 0);
          this.at = index;
        },
      },
    }, ...children);
  }

  picker(row) {
    const box = make("input", {
      type: "checkbox", "data-act": "pick", "data-row": row, tabindex: -1,
      "aria-label": say("compare.this", { name: words("name", row) }),
      on: { change: () => this.acts.pick(row, box.checked) },
    });
    box.checked = this.asked.picked.includes(row);
    return make("label", { class: "pick" }, box);
  }

  marks(row) {
    const texts = [];
    if (fact("ratio_cut", row)) texts.push(say("ratio-cut.short"));
    if (fact("warnings", row).length) texts.push(say("warnings.short"));
    return texts.length ? make("span", { class: "marks", text: texts.join(" \u00b7 ") }) : null;
  }

  tile(index) {
    const row = this.rows[index];
    const number = ["rank", "name", "path"].includes(this.asked.sort) ? "gloss_60" : this.asked.sort;
    const label = number === "distance" ? say("distance.short") : COLUMNS.find(({ name }) => name === number).label;
    return make("div", {
      class: "tile", role: "listitem", "aria-posinset": index + 1, "aria-setsize": this.rows.length,
    }, this.opener(index, this.picture(row), make("bdi", { class: "name", text: words("name", row) }),
      make("span", { class: "number", text: `${label} ${this.value(number, row)}` }), this.marks(row)),
    this.picker(row));
  }

  value(name, row) {
    if (name !== "distance") return words(name, row);
    return this.far && !Number.isNaN(this.far[row]) ? this.far[row].toFixed(1) : MISSING;
  }

  tableLine(index) {
    const row = this.rows[index];
    const cells = this.columns.map(({ name, kind }) => (name === "name"
      ? make("th", { scope: "row" }, this.opener(index, make("bdi", { text: words(name, row) }), this.marks(row)))
      : make("td", { class: kind }, make("bdi", { text: words(name, row) }))));
    return make("tr", { "aria-rowindex": index + 2 },
      make("td", { class: "picked-in" }, this.picker(row)),
      make("td", { class: "picture" }, this.picture(row)), ...cells);
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
