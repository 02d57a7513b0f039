// The hand on the object and the lamp: twins of viewer/drawing/camera.py.

import { Press } from "./press.js";
import { meet } from "./shape.js";
import { View } from "./view.js";

export const ZOOM_STEP = 1.15; // of one notch of the wheel
const DEGREES_ACROSS = 180; // that a drag over the whole width turns
const WIDEST_DEG = 120, NARROWEST_DEG = 0.2; // angle of view that zooming reaches
const ANGLES_DEG = [1e-3, 170], FARTHEST_SHIFT = 100; // that an eye can have
const INNER = 0.9; // share of the picture, each way, that some of the object stays in
const BISECTIONS = 40;
const KEY_DEGREES = 5; // of one press of an arrow

/** The same direction, -180 to 180 degrees. */
function wrapped(angle) {
  return ((((angle + 180) % 360) + 360) % 360) - 180;
}

export function held(value, low, high) {
  return Math.min(Math.max(value, low), high);
}

/** The eye after a drag of [right, down] pixels in a picture so wide: the object turns with it. */
export function orbited(eye, moved, width) {
  const perPixel = DEGREES_ACROSS / Math.max(width, 1);
  return {
    ...eye,
    azimuth_deg: wrapped(eye.azimuth_deg - moved[0] * perPixel),
    elevation_deg: held(eye.elevation_deg + moved[1] * perPixel, -90, 90),
  };
}

/** The lamp after a drag: it goes where the hand goes. */
export function turned(lamp, moved, width) {
  const perPixel = DEGREES_ACROSS / Math.max(width, 1);
  return {
    ...lamp,
    azimuth_deg: wrapped(lamp.azimuth_deg + moved[0] * perPixel),
    elevation_deg: held(lamp.elevation_deg - moved[1] * perPixel, -90, 90),
  };
}

/** The eye after turns of the wheel; what is under the pointer stays there.
 *
 * seen: {shape, eye, numbers} of the picture under the pointer, its eye as the pictures have it.
 */
export function zoomed(seen, notches, pointer, size) {
  const { shape, eye, numbers } = seen, [width, height] = size, half = 0.5 * height;
  const view = View.of(shape, eye, size, numbers), before = view.pixelStep;
  const [narrow, wide, least, most] = [NARROWEST_DEG, WIDEST_DEG, ...ANGLES_DEG]
    .map((angle) => Math.tan(angle * Math.PI / 360) / half);
  // A view that is beyond the limits of zooming is not drawn back to them.
  const low = Math.max(Math.min(narrow, before), least), high = Math.min(Math.max(wide, before), most);
  const step = held(before * ZOOM_STEP ** -notches, low, high);
  const right = pointer[0] - 0.5 * width, up = half - pointer[1];
  const shift = [view.shift[0] + right * (before - step), view.shift[1] + up * (before - step)];
  return shifted({ ...seen, eye: { ...eye, field_of_view_deg: angleOf(step * half) } }, shift, step, size);
}

/** The eye after a drag of two fingers, which slides the picture. */
export function panned(seen, moved, size) {
  const { shape, eye, numbers } = seen, step = View.of(shape, eye, size, numbers).pixelStep;
  const shift = [eye.shift_right - moved[0] * step, eye.shift_up + moved[1] * step];
  return shifted(seen, shift, step, size);
}

/** The eye that shows the plane through the object's centre, in a picture so high, life size. */
export function lifeSized(eye, height_m) {
  return { ...eye, field_of_view_deg: angleOf(0.5 * height_m / eye.distance_m) };
}

function angleOf(tangent) {
  return held(Math.atan(tangent) * 360 / Math.PI, ...ANGLES_DEG);
}

/** The eye with a shift, held so that some of the object stays in the picture.
 *
 * The point of the picture's inner part that is nearest to the object's centre shows the object; a
 * shift that goes further is made as much shorter as that takes.
 */
function shifted({ shape, eye, numbers }, shift, step, size) {
  const view = View.of(shape, eye, size, numbers);
  // A drag has no time for triangles: their bounding box stands for them.
  const kind = shape.analytic ? shape.kind : "box";
  const inner = size.map((count) => 0.5 * INNER * count * step);
  const isInReach = (part) => {
    const now = shift.map((tangent) => part * tangent);
    if (Math.max(...now.map(Math.abs)) > FARTHEST_SHIFT) return false;
    const [right, up] = now.map((tangent, k) => tangent - held(tangent, -inner[k], inner[k]));
    if (right === 0 && up === 0) return true;
    const ray = view.forward.map((x, k) => x + right * view.right[k] + up * view.up[k]);
    return meet(kind, view.eye_m, ray, shape.half_extent_m).found;
  };
  let inside = 1;
  if (!isInReach(1)) {
    let outside = 1;
    inside = 0;
    for (let k = 0; k < BISECTIONS; k++) {
      const part = 0.5 * (inside + outside);
      if (isInReach(part)) inside = part;
      else outside = part;
    }
  }
  return { ...eye, shift_right: inside * shift[0], shift_up: inside * shift[1] };
}

