// Surface: what each place of a picture sees of triangles, or of a shape with finishes. The twin of
// picture/gpu/surface.py; it depends on the view, the form and what is printed, and on nothing else.

import { Unsupported } from "./device.js";
import { finishLook, finishTables } from "./finishes.js";
import { layersOf, valuesOf } from "./layers.js";
import { TriangleBuffer, hidesBacks, meetMesh, meshOf, meshTextures, projection } from "./mesh.js";
import { drawCoverage } from "./mesh_edges.js";
import { printedTextures } from "./printed.js";

const meshes = new WeakMap(); // of a drawing's JSON, so that both sides share one

/** The form of a side, without what is printed on it; null where rays meet its shape. */
export async function openForm(device, drawing, name) {
  const side = drawing.sides[name];
  const { surface } = side;
  if (!surface) return null;
  if (surface.targets.length > device.gl.getParameter(device.gl.MAX_DRAW_BUFFERS)) {
    throw new Unsupported("few targets");
  }
  const content = surface.mesh === "reference" ? drawing.sides.reference.surface.mesh : surface.mesh;
  if (content && !meshes.has(content)) meshes.set(content, meshOf(content));
  const mesh = content && (await meshes.get(content));
  if (mesh) side.shape.outline_m = mesh.outline_m;
  return new Form(side, drawing.numbers, mesh);
}

/** What a side's surface is drawn from: its mesh and its layers, and their copies on the device. */
class Form {
  constructor(side, numbers, mesh) {
    Object.assign(this, { side, numbers, mesh, targets: side.surface.targets });
    this.layers = this.partTable = null;
    this._held = null;
  }

  /** Decode what is printed; files: of the content. */
  async print(files) {
    const { printed } = this.side.surface;
    if (!printed) return;
    this.layers = await layersOf(printed, files);
    this.partTable = await valuesOf(printed.part_table);
  }

  /** A surface of this form, for one picture. */
  surface(device) {
    return new Surface(device, this);
  }

  /** Forget what a lost context took. */
  forget() {
    this._held = null;
  }

  /** The copies on the device, made when first asked for: {triangles, uniforms, scaledDown}. */
  on(device) {
    if (this._held) return this._held;
    const held = { triangles: null, uniforms: {}, scaledDown: 1 };
    if (this.mesh) {
      held.triangles = new TriangleBuffer(device, this.mesh);
      held.uniforms = meshTextures(device, this.mesh);
    }
    if (this.layers) {
      const { printed } = this.side.surface;
      const { uniforms, first } = printedTextures(device, this.layers, printed);
      const part_table = device.texture(this.partTable.length / 4, 1, "rgba32f", this.partTable);
      Object.assign(held.uniforms, uniforms, { part_table }, printed.uniforms);
      held.scaledDown = 2 ** first;
    }
    this._held = held;
    return held;
  }
}

/** The surface of one picture, as it was last drawn: what passes.js asks of a side's pack or triangles. */
class Surface {
  constructor(device, form) {
    this.device = device;
    this.form = form;
    this.drawn = 0; // how often a tile was drawn
    this._clean();
  }

  /** What a picture of the form follows from, beside the view: it never changes. */
  key() {
    return "form";
  }

  formKey() {
    return "form";
  }

  /** The constants of pass 1 under a lamp. */
  defines({ lampName }) {
    return finishTables(this.form.side, lampName);
  }

  /** [[stage, constants], ...] that the surface of a picture is drawn by. */
  stages(request) {
    const surface = ["surface.frag", this._defines(request)];
    return this.form.mesh ? [["mesh.frag", {}], surface] : [surface];
  }

  _defines({ variant, seen }) {
    return { ...variant.surface_pass, ...seen, ...this.form.side.surface.defines };
  }

  /** The numbers of the material, or of the finishes. */
  material({ sigmaNDeg, lampName }) {
    const { side } = this.form;
    const look = side.finish_k ? finishLook(side, sigmaNDeg) : {};
    return { ...side.material, ...side.colours[lampName], ...look };
  }

  /** Where the ray through the picture's axis meets the mesh; undefined of analytic forms. */
  frontHit({ view }) {
    const { mesh } = this.form;
    return mesh ? meetMesh(mesh, view.eye_m, view.forward) : undefined;
  }

  /** (bounds) -> the tiles of a part of a picture, [box, uniforms that read it] each; one holds until the next. */
  tiles(request) {
    return (bounds) => this._tiles(request, bounds);
  }

  *_tiles(request, [left, bottom, right, top]) {
    const { view } = request;
    const samples = request.variant.shade.SAMPLED ? request.samples : 1;
    const [width, height] = this.tileSize(view.size, samples);
    for (let low = Math.floor(bottom / height) * height; low < top; low += height) {
      for (let first = Math.floor(left / width) * width; first < right; first += width) {
        const tile = [first, low, first + width, low + height];
        const inside = [
          Math.max(first, left), Math.max(low, bottom),
          Math.min(tile[2], right), Math.min(tile[3], top),
        ];
        yield [inside, this._tile(request, tile, samples)];
      }
    }
  }

