// The engine: settings become the pictures of both sides, as the window draws them.

import { beginPictures } from "./ahead.js";
import { unpackedAll } from "./arrays.js";
import { Device, DeviceError } from "./device.js";
import { SIDES, commonFactor, heldFactor, scalingOf } from "./pair.js";
import { Passes } from "./passes.js";
import { openForm } from "./surface.js";
import { atOneScale } from "./view.js";

const PREPARED_SIZE = [80, 8]; // wide enough for the reduction's further steps
const LIKELY_SIZE = [512, 512]; // of a first picture, for what depends on a size but little

export class Engine {
  /**
   * An engine on a canvas. proof: its JSON. shaders: texts by name. Throws Unsupported where the
   * browser can't draw.
   */
  static async open(canvas, proof, shaders) {
    const drawing = await unpackedAll(proof.content.drawing);
    const device = new Device(canvas, shaders, drawing.definitions);
    const forms = {};
    for (const name of Object.keys(drawing.sides)) {
      forms[name] = await openForm(device, drawing, name);
    }
    const engine = new Engine(device, drawing, forms);
    const newest = proof.messages?.[proof.messages.length - 1];
    if (newest) beginPictures(device, engine.passes, newest.settings, LIKELY_SIZE);
    for (const form of Object.values(forms)) await form?.print(proof.content.files ?? {});
    return engine;
  }

  constructor(device, drawing, forms = {}) {
    this.device = device;
    this.forms = forms;
    this.drawing = drawing;
    this.sides = SIDES.filter((name) => name in drawing.sides);
    this.onRestored = null; // called when a lost context came back: draw again
    this._factor = 1;
    this._drawn = null;
    this._edgedView = null; // JSON of eye and size of the last pictures with smooth edges
    this.passes = this._passes();
    this._preparing = null;
    device.onRestored = () => {
      for (const form of Object.values(this.forms)) form?.forget();
      for (const passes of Object.values(this.passes)) passes.forget();
      this._drawn = null;
      this._edgedView = null;
      this.onRestored?.();
    };
  }

  _passes() {
    return Object.fromEntries(
      this.sides.map((name) => [
        name,
        new Passes(this.device, this.drawing, name, this.forms[name]?.surface(this.device) ?? null),
      ]),
    );
  }

  /** Whether the browser took the graphics away; it draws again after onRestored. */
  get lost() {
    return this.device.lost;
  }

  /**
   * Draw both pictures, only what changed. settings: of a proof. size: [width, height] of each.
   *
   * moving: a hand moves, so the common factor is held where it can be. Returns {factor, reference:
   * {c, c_max, extremes, objectPixels, lit, samples, view, notes}, test: {...}}.
   */
  draw(settings, size, { moving = false } = {}) {
    if (this.device.lost) throw new DeviceError("lost");
    const edged = this._isEdged(settings, size, moving);
    const result = this._draw(this.passes, settings, size, { moving, edged });
    this._factor = result.factor;
    this._drawn = { settings, size, result };
    return result;
  }

  /**
   * Whether silhouettes are smooth: where they lie is looked for once a view, which costs as much as
   * the picture, so not while the view moves. The window's PairRenderer._edged.
   */
  _isEdged({ eye }, size, moving) {
    const view = JSON.stringify([eye, size]);
    if (moving && view !== this._edgedView) return false;
    this._edgedView = view;
    return true;
  }

  _draw(allPasses, asked, size, { moving = false, edged = true } = {}) {
    const { numbers } = this.drawing;
    const settings = { ...asked, eye: atOneScale(this.drawing, asked.eye, size) };
    const requests = {};
    const lights = {};
    for (const name of this.sides) {
      requests[name] = allPasses[name].request(settings, name, size);
      lights[name] = allPasses[name].light(requests[name]);
    }
    const alone = this.sides.map((name) =>
      scalingOf(settings[name].c, lights[name].extremes, 1, numbers),
    );
    const needed = commonFactor(alone.map(({ c, c_max }) => [c, c_max]));
    const factor = moving ? heldFactor(needed, this._factor, numbers) : needed;
    const result = { factor };
    for (const name of this.sides) {
      const { extremes, white, objectPixels } = lights[name];
      const scaling = scalingOf(settings[name].c, extremes, factor, numbers);
      allPasses[name].tone(requests[name], scaling.c, edged);
      result[name] = {
        ...scaling, extremes, objectPixels, lit: white > 0, samples: requests[name].samples,
        view: { pixel_step: requests[name].view.pixelStep, bounds: requests[name].view.bounds },
      };
    }
    return result;
  }

  /**
   * Compile what sliders can reach while nothing else happens. idle: () -> a promise of the next
   * idle moment; by default the browser's own. Resolves when all is ready; asked for twice at once,
   * it does it once.
   */
  prepare(settings, idle = idleMoment) {
    this._preparing ??= this._prepare(settings, idle).finally(() => {
      this._preparing = null;
    });
    return this._preparing;
  }

