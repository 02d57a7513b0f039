// The hand on the object and the lamp: twins of viewer/drawing/camera.py.

import { Press } from "./press.js";

export const ZOOM_STEP = 1.15; // of one notch of the wheel
const DEGREES_ACROSS = 180; // that a drag over the whole width turns
const WIDEST_DEG = 120, NARROWEST_DEG = 0.2; // angle of view that zooming reaches
const FARTHEST_SHIFT = 100;
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

/** Tangent of a pixel's side in a picture so many pixels high; `framed` where the eye has no
 * angle of view. */
export function pixelStep(eye, height, framed) {
  if (eye.field_of_view_deg === undefined) return framed;
  return Math.tan(eye.field_of_view_deg * Math.PI / 360) / (0.5 * height);
}

/** The eye after turns of the wheel; what is under the pointer stays there. */
export function zoomed(eye, notches, pointer, size, framed) {
  const [width, height] = size, half = 0.5 * height;
  const before = pixelStep(eye, height, framed);
  const tangent = (angle) => Math.tan(angle * Math.PI / 360) / half;
  const low = Math.min(tangent(NARROWEST_DEG), before), high = Math.max(tangent(WIDEST_DEG), before);
  const step = held(before * ZOOM_STEP ** -notches, low, high);
  const right = pointer[0] - 0.5 * width, up = half - pointer[1];
  return shifted({ ...eye, field_of_view_deg: angleOf(step * half) }, [
    eye.shift_right + right * (before - step), eye.shift_up + up * (before - step),
  ]);
}

/** The eye after a drag of two fingers, which slides the picture. */
export function panned(eye, moved, height, framed) {
  const step = pixelStep(eye, height, framed);
  return shifted(eye, [eye.shift_right - moved[0] * step, eye.shift_up + moved[1] * step]);
}

/** The eye that shows the plane through the object's centre, in a picture so high, life size. */
export function lifeSized(eye, height_m) {
  return { ...eye, field_of_view_deg: angleOf(0.5 * height_m / eye.distance_m) };
}

function angleOf(tangent) {
  return held(Math.atan(tangent) * 360 / Math.PI, 1e-3, 170);
}

function shifted(eye, [right, up]) {
  return {
    ...eye,
    shift_right: held(right, -FARTHEST_SHIFT, FARTHEST_SHIFT),
    shift_up: held(up, -FARTHEST_SHIFT, FARTHEST_SHIFT),
  };
}

/** Listen to pointers, wheel and keys over the canvas.
 *
 * app: mode() is 'turn', 'lamp' or 'read'; paneAt(x, y) of CSS pixels gives {side, box} or null;
 * settings(), set(settings, live), framed(), point(x, y) or point(null), keys(event) for the rest.
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
    app.set({ ...settings, eye: panned(settings.eye, [0.5 * moved[0], 0.5 * moved[1]],
      pane.box[3], app.framed(pane)) }, true);
  };
  const zoom = (notches, [x, y], pane) => {
    const [left, top, width, height] = pane.box, settings = app.settings();
    const eye = zoomed(settings.eye, notches, [x - left, y - top], [width, height],
      app.framed(pane));
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
