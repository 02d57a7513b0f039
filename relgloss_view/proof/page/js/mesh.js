// The triangles of a form: their numbers, as relgloss_view/proof/mesh_drawing.py packs them, and on the device,
// the twin of picture/gpu/triangles.py.

import { valuesOf } from "./layers.js";
import { cross3, dot3, minus3, norm3, plus3, scaled3 } from "./vectors.js";

const CORNER_NUMBERS = 11; // of a vertex
const LEAST_COSINE = 1e-4; // to the eye, below which an interpolated normal is bent towards it

/** A mesh of a drawing.
 *
 * {points, normals, label, part, triangles}: typed arrays, numbers in float32, three or two a point. outline_m:
 * points [x, y, z] in float64 whose hull is that of the mesh. half_extent_m, closed, wide: as in Python.
 */
export async function meshOf(content) {
  const mesh = content.ring ? await turnedMesh(content) : await columnMesh(content);
  const steps = await valuesOf(content.triangles);
  const count = steps.length / 3;
  mesh.triangles = new Uint32Array(3 * count);
  for (let k = 0; k < 3; k++) {
    let number = 0;
    for (let n = 0; n < count; n++) mesh.triangles[3 * n + k] = number += steps[k * count + n];
  }
  if (mesh.rows) mesh.outline_m = usedPoints(mesh);
  delete mesh.rows;
  const { half_extent_m, closed, wide } = content;
  return Object.assign(mesh, { half_extent_m, closed, wide, count });
}

async function turnedMesh(content) {
  const [ring, numbers, directions] = await Promise.all(
    [content.ring, content.numbers, content.directions].map(valuesOf),
  );
  const rings = ring.length / 3;
  const turns = directions.length / 3;
  const mesh = emptyMesh(content.points);
  mesh.rows = [];
  let at = 0;
  for (let k = 0; k < rings; k++) {
    const [radius, y, out, up, labelY] = [0, 1, 2, 3, 4].map((n) => numbers[n * rings + k]);
    for (let n = 0; n < ring[rings + k]; n++, at++) {
      const place = ring[k] + n;
      const [sine, cosine] = [directions[place], directions[turns + place]];
      const point = [radius * sine, y, radius * cosine];
      mesh.rows.push(point);
      mesh.points.set(point, 3 * at);
      mesh.normals.set([out * sine, up, out * cosine], 3 * at);
      mesh.label.set([directions[2 * turns + place], labelY], 2 * at);
      mesh.part[at] = ring[2 * rings + k];
    }
  }
  return mesh;
}

async function columnMesh(content) {
  const [steps, parts, outline] = await Promise.all(
    [content.columns, content.part, content.outline].map(valuesOf),
  );
  const count = content.points;
  const mesh = emptyMesh(count);
  const bits = new Uint32Array(count);
  const numbers = new Float32Array(bits.buffer);
  const places = [0, 1, 2].map((k) => [mesh.points, 3, k]);
  places.push(...[0, 1, 2].map((k) => [mesh.normals, 3, k]), [mesh.label, 2, 0], [mesh.label, 2, 1]);
  places.forEach(([to, stride, first], column) => {
    let sum = 0;
    for (let n = 0; n < count; n++) bits[n] = sum = (sum + steps[column * count + n]) >>> 0;
    for (let n = 0; n < count; n++) to[stride * n + first] = numbers[n];
  });
  let part = 0;
  for (let n = 0; n < count; n++) mesh.part[n] = part += parts[n];
  const corners = outline.length / 3;
  mesh.outline_m = Array.from({ length: corners }, (_, n) =>
    [0, 1, 2].map((k) => outline[k * corners + n]),
  );
  return mesh;
}

function emptyMesh(count) {
  return {
    points: new Float32Array(3 * count),
    normals: new Float32Array(3 * count),
    label: new Float32Array(2 * count),
    part: new Int32Array(count),
  };
}

function usedPoints({ rows, triangles }) {
  const used = new Uint8Array(rows.length);
  for (const number of triangles) used[number] = 1;
  return rows.filter((_, n) => used[n]);
}

/** Whether no triangle is seen from behind: a closed mesh hides those from an eye outside. */
export function hidesBacks(mesh, view) {
  return mesh.closed && view.eye_m.some((x, k) => Math.abs(x) > 1.01 * mesh.half_extent_m[k]);
}

/** How mesh.vert draws a view into a target that holds a box of the picture's pixels: triangles.projection.
 *
 * texels: of the target, along each side of a pixel.
 */
export function projection(mesh, view, [left, bottom, right, top], texels = 1) {
  const sides = [right - left, top - bottom];
  const along = [view.right, view.up, view.forward].map((axis) => dot3(axis, view.eye_m));
  const distance = -along[2];
  const radius = Math.max(norm3(mesh.half_extent_m), 1e-6);
  const near = Math.max(distance - radius, 1e-3 * radius);
  const far = Math.max(distance + radius, 2 * near);
  const slope = (far + near) / (far - near);
  const scale = sides.map((side) => 2 / (view.pixelStep * side));
  const middle = [view.size[0] - 2 * left, view.size[1] - 2 * bottom];
  const shift = [0, 1].map((k) => middle[k] / sides[k] - 1 - scale[k] * view.shift[k]);
  return {
    eye_axes: [...view.right, ...view.up, ...view.forward],
    eye_along: along,
    target_px: sides.map((side) => texels * side),
    mesh_frame: [...scale, ...shift],
    mesh_depth: [slope, slope * distance - (2 * far * near) / (far - near)],
  };
}