  async _prepare(settings, idle) {
    const { generation } = this.device;
    const gone = () => this.device.lost || this.device.generation !== generation;
    const spare = this._passes(); // so that the pictures that show stay as they are
    for (const sigma_n_deg of [0, 1]) {
      const changed = { ...settings };
      for (const name of this.sides) changed[name] = { ...settings[name], sigma_n_deg };
      const begun = [];
      for (const name of this.sides) {
        const request = spare[name].request(changed, name, PREPARED_SIZE);
        const { variant } = request;
        begun.push(
          this.device.begin("shade.frag", spare[name].shadeDefines(request)),
          this.device.begin("split.frag", variant.split),
        );
        if (variant.reads_field) begun.push(this.device.begin("grain_field.frag", variant.field));
      }
      do await idle();
      while (!gone() && !begun.every((program) => this.device.isReady(program)));
      if (gone()) return;
      // Drivers end the compiling when a program first draws, so each draws a few pixels.
      this._draw(spare, changed, PREPARED_SIZE);
    }
    for (const passes of Object.values(spare)) passes.release();
  }

  /**
   * Draw both pictures aside, so that what is shown stays as it is. use(passes, report) reads their
   * targets before they are freed; its result is handed on.
   */
  drawAside(settings, size, use) {
    const aside = this._passes();
    try {
      return use(aside, this._draw(aside, settings, size));
    } finally {
      for (const passes of Object.values(aside)) passes.release();
    }
  }

  /** What draw() last returned; null before the first picture. */
  get report() {
    return this._drawn?.result ?? null;
  }

  /**
   * Show parts of the pictures on the canvas. boxes: [{side, from, to}], [x, y, width, height] in
   * pixels of the picture and of the canvas, rows from the top. background: three bytes around.
   */
  show(boxes, background = this.background) {
    const { gl } = this.device;
    const height = this.device.canvas.height;
    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
    gl.disable(gl.SCISSOR_TEST);
    gl.clearColor(...background.map((byte) => byte / 255), 1);
    gl.clear(gl.COLOR_BUFFER_BIT);
    for (const { side, from, to } of boxes) {
      const target = this.passes[side].target(["display"]);
      const [x, y, w, h] = from;
      const [cx, cy, cw, ch] = to;
      gl.bindFramebuffer(gl.READ_FRAMEBUFFER, target.framebuffer);
      gl.bindFramebuffer(gl.DRAW_FRAMEBUFFER, null);
      const whole = cw % w === 0 && ch % h === 0;
      gl.blitFramebuffer(
        x, target.height - y - h, x + w, target.height - y,
        cx, height - cy - ch, cx + cw, height - cy,
        gl.COLOR_BUFFER_BIT, whole ? gl.NEAREST : gl.LINEAR,
      );
    }
    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
  }

  /** Three bytes of the surround. */
  get background() {
    return this.drawing.display.uniforms.background_digital.map((x) => Math.round(255 * x));
  }

  /** A side's picture as last drawn: {width, height, data}, RGBA, row 0 the top. */
  pixels(side) {
    const { width, height, rows } = this._rows(side, "display");
    for (let k = 3; k < rows.length; k += 4) rows[k] = 255;
    return { width, height, data: new Uint8ClampedArray(rows.buffer) };
  }

  /** What was done to each pixel: bits 1 clipped, 2 out of gamut; row 0 the top. */
  flags(side) {
    const { rows } = this._rows(side, "display");
    return Uint8Array.from({ length: rows.length / 4 }, (_, k) => 255 - rows[4 * k + 3]);
  }

  /** L_d*, L_s*, a*, b* of each pixel, row 0 the top; L_d* is OFF_OBJECT off the object. */
  split(side) {
    return this._rows(side, "split").rows;
  }

  /** {lab, l_d, l_s} of a pixel, of the picture as scaled; null off the object. */
  lab_at(side, x, y) {
    const target = this.passes[side].target(["split"]);
    const row = target.height - 1 - y;
    const [l_d, l_s, a, b] = this.device.read(target, 0, [x, row, x + 1, row + 1]);
    if (l_d < 0.5 * this.drawing.numbers.OFF_OBJECT) return null;
    const { c } = this._drawn.result[side];
    return { lab: [l_d + c * l_s, a, b], l_d, l_s };
  }

  _rows(side, name) {
    const target = this.passes[side].target([name]);
    const { width, height } = target;
    const data = this.device.read(target);
    const rows = new data.constructor(data.length);
    for (let y = 0; y < height; y++) {
      const from = 4 * width * (height - 1 - y);
      rows.set(data.subarray(from, from + 4 * width), 4 * width * y);
    }
    return { width, height, rows };
  }

  /** Wait until all that was drawn is on the screen's way, by reading one pixel. */
  finish() {
    const side = this.sides[this.sides.length - 1];
    this.device.read(this.passes[side].target(["display"]), 0, [0, 0, 1, 1]);
  }

  /** Free all that the pictures need; the next draw makes it again. */
  forget() {
    for (const passes of Object.values(this.passes)) passes.release();
    this._drawn = null;
  }

  /** Free everything. The canvas can't be drawn on again. */
  release() {
    this.forget();
    this.device.release();
  }
}

/** The browser's next idle moment. */
function idleMoment() {
  return new Promise((resolve) => {
    if (window.requestIdleCallback) window.requestIdleCallback(resolve, { timeout: 500 });
    else setTimeout(resolve, 30);
  });
}
