// Where the pictures lie on the canvas: side by side or stacked, under a wipe, or one at a time.

import { SIDES } from "./pair.js";

const GAP = 8; // CSS pixels between the pictures
export const MOST_PX = 1024; // of a picture's side

/** Width and height of what holds both objects, however they turn about their axes; any unit. */
export function roomFor(sides) {
  const shapes = Object.values(sides).map(({ shape }) => shape);
  return [Math.max(...shapes.map(reachOf)), Math.max(...shapes.map((shape) => shape.half_extent_m[1]))];
}

// How far an object reaches from its upright axis, metres.
function reachOf({ kind, half_extent_m: [x, , z], outline_m: points }) {
  if (kind === "cylinder" || kind === "sphere") return x;
  if (!points) return Math.hypot(x, z);
  let reach = 0;
  for (const [px, , pz] of points) reach = Math.max(reach, Math.hypot(px, pz));
  return reach;
}

/** Panes of a stage, CSS pixels: [{side, box: [x, y, width, height]}].
 *
 * mode: 'both', 'wipe' or 'flip'. side: which one a flip shows. In a wipe both have the same box.
 * room: of roomFor.
 */
export function panes(mode, width, height, side, room) {
  if (mode === "flip") return [{ side, box: [0, 0, width, height] }];
  if (mode === "wipe") return SIDES.map((name) => ({ side: name, box: [0, 0, width, height] }));
  const beside = Math.floor((width - GAP) / 2), below = Math.floor((height - GAP) / 2);
  // Whichever shows the objects larger.
  const scale = (across, tall) => Math.min(across / room[0], tall / room[1]);
  if (scale(beside, height) >= scale(width, below)) {
    return SIDES.map((name, k) => ({ side: name, box: [k * (beside + GAP), 0, beside, height] }));
  }
  return SIDES.map((name, k) => ({ side: name, box: [0, k * (below + GAP), width, below] }));
}

/** The same panes in device pixels, each as large as a picture is drawn, and the pictures' size.
 *
 * A picture has at most MOST_PX a side: beyond, it lies in the middle of its pane, pixel for pixel.
 */
export function fitted(list, ratio) {
  const size = [2, 3].map((k) => Math.max(1, Math.min(...list.map((pane) =>
    Math.min(MOST_PX, Math.floor(pane.box[k] * ratio))))));
  return {
    size,
    boxes: list.map(({ side, box: [x, y, width, height] }) => ({
      side,
      to: [
        Math.round(x * ratio + 0.5 * (width * ratio - size[0])),
        Math.round(y * ratio + 0.5 * (height * ratio - size[1])), ...size,
      ],
    })),
  };
}

/** Boxes for Engine.show: `drawn` is the size of the pictures, `share` where a wipe parts them. */
export function blits(mode, boxes, drawn, share) {
  if (mode !== "wipe") return boxes.map(({ side, to }) => ({ side, from: [0, 0, ...drawn], to }));
  const [x, y, width, height] = boxes[0].to, cut = Math.round(share * width);
  const part = drawn[0] / width;
  return [
    { side: SIDES[0], from: [0, 0, Math.round(cut * part), drawn[1]], to: [x, y, cut, height] },
    { side: SIDES[1],
      from: [Math.round(cut * part), 0, drawn[0] - Math.round(cut * part), drawn[1]],
      to: [x + cut, y, width - cut, height] },
  ].filter(({ from, to }) => from[2] > 0 && to[2] > 0);
}
