// The silhouette: its tiles, its pixels, and the lists that vertex stages read. The twin of
// picture/model/silhouette.py `edge_tiles` and of picture/gpu/edges.py.

import { meet } from "./shape.js";
import { float32 } from "./vectors.js";

const LIST_WIDE = 1024; // of a list's texture, so that it fits every device
export const TILE_VERTICES = 6;

/** [[left, upper edge, side], ...] in pixels of the tiles that hold an analytic shape's edge. */
export function edgeTiles(shape, view, numbers) {
  const tile = numbers.TILE_PX;
  const [left, bottom, right, top] = view.bounds;
  const first = view.size[1] - top;
  const across = Math.ceil((right - left) / tile);
  const down = Math.ceil((top - bottom) / tile);
  if (across <= 0 || down <= 0) return [];
  const halves = float32(shape.half_extent_m);
  const met = [];
  for (let y = 0; y <= down; y++) {
    for (let x = 0; x <= across; x++) {
      const ray = view.rayAt(left + tile * x - 0.5, first + tile * y - 0.5);
      met.push(meet(shape.kind, view.eye_m, ray, halves).found);
    }
  }
  const wide = across + 1;
  const inside = [];
  const mixed = [];
  for (let y = 0; y < down; y++) {
    for (let x = 0; x < across; x++) {
      const at = y * wide + x;
      const corners = [met[at], met[at + 1], met[at + wide], met[at + wide + 1]];
      inside.push(corners.every(Boolean));
      mixed.push(corners.some(Boolean));
    }
  }
  const any = mixed.some(Boolean);
  const isMixed = (x, y) =>
    x >= 0 && y >= 0 && x < across && y < down && mixed[y * across + x];
  const tiles = [];
  for (let y = 0; y < down; y++) {
    for (let x = 0; x < across; x++) {
      const beside =
        isMixed(x, y + 1) || isMixed(x, y - 1) || isMixed(x + 1, y) || isMixed(x - 1, y);
      const wanted = any ? (isMixed(x, y) || beside) && !inside[y * across + x] : true;
      // An object that is smaller than a tile, or lies between corners, may be in any of them.
      if (wanted) tiles.push([left + tile * x, first + tile * y, tile]);
    }
  }
  return tiles;
}

/**
 * [[column, row from the top, share], ...] of the pixels that the object covers in part.
 *
 * coverage: four bytes a pixel inside the object's bounds, rows from the bottom.
 */
export function edgePixels(coverage, bounds, height, numbers) {
  const [left, bottom, right, top] = bounds;
  const wide = right - left;
  const pixels = [];
  for (let y = 0; y < top - bottom; y++) {
    for (let x = 0; x < wide; x++) {
      const byte = coverage[4 * (y * wide + x)];
      if (byte === 0 || byte === 255) continue;
      const share = Math.round(byte * (numbers.EDGE_RAYS / 255)) / numbers.EDGE_RAYS;
      if (share > 0 && share < 1) pixels.push([left + x, height - 1 - (bottom + y), share]);
    }
  }
  return pixels;
}

/** Places as a texture of rows of up to four numbers: {texture, count}; null for an empty list. */
export function vertexList(device, rows) {
  if (rows.length === 0) return null;
  const high = Math.ceil(rows.length / LIST_WIDE);
  const data = new Float32Array(4 * LIST_WIDE * high);
  rows.forEach((row, k) => data.set(row, 4 * k));
  return { texture: device.texture(LIST_WIDE, high, "rgba32f", data), count: rows.length };
}

/** Places counted from the bottom, as OpenGL does; highest: of each row, what row 0 becomes. */
export const fromBottom = (rows, highest) =>
  rows.map(([x, y, last]) => [x, highest(last) - y, last]);