/** Triangles as vertices: for each corner all three, the triangle's number from 1, the corner's from 0. */
export function listedTriangles({ points, triangles }, numbers = null) {
  const count = numbers ? numbers.length : triangles.length / 3;
  const rows = new Float32Array(3 * CORNER_NUMBERS * count);
  let to = 0;
  for (let n = 0; n < count; n++) {
    const triangle = numbers ? numbers[n] : n;
    for (let corner = 0; corner < 3; corner++) {
      for (let k = 0; k < 3; k++) {
        const from = 3 * triangles[3 * triangle + k];
        for (let c = 0; c < 3; c++) rows[to++] = points[from + c];
      }
      rows[to++] = n + 1;
      rows[to++] = corner;
    }
  }
  return rows;
}

/** Triangles in a buffer of the device, which programs of mesh.vert and mesh_places.vert draw. */
export class TriangleBuffer {
  constructor(device, mesh, numbers = null) {
    const { gl } = device;
    this.gl = gl;
    this.count = 3 * (numbers ? numbers.length : mesh.count);
    this._buffer = gl.createBuffer();
    gl.bindBuffer(gl.ARRAY_BUFFER, this._buffer);
    gl.bufferData(gl.ARRAY_BUFFER, listedTriangles(mesh, numbers), gl.STATIC_DRAW);
    this._vao = null;
    this._program = null;
  }

  /** What device.draw draws with a program. */
  array(_device, program) {
    const { gl } = this;
    if (this._program !== program.handle) {
      this._drop();
      this._vao = gl.createVertexArray();
      this._program = program.handle;
      gl.bindVertexArray(this._vao);
      gl.bindBuffer(gl.ARRAY_BUFFER, this._buffer);
      [["first_m", 3, 0], ["second_m", 3, 12], ["third_m", 3, 24], ["which", 2, 36]].forEach(([name, size, offset]) => {
        const location = gl.getAttribLocation(program.handle, name);
        gl.enableVertexAttribArray(location);
        gl.vertexAttribPointer(location, size, gl.FLOAT, false, 4 * CORNER_NUMBERS, offset);
      });
    }
    return { vao: this._vao, count: this.count };
  }

  _drop() {
    if (this._vao) this.gl.deleteVertexArray(this._vao);
    this._vao = null;
  }

  release() {
    this._drop();
    this.gl.deleteBuffer(this._buffer);
  }
}

/** The lists that triangles.glsl reads, as textures `wide` texels wide. */
export function meshTextures(device, mesh) {
  const { triangles, points, normals, label, part, count } = mesh;
  const corners = (n, k) => (k < 3 ? triangles[3 * n + k] : part[triangles[3 * n]]);
  return {
    mesh_triangles: listTexture(device, mesh.wide, count, corners),
    mesh_points: listTexture(device, mesh.wide, part.length, (n, k) =>
      k < 3 ? points[3 * n + k] : label[2 * n],
    ),
    mesh_normals: listTexture(device, mesh.wide, part.length, (n, k) =>
      k < 3 ? normals[3 * n + k] : label[2 * n + 1],
    ),
  };
}

function listTexture(device, wide, count, numberAt) {
  const lines = Math.max(1, Math.ceil(count / wide));
  const texels = new Float32Array(4 * wide * lines);
  for (let n = 0; n < count; n++) for (let k = 0; k < 4; k++) texels[4 * n + k] = numberAt(n, k);
  return device.texture(wide, lines, "rgba32f", texels);
}

/** Where a ray from the eye meets triangles: {found, point, normal}. The twin of picture/model/sight.py `meet_ray`. */
export function meetMesh(mesh, eye, ray) {
  let nearest = { travel: Infinity };
  const cornerOf = (number) => minus3(pointOf(mesh.points, number), eye);
  for (let n = 0; n < mesh.count; n++) {
    const numbers = [0, 1, 2].map((k) => mesh.triangles[3 * n + k]);
    const corners = numbers.map(cornerOf);
    const edges = [0, 1, 2].map((k) => cross3(corners[(k + 1) % 3], corners[(k + 2) % 3]));
    const volume = dot3(corners[0], edges[0]);
    const sides = edges.map((edge) => Math.sign(volume) * dot3(edge, ray));
    const total = sides[0] + sides[1] + sides[2];
    if (!(total > 0 && sides.every((side) => side >= 0))) continue;
    const travel = Math.abs(volume) / total;
    if (travel < nearest.travel) nearest = { travel, numbers, corners, weights: sides.map((s) => s / total) };
  }
  if (nearest.travel === Infinity) return { found: false, point: [0, 0, 0], normal: [0, 0, 1] };
  const point = plus3(eye, scaled3(nearest.travel, ray));
  return { found: true, point, normal: seenNormal(mesh, nearest, ray) };
}

const pointOf = (list, number) => [list[3 * number], list[3 * number + 1], list[3 * number + 2]];

function seenNormal(mesh, { numbers, corners, weights }, ray) {
  const facet = cross3(minus3(corners[1], corners[0]), minus3(corners[2], corners[0]));
  let n = numbers.reduce(
    (sum, number, k) => plus3(sum, scaled3(weights[k], pointOf(mesh.normals, number))),
    [0, 0, 0],
  );
  n = norm3(n) > 1e-12 ? n : facet;
  n = scaled3(1 / Math.max(norm3(n), 1e-300), n);
  if (dot3(facet, ray) > 0) n = scaled3(-1, n);
  const o = scaled3(-1 / norm3(ray), ray);
  const cosine = dot3(n, o);
  if (cosine < LEAST_COSINE) n = plus3(n, scaled3(LEAST_COSINE - cosine, o));
  return scaled3(1 / norm3(n), n);
}
