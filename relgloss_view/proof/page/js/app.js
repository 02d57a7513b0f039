// The state of the page, and the loop that draws when something has changed.

import { byId } from "../../../base/js/elements.js";
import { lifeSized } from "./hand.js";
import { blits, fitted, panes, roomFor } from "./layout.js";
import { atOneScale } from "./view.js";
import { say } from "../../../base/js/sentences.js";

const SLOW_MS = 33; // of a frame, beyond which a moving picture is drawn smaller
const LEAST_SHARE = 0.3; // of the full size, each way
const REST_MS = 160; // without a change until the picture is drawn in full
const LOST_MS = 4000; // that a lost context may take to come back
const PAPER_PX = 660; // of a printed page that is as narrow as paper is
const SAY_MS = 900; // until a change is read out

const same = (a, b) => JSON.stringify(a) === JSON.stringify(b);

/** The page's state. engine: of the proof, on the canvas. proof: the JSON that was sealed. */
export class App {
  constructor(engine, canvas, proof) {
    Object.assign(this, { engine, canvas, proof, room: roomFor(engine.drawing.sides) });
    this.index = proof.messages.length - 1;
    this.present = proof.messages[this.index].settings;
    this.kept = this.present; // what was saved last
    this.shown = { mode: "both", side: "test", share: 0.5, hand: "turn" };
    this.screen = null; // of screen.js, for a reply
    this.listeners = [];
    this.onRest = []; // called when a picture at rest is drawn
    this.waiting = [];
    this.dirty = true;
    this.share = 1;
    this.moved = -Infinity; // when something last moved
    this.drawn = null; // {settings, size, report}
    this.lost = false;
    this.life = null; // {devicePixel in mm, height of a picture, its angle} once life size was chosen
    this.asked = 0;
  }

  settings() { return this.present; }
  at() { return this.index; }
  sent() { return this.proof.messages[this.index].settings; }
  changed() { return !same(this.present, this.sent()); }
  unsaved() { return this.changed() && !same(this.present, this.kept); }
  saved() { this.kept = this.present; }
  report() { return this.drawn?.report; }
  mode() { return this.shown.hand; }

  /** Take settings; live while a hand moves. */
  set(settings, live = false) {
    if (same(settings, this.present)) return;
    this.present = settings;
    this.moved = live ? performance.now() : -Infinity;
    this.redraw();
    this.tell();
  }

  /** Show a message's settings. */
  lookAt(index) {
    this.index = index;
    this.moved = -Infinity;
    this.present = this.sent();
    this.redraw();
    this.tell();
    this.announce(byId("whose").textContent);
  }

  /** Change how the pictures are shown: mode, side, share of a wipe, hand. */
  show(change) {
    Object.assign(this.shown, change);
    this.redraw();
    this.tell();
  }

  /** Show one picture; if it is the only one already, the other. */
  flip() {
    const { mode, side } = this.shown;
    this.show({ mode: "flip", side: mode === "flip" && side === "test" ? "reference" : "test" });
    this.announce(say(`side.${this.shown.side}`));
  }

  onChange(act) { this.listeners.push(act); }
  tell() { this.listeners.forEach((act) => act()); }

  redraw() {
    this.dirty = true;
    if (this.asked === 0) this.asked = requestAnimationFrame(() => this.frame());
  }

  /** When the picture is at rest, drawn in full. */
  idle() {
    return new Promise((done) => {
      this.waiting.push(done);
      this.redraw();
    });
  }

  /** Read a text out once nothing has changed for a moment. */
  announce(text) {
    clearTimeout(this.saying);
    this.saying = setTimeout(() => { byId("live").textContent = text; }, SAY_MS);
  }

  frame() {
    const now = performance.now(), moving = now - this.moved < REST_MS;
    this.dirty = false;
    this.asked = 0;
    try {
      if (!this.lost) this.paint(moving);
    } catch (fault) {
      // A context may be lost in the middle of a frame; it is drawn again when it is back.
      if (!this.lost && !this.engine.lost) notice(say("state.failed"));
      console.error(fault);
      return;
    }
    if (this.dirty) this.redraw();
    else if (moving) setTimeout(() => this.redraw(), REST_MS);
    else if (!this.lost) this.waiting.splice(0).forEach((done) => done());
  }

  paint(moving) {
    const stage = this.canvas, ratio = window.devicePixelRatio;
    const [width, height] = [stage.clientWidth, stage.clientHeight];
    if (width < 2 || height < 2) return;
    const pixels = [Math.round(width * ratio), Math.round(height * ratio)];
    if (stage.width !== pixels[0] || stage.height !== pixels[1]) {
      [stage.width, stage.height] = pixels;
    }
    const { mode, side, share } = this.shown;
    this.panes = panes(mode, width, height, side, this.room);
    const { size, boxes } = fitted(this.panes, ratio);
    this.boxes = boxes;
    this.keepLifeSize();
    const part = moving ? this.share : 1;
    const drawn = size.map((count) => Math.max(16, Math.round(count * part)));
    const settings = this.present, begun = performance.now();
    const known = this.drawn;
    if (known === null || known.settings !== settings || known.moving !== moving
      || !same(known.size, drawn)) {
      const report = this.engine.draw(settings, drawn, { moving });
      this.drawn = { settings, size: drawn, report, moving };
    }
    this.engine.show(blits(mode, boxes, drawn, share));
    const took = performance.now() - begun;
    if (moving && took > SLOW_MS) {
      this.share = Math.max(LEAST_SHARE, part * Math.sqrt(SLOW_MS / took));
    }
    this.main("ready");
    this.tell();
    if (!moving) {
      this.describe();
      this.onRest.forEach((act) => act());
    }
  }