/** Listen to pointers, wheel and keys over the canvas.
 *
 * app: mode() is 'turn', 'lamp' or 'read'; paneAt(x, y) of CSS pixels gives {side, box} or null;
 * settings(), set(settings, live), seen(pane), point(x, y) or point(null), key(name) for the rest.
 */
export function listen(canvas, app) {
  const pointers = new Map();
  const place = (event) => {
    const box = canvas.getBoundingClientRect();
    return [event.clientX - box.left, event.clientY - box.top];
  };
  const drag = (moved, width, lamp) => {
    const now = app.settings();
    app.set(lamp ? { ...now, lamp: turned(now.lamp, moved, width) }
      : { ...now, eye: orbited(now.eye, moved, width) }, true);
  };
  const press = new Press((where) => app.point(...where));
  canvas.addEventListener("pointerdown", (event) => {
    const now = place(event);
    pointers.set(event.pointerId, now);
    canvas.setPointerCapture(event.pointerId);
    if (app.mode() === "read") app.point(...now);
    else if (event.pointerType !== "mouse") {
      app.point(null);
      if (pointers.size === 1) press.begin(now);
      else press.end();
    }
  });
  canvas.addEventListener("pointermove", (event) => {
    const now = place(event), before = pointers.get(event.pointerId);
    const pane = app.paneAt(...now) ?? app.paneAt();
    if (before === undefined || app.mode() === "read") {
      if (event.pointerType === "mouse" || before !== undefined) app.point(...now);
      return;
    }
    if (pointers.size === 1 && !press.drags(now)) return;
    const moved = [now[0] - before[0], now[1] - before[1]];
    if (pointers.size === 1) drag(moved, pane.box[2], event.shiftKey || app.mode() === "lamp");
    else if (pointers.size === 2) pinch(event.pointerId, before, now, moved, pane);
    pointers.set(event.pointerId, now);
  });
  const pinch = (id, before, now, moved, pane) => {
    const other = [...pointers].find(([key]) => key !== id)[1];
    const apart = (point) => Math.hypot(point[0] - other[0], point[1] - other[1]);
    const notches = Math.log(Math.max(apart(now), 1) / Math.max(apart(before), 1))
      / Math.log(ZOOM_STEP);
    const middle = [0.5 * (now[0] + other[0]), 0.5 * (now[1] + other[1])];
    zoom(notches, middle, pane);
    const settings = app.settings();
    const half = [0.5 * moved[0], 0.5 * moved[1]]; // the middle of both fingers
    app.set({ ...settings, eye: panned(app.seen(pane), half, pane.box.slice(2)) }, true);
  };
  const zoom = (notches, [x, y], pane) => {
    const [left, top, width, height] = pane.box, settings = app.settings();
    const eye = zoomed(app.seen(pane), notches, [x - left, y - top], [width, height]);
    app.set({ ...settings, eye }, true);
  };
  for (const ended of ["pointerup", "pointercancel", "lostpointercapture"]) {
    canvas.addEventListener(ended, (event) => {
      if (pointers.delete(event.pointerId)) press.end();
    });
  }
  // What a long press has read stays until the next touch: a finger hides what it points at.
  canvas.addEventListener("pointerleave", (event) => {
    if (event.pointerType === "mouse" && app.mode() !== "read") app.point(null);
  });
  canvas.addEventListener("contextmenu", (event) => {
    if (press.reads || event.pointerType === "touch") event.preventDefault();
  });
  canvas.addEventListener("wheel", (event) => {
    const pane = app.paneAt(...place(event));
    // The wheel scrolls the page until the canvas has the focus.
    if (pane === null || (document.activeElement !== canvas && !event.ctrlKey)) return;
    event.preventDefault();
    zoom(-Math.sign(event.deltaY) * Math.min(Math.abs(event.deltaY) / 100, 3), place(event), pane);
  }, { passive: false });
  canvas.addEventListener("keydown", (event) => {
    if (event.altKey || event.metaKey || event.ctrlKey) return;
    const way = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] };
    const step = way[event.key], pane = app.paneAt();
    if (step !== undefined) {
      if (app.mode() === "read") app.movePoint(step, event.shiftKey);
      else drag(step.map((part) => part * KEY_DEGREES), DEGREES_ACROSS,
        event.shiftKey || app.mode() === "lamp");
    } else if (event.key === "+" || event.key === "=" || event.key === "-") {
      const [left, top, width, height] = pane.box;
      zoom(event.key === "-" ? -1 : 1, [left + 0.5 * width, top + 0.5 * height], pane);
    } else if (!app.key(event.key)) return;
    event.preventDefault();
  });
}
