// The share of each pixel at a mesh's silhouette that the mesh covers. The twin of picture/gpu/mesh_edges.py.

import { TriangleBuffer, hidesBacks, projection } from "./mesh.js";

const PART_PX = 2048; // side of the parts in which the silhouette is looked for
const BLOCK_PX = 2; // side in pixels of what besideEdges looks at
const BESIDE_PX = 1 / 64; // by which bounds are larger: corners are drawn up to 1/512 beside their place
const EDGE_MARK = 1; // as in mesh_edge.frag, of 255

/** Draw the coverage target of a view, inside its bounds. target: r8 with a depth buffer; triangles: of the mesh. */
export function drawCoverage(device, target, mesh, triangles, view, edgeRays) {
  const [left, bottom, right, top] = view.bounds;
  const [width, height] = view.size.map((side) => Math.min(side, PART_PX));
  const mask = device.target([device.texture(2 * width + 1, 2 * height + 1, "r8")]);
  try {
    for (let low = bottom; low < top; low += height) {
      for (let first = left; first < right; first += width) {
        const box = [first, low, Math.min(first + width, right), Math.min(low + height, top)];
        drawMask(device, mask, mesh, triangles, view, [first, low, first + width, low + height]);
        device.draw({
          stage: "mesh_edge.frag",
          uniforms: { mask_image: mask.textures[0], from: [first, low] },
          target,
          scissor: box,
          depth: "1",
        });
      }
    }
  } finally {
    device.releaseTarget(mask);
  }
  const numbers = besideEdges(mesh, view, device.read(target, 0, view.bounds));
  if (numbers.length === 0) return;
  const part = new TriangleBuffer(device, mesh, numbers);
  try {
    device.draw({
      stage: "mesh_places.frag",
      uniforms: projection(mesh, view, [0, 0, ...view.size]),
      target,
      scissor: view.bounds,
      geometry: part,
      depth: ">",
      adds: true,
      instances: edgeRays,
    });
  } finally {
    part.release();
  }
}

// The mesh at the corners, sides and middles of a box of pixels.
function drawMask(device, target, mesh, triangles, view, [left, bottom, right, top]) {
  device.clear(target, [0, 0, 0, 0]);
  const wider = [left - 0.25, bottom - 0.25, right + 0.25, top + 0.25];
  device.draw({
    stage: "mesh.frag",
    uniforms: projection(mesh, view, wider, 2),
    target,
    geometry: triangles,
    culls: hidesBacks(mesh, view),
  });
}

/** Numbers of the triangles whose bounds in the picture come near a marked pixel.
 *
 * Of a closed mesh those seen from behind are left out: the others cover the same places.
 * coverage: four bytes a pixel inside the view's bounds, rows from the bottom.
 */
export function besideEdges(mesh, view, coverage) {
  const [left, bottom, right, top] = view.bounds;
  const [across, down] = view.size.map((side) => Math.ceil(side / BLOCK_PX));
  const blocks = new Uint8Array(across * down);
  for (let y = bottom, k = 0; y < top; y++) {
    for (let x = left; x < right; x++, k += 4) {
      if (coverage[k] !== EDGE_MARK) continue;
      blocks[Math.floor(y / BLOCK_PX) * across + Math.floor(x / BLOCK_PX)] = 1;
    }
  }
  const wide = across + 1;
  const sums = new Int32Array(wide * (down + 1));
  for (let y = 0; y < down; y++) {
    for (let x = 0; x < across; x++) {
      const at = (y + 1) * wide + x + 1;
      sums[at] = blocks[y * across + x] + sums[at - 1] + sums[at - wide] - sums[at - wide - 1];
    }
  }
  const places = projectedPlaces(mesh.points, view);
  const { triangles, count } = mesh;
  const found = [];
  const hidden = hidesBacks(mesh, view);
  const ends = [0, 0, 0, 0]; // lowest and highest column of blocks, and row
  for (let n = 0; n < count; n++) {
    const [a, b, c] = [3 * triangles[3 * n], 3 * triangles[3 * n + 1], 3 * triangles[3 * n + 2]];
    for (let k = 0; k < 2; k++) {
      const [p, q, r] = [places[a + k], places[b + k], places[c + k]];
      const limit = k ? down : across;
      const low = Math.floor((Math.min(p, q, r) - BESIDE_PX) / BLOCK_PX);
      const high = Math.ceil((Math.max(p, q, r) + BESIDE_PX) / BLOCK_PX);
      ends[2 * k] = Math.min(Math.max(low, 0), limit);
      ends[2 * k + 1] = Math.min(Math.max(high, 0), limit);
    }
    const behind = places[a + 2] <= 1e-9 || places[b + 2] <= 1e-9 || places[c + 2] <= 1e-9;
    const x0 = behind ? 0 : ends[0]; // its bounds are not known
    const x1 = behind ? across : ends[1];
    const y0 = wide * (behind ? 0 : ends[2]);
    const y1 = wide * (behind ? down : ends[3]);
    if (sums[y1 + x1] - sums[y0 + x1] - sums[y1 + x0] + sums[y0 + x0] <= 0) continue;
    if (behind || !hidden || !turnedAway(places, a, b, c)) found.push(n);
  }
  return Uint32Array.from(found);
}

// Whether a triangle runs clockwise, also where each corner moves by BESIDE_PX.
function turnedAway(places, a, b, c) {
  const [ux, uy] = [places[b] - places[a], places[b + 1] - places[a + 1]];
  const [vx, vy] = [places[c] - places[b], places[c + 1] - places[b + 1]];
  const [wx, wy] = [places[a] - places[c], places[a + 1] - places[c + 1]];
  const around = [ux, uy, vx, vy, wx, wy].reduce((sum, side) => sum + Math.abs(side), 0);
  return ux * vy - uy * vx < -(around * BESIDE_PX + 4 * BESIDE_PX ** 2);
}

// Column, row from the bottom and depth of each point.
function projectedPlaces(points, view) {
  const places = new Float64Array(points.length);
  const { eye_m, right, up, forward, pixelStep, shift, size } = view;
  for (let n = 0; n < points.length; n += 3) {
    const x = points[n] - eye_m[0];
    const y = points[n + 1] - eye_m[1];
    const z = points[n + 2] - eye_m[2];
    const depth = x * forward[0] + y * forward[1] + z * forward[2];
    const before = Math.max(depth, 1e-9);
    const across = (x * right[0] + y * right[1] + z * right[2]) / before - shift[0];
    const tall = (x * up[0] + y * up[1] + z * up[2]) / before - shift[1];
    places[n] = across / pixelStep + 0.5 * size[0];
    places[n + 1] = tall / pixelStep + 0.5 * size[1];
    places[n + 2] = depth;
  }
  return places;
}