  main(state) { byId("main").dataset.state = state; }

  /** What the canvas shows, for those who hear it. */
  describe() {
    const { reference, test, eye, lamp } = this.present, { mode, side } = this.shown;
    const of = (setting, report) => say("canvas.side", {
      grain: setting.sigma_n_deg.toFixed(2),
      contrast: report?.c_max ? (setting.c / report.c_max).toFixed(2) : setting.c.toFixed(2),
    });
    this.canvas.setAttribute("aria-label", say(`canvas.${mode}`, {
      shown: say(`side.${side}`),
      reference: of(reference, this.report()?.reference), test: of(test, this.report()?.test),
      eye: Math.round(eye.azimuth_deg), height: Math.round(eye.elevation_deg),
      lamp: Math.round(lamp.azimuth_deg), spectrum: lamp.illuminant,
    }));
  }

  /** The picture's box at a place of the canvas, CSS pixels, null beside; without one the first. */
  paneAt(x, y) {
    const ratio = window.devicePixelRatio, { mode, share } = this.shown;
    const list = (this.boxes ?? []).map(({ side, to }) => ({
      side, box: to.map((length) => length / ratio),
    }));
    if (x === undefined) return list[0] ?? null;
    const inside = list.filter(({ box }) => x >= box[0] && y >= box[1]
      && x < box[0] + box[2] && y < box[1] + box[3]);
    if (mode === "wipe" && inside.length > 0) {
      return x - inside[0].box[0] < share * inside[0].box[2] ? inside[0] : inside[1];
    }
    return inside[0] ?? null;
  }

  /** Side and pixel of the drawn picture at a place of the canvas, or null. */
  pictureAt(x, y) {
    const pane = this.paneAt(x, y);
    if (pane === null || this.drawn === null) return null;
    const [left, top, width, height] = pane.box, [columns, rows] = this.drawn.size;
    return {
      side: pane.side, x: Math.floor((x - left) / width * columns),
      y: Math.floor((y - top) / height * rows),
    };
  }

  /** Lab, L_d* and L_s* of a pixel, or null where there is no object. */
  colour(side, x, y) {
    return this.lost || this.drawn === null ? null : this.engine.lab_at(side, x, y);
  }

  /** What a pane shows, for the hand: {shape, eye, numbers}. */
  seen({ side, box }) {
    const { drawing } = this.engine;
    return {
      shape: drawing.sides[side].shape, numbers: drawing.numbers,
      eye: atOneScale(drawing, this.present.eye, box.slice(2)),
    };
  }

  /** Show the object life size; a CSS pixel of the screen is so many millimetres. */
  lifeSize(pixel) {
    const height = this.paneAt().box[3], eye = lifeSized(this.present.eye, height * pixel / 1000);
    this.life = { devicePixel: pixel / window.devicePixelRatio, height, angle: eye.field_of_view_deg };
    this.set({ ...this.present, eye: { ...eye, shift_right: 0, shift_up: 0 } });
  }

  /** Keep the object life size where the pictures have got another height. */
  keepLifeSize() {
    const { life, present: { eye } } = this, height = this.paneAt().box[3];
    if (!life || eye.field_of_view_deg !== life.angle || height === life.height) return;
    const pixel = life.devicePixel * window.devicePixelRatio;
    const kept = lifeSized(eye, height * pixel / 1000);
    this.life = { ...life, height, angle: kept.field_of_view_deg };
    this.present = { ...this.present, eye: kept };
  }

  /** Frame the object again, from where the eye is. */
  frameAgain() {
    const { field_of_view_deg: _, ...eye } = this.present.eye;
    this.set({ ...this.present, eye: { ...eye, shift_right: 0, shift_up: 0 } });
  }

  /** Watch the stage's size, the screen's density and the graphics context. */
  watch() {
    new ResizeObserver(() => this.redraw()).observe(byId("stage"));
    window.addEventListener("resize", () => this.redraw());
    this.canvas.addEventListener("webglcontextlost", () => {
      this.lost = true;
      this.main("lost");
      notice(say("state.lost"));
      this.waitsLost = setTimeout(() => this.showStored(true), LOST_MS);
    });
    this.engine.onRestored = () => {
      clearTimeout(this.waitsLost);
      this.drawn = null;
      this.lost = false;
      this.showStored(false);
      notice("");
      this.redraw();
    };
  }

  /** The stored pictures in the canvas's place, where nothing can be drawn any more; or back. */
  showStored(stored) {
    this.canvas.hidden = stored;
    for (const name of ["controls", "tools"]) {
      const part = byId(name);
      if (part !== null) part.inert = stored;
    }
    this.main(stored ? "stored" : "lost"); // until it is drawn again
    if (stored) notice(say("state.stored"));
  }
}

/** On paper the pictures keep their proportions and their names' places, as wide as a page. */
export function keepForPaper(stage) {
  window.addEventListener("beforeprint", () => {
    const { clientWidth, clientHeight } = stage;
    stage.style.setProperty("width", `${clientWidth}px`);
    stage.style.setProperty("height", `${clientHeight}px`);
    stage.style.setProperty("zoom", String(Math.min(1, PAPER_PX / clientWidth)));
  });
  window.addEventListener("afterprint", () => {
    for (const name of ["width", "height", "zoom"]) stage.style.removeProperty(name);
  });
}

/** The line above all else; empty hides it. */
export function notice(text) {
  const line = byId("notice");
  line.textContent = text;
  line.hidden = text === "";
}
