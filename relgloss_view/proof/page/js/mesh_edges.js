// The share of each pixel at a mesh's silhouette that the mesh covers. The twin of picture/gpu/mesh_edges.py.

import { TriangleBuffer, hidesBacks, projection } from "./mesh.js";
import { dot3 } from "./vectors.js";

const PART_PX = 2048; // side of the parts in which the silhouette is looked for
const BLOCK_PX = 4; // side in pixels of what besideEdges looks at
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
      uniforms: {
        ...projection(mesh, view, [0, 0, ...view.size]),
        per_target: view.size.map((side) => 1 / side),
      },
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
    uniforms: projection(mesh, view, wider),
    target,
    geometry: triangles,
    culls: hidesBacks(mesh, view),
  });
}

/** Numbers of the triangles whose bounds in the picture come near a marked pixel.
 *
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
  const found = [];
  for (let n = 0; n < mesh.count; n++) {
    const [x0, y0, x1, y1] = reachedBlocks(mesh.triangles, n, places, [across, down]);
    const held = sums[y1 * wide + x1] - sums[y0 * wide + x1] - sums[y1 * wide + x0] + sums[y0 * wide + x0];
    if (held > 0) found.push(n);
  }
  return Uint32Array.from(found);
}

// Column, row from the bottom and depth of each point.
function projectedPlaces(points, view) {
  const places = new Float64Array(points.length);
  for (let n = 0; n < points.length; n += 3) {
    const way = [0, 1, 2].map((k) => points[n + k] - view.eye_m[k]);
    const depth = dot3(way, view.forward);
    const before = Math.max(depth, 1e-9);
    [view.right, view.up].forEach((axis, k) => {
      const tangent = dot3(way, axis) / before - view.shift[k];
      places[n + k] = tangent / view.pixelStep + 0.5 * view.size[k];
    });
    places[n + 2] = depth;
  }
  return places;
}

function reachedBlocks(triangles, n, places, limits) {
  const corners = [0, 1, 2].map((k) => 3 * triangles[3 * n + k]);
  if (corners.some((at) => places[at + 2] <= 1e-9)) return [0, 0, ...limits]; // its bounds are not known
  const ends = [0, 1].map((k) => {
    const along = corners.map((at) => places[at + k]);
    const block = (place) => Math.min(Math.max(place, 0), limits[k]);
    return [
      block(Math.floor((Math.min(...along) - 1) / BLOCK_PX)),
      block(Math.ceil((Math.max(...along) + 1) / BLOCK_PX)),
    ];
  });
  return [ends[0][0], ends[1][0], ends[0][1], ends[1][1]];
}