  /** Width and height of the tiles, pixels: the whole picture where it fits. */
  tileSize(size, samples) {
    const texels = this.form.side.surface.most_texels;
    const most = Math.max(1, Math.floor(this.device.maxSize / samples));
    const width = Math.min(size[0], most, Math.max(1, Math.floor(texels / samples ** 2)));
    const fitting = Math.max(1, Math.floor(texels / (samples ** 2 * width)));
    return [width, Math.min(size[1], most, fitting)];
  }

  // Draw a tile unless it is held; what reads it.
  _tile(request, tile, samples) {
    const { view, seenFrom } = request;
    const { device, form } = this;
    const size = [samples * (tile[2] - tile[0]), samples * (tile[3] - tile[1])];
    const [left, bottom] = [samples * tile[0], samples * tile[1]];
    const where = {
      surface_from: [left, bottom],
      per_surface: size.map((side) => 1 / side),
      samples,
    };
    const defines = this._defines(request);
    const key = JSON.stringify([seenFrom, defines, tile, samples]);
    if (key !== this._key) {
      this._key = null;
      this._makeRoom(size);
      const held = form.on(device);
      const reached = reachedPart(tile, view.bounds);
      const box = reached.map((place, k) => samples * place - (k % 2 ? bottom : left));
      const inputs = { ...seenFrom, ...where, ...held.uniforms };
      if (form.mesh) inputs.triangle_image = this._drawTriangles(held.triangles, view, tile, box, samples);
      device.draw({ stage: "surface.frag", defines, uniforms: inputs, target: this._target, scissor: box });
      this._key = key;
      this.drawn += 1;
    }
    const { targets } = form;
    return { ...where, ...Object.fromEntries(targets.map((name, k) => [name, this._target.textures[k]])) };
  }

  _makeRoom(size) {
    if (this._target && this._target.width === size[0] && this._target.height === size[1]) return;
    this.release();
    const { device, form } = this;
    const [width, height] = size;
    const textures = form.targets.map(() => device.texture(width, height, "rgba32f"));
    this._target = device.target(textures);
    if (form.mesh) {
      this._depth = device.depthBuffer(width, height);
      this._triangles = device.target([device.texture(width, height, "r32f")], this._depth);
    }
  }

  _drawTriangles(triangles, view, tile, box, samples) {
    const { device, form } = this;
    const { gl } = device;
    clearBox(gl, this._triangles, box);
    device.draw({
      stage: "mesh.frag",
      uniforms: projection(form.mesh, view, tile, samples),
      target: this._triangles,
      scissor: box,
      geometry: triangles,
      depth: "<",
      culls: hidesBacks(form.mesh, view),
    });
    return this._triangles.textures[0];
  }

  /** Draw the coverage target of passes.js, for smooth silhouettes. */
  coverage({ view }, passes) {
    const { device, form } = this;
    const depth = device.depthBuffer(view.size[0], view.size[1]);
    const texture = passes.target(["coverage"]).textures[0];
    const target = device.target([texture], depth);
    try {
      const { triangles } = form.on(device);
      drawCoverage(device, target, form.mesh, triangles, view, form.numbers.EDGE_RAYS);
    } finally {
      device.releaseTarget(target, { textures: false });
      device.gl.deleteRenderbuffer(depth.handle);
    }
  }

  _clean() {
    this._target = null;
    this._triangles = null;
    this._depth = null;
    this._key = null;
  }

  /** Free the targets; the mesh and the artwork stay with the form. */
  release() {
    const { device } = this;
    if (this._target) device.releaseTarget(this._target);
    if (this._triangles) device.releaseTarget(this._triangles);
    if (this._depth) device.gl.deleteRenderbuffer(this._depth.handle);
    this._clean();
  }

  /** Forget what a lost context took. */
  forget() {
    this._clean();
  }
}

// The part of a tile that the object can reach.
function reachedPart(tile, bounds) {
  const low = [0, 1].map((k) => Math.max(tile[k], bounds[k]));
  const high = [2, 3].map((k) => Math.max(low[k - 2], Math.min(tile[k], bounds[k])));
  return [...low, ...high];
}

// Nothing is seen, and all is far away, in a box of a target.
function clearBox(gl, target, [left, bottom, right, top]) {
  gl.bindFramebuffer(gl.FRAMEBUFFER, target.framebuffer);
  gl.enable(gl.SCISSOR_TEST);
  gl.scissor(left, bottom, right - left, top - bottom);
  gl.clearBufferfv(gl.COLOR, 0, [0, 0, 0, 0]);
  gl.clearBufferfv(gl.DEPTH, 0, [1]);
}
