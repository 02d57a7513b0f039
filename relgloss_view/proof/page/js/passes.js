// The passes of one picture, and which of them still hold. The twin of picture/gpu/passes.py,
// shading.py, held.py, targets.py and asked.py: only what changed is drawn again.

import { Held } from "./held.js";
import { NOTHING_SEEN } from "./pair.js";
import { Reduction } from "./reduction.js";
import { TILE_VERTICES, edgePixels, edgeTiles, fromBottom, vertexList } from "./silhouette.js";
import {
  View, fieldSize, fromAfar, frontHit, frontWhite, grainUniforms, grainiest, lampUniforms, lampsOf,
  lampsIrradiance, litWhite, sampleCount, seesACap,
} from "./view.js";

const TARGET_KINDS = {
  diffuse_weights: "rg32f",
  specular_weights: "rg32f",
  grain_field: "rg32f",
  display: "rgba8",
  coverage: "r8",
};
// What says that a pixel shows nothing of the object, for a pass that draws inside its bounds only.
const OFF_TARGETS = ["diffuse_weights", "split"]; // their first number is OFF_OBJECT
const CLEARED_TARGETS = [
  "diffuse", "specular", "diffuse_weights", "specular_weights", "metal_weights", "split", "coverage",
];

export class Passes {
  /**
   * drawing: of the proof, its arrays unpacked. name: of the side. surface: for packs and forms of
   * triangles, null where rays meet the shape. It gives, of a request:
   *   defines: constants over those of the variant (FINISH_TABLES of the lamp)
   *   material: the uniforms of its finishes
   *   key, formKey: JSON of what pass 1, and the view of its form alone, depend on beside them
   *   tiles(request, passes): (bounds) -> [[box, uniforms], ...], drawing the surface of each
   *   coverage(request, passes): draws the target "coverage" of a form of triangles
   *   frontHit: {found, point, normal} on the picture's axis; release, forget
   */
  constructor(device, drawing, name, surface = null) {
    this.device = device;
    this.drawing = drawing;
    this.side = drawing.sides[name];
    this.numbers = drawing.numbers;
    this.display = drawing.display;
    this.surface = surface;
    this.reduction = new Reduction(device);
    this.held = new Held();
    this.draws = {}; // how often each pass was drawn
    this._textures = {};
    this._targets = {};
    this._size = null;
    this._lists = { tiles: null, edges: null };
    this._albedos = null;
    this._clean();
  }

  _clean() {
    this.held.clear();
    this._around = {};
    this._white = 0;
    this._objectPixels = 0;
    this._extremes = NOTHING_SEEN;
  }

  /** What a picture is asked to be; settings of a proof, size [width, height]. */
  request(settings, name, size) {
    const { side, display, numbers } = this;
    const sigmaNDeg = settings[name].sigma_n_deg;
    const samples = sampleCount(side, display, settings, sigmaNDeg, size, numbers);
    const grain = grainiest(side, sigmaNDeg) > 0 ? "grainy" : "smooth";
    const variant = side.variants[`${grain} ${samples > 1 ? "several" : "one"}`];
    const afar = side.shape.analytic ? fromAfar(side.shape, settings.eye, numbers) : true;
    const seen = side.shape.analytic
      ? { AFAR: Number(afar), CAPS: Number(seesACap(side.shape, settings.eye)) }
      : {};
    const view = View.of(side.shape, settings.eye, size, numbers);
    const lamps = lampsOf(side, settings.lamp);
    return {
      settings, size, sigmaNDeg, samples, variant, afar, seen, view, lamps,
      lampName: settings.lamp.illuminant,
      seenFrom: { ...view.uniforms(side.shape, afar), samples },
      lampNumbers: lampUniforms(lamps),
    };
  }

  /** Draw what no longer holds of pass 1 and the split; {extremes, white, objectPixels}. */
  light(request) {
    this._makeRoom(request.size);
    try {
      return this._drawLight(request);
    } catch (error) {
      this._clean(); // a pass that failed half way was not drawn
      throw error;
    }
  }

  /** Scale by c and show, with smooth silhouettes or not; returns whether there was anything to draw. */
  tone(request, c, edged = true) {
    try {
      return this._drawTone(request, c, edged);
    } catch (error) {
      this._clean();
      throw error;
    }
  }

  /** The constants of pass 1. */
  shadeDefines(request) {
    const { variant, seen } = request;
    const further = this.surface?.defines?.(request) ?? {};
    return { ...variant.shade, ...further, ...seen };
  }

  _drawLight(request) {
    const { variant, view } = request;
    const uniforms = this._uniforms(request);
    const defines = this.shadeDefines(request);
    if (variant.reads_field) this._drawField(request, uniforms);
    const form = this.surface?.key(request) ?? null;
    if (this.held.renew("shade", defines, request.size, uniforms, form)) {
      const inputs = this._inputs(request, uniforms);
      const tiles = this._tiles(request);
      this.draw("shade", "shade.frag", defines, inputs, variant.targets, view.bounds, { tiles });
    }
    if (!variant.splits && this.held.renew("split")) {
      const [diffuse_image, specular_image] = variant.targets.map((name) => this._textures[name]);
      const inputs = {
        ...this._inputs(request, uniforms), diffuse_image, specular_image,
        per_size: perSize(request.size),
      };
      this.draw("split", "split.frag", variant.split, inputs, ["split"], view.bounds);
    }
    if (this.held.renew("extremes")) {
      this._extremes = this.reduction.extremes(this._textures.split, view.bounds);
    }
    return {
      extremes: this._extremes, white: request.white, objectPixels: this._objectPixels,
    };
  }

  /** All numbers of pass 1: picture/gpu/shading.py `shading_of`. */
  _uniforms(request) {
    const { side, display, numbers } = this;
    request.white = this._whiteOf(request);
    return {
      ...request.seenFrom,
      ...request.lampNumbers,
      ...grainUniforms(
        side, display, request.sigmaNDeg, request.size, numbers, request.variant.has_noise,
      ),
      ...(this.surface?.material
        ? this.surface.material(request)
        : { ...side.material, ...side.colours[request.lampName] }),
      ...(side.ambient > 0 ? { ambient: side.ambient } : {}),
      irradiance: lampsIrradiance(request.white, side),
    };
  }

  _inputs(request, uniforms) {
    const field = request.variant.reads_field ? { grain_field: this._textures.grain_field } : {};
    const albedos = this.side.albedo_rows ? { albedo_table: this._albedoTable() } : {};
    return { ...uniforms, ...field, ...albedos };
  }

  _albedoTable() {
    if (!this._albedos) {
      const { shape, values } = this.side.albedo_rows;
      this._albedos = this.device.texture(shape[1], shape[0], "rgba32f", values);
    }
    return this._albedos;
  }

  _tiles(request) {
    return request.variant.surface === "met" ? null : this.surface.tiles(request, this);
  }

  _whiteOf(request) {
    const { variant, view, seen, lamps } = request;
    const defines = { ...variant.white, ...seen };
    const uniforms = { ...request.seenFrom, ...request.lampNumbers };
    const form = this.surface?.formKey?.(request) ?? null;
    if (this.held.renew("white", defines, uniforms, form)) {
      const tiles = this._tiles(request);
      const parts = tiles === null ? [[view.bounds, {}]] : tiles(view.bounds);
      this._white = 0;
      this._objectPixels = 0;
      for (const [bounds, surface] of parts) {
        const [white, pixels] = this.reduction.white(defines, { ...uniforms, ...surface }, bounds);
        this._white = Math.max(this._white, white);
        this._objectPixels += pixels;
      }
      this._count("white");
    }
    let white = this._white;
    if (this.side.lamp.y_n !== "maximum") {
      const hit = this.surface?.frontHit?.(request) ?? frontHit(this.side.shape, view);
      white = frontWhite(hit, lamps);
    }
    return litWhite(white, lamps, this.numbers);
  }

  _drawField(request, { field_step, seed }) {
    const { side, display, numbers } = this;
    const size = fieldSize(side, display, request.sigmaNDeg, request.size, numbers);
    const { field } = request.variant;
    if (!this.held.renew("grain", field, field_step, seed, size)) return;
    const present = this._textures.grain_field;
    if (present && (present.width !== size[0] || present.height !== size[1])) {
      this.device.releaseTarget(this._targets.grain_field);
      delete this._targets.grain_field;
      delete this._textures.grain_field;
    }
    const target = this.target(["grain_field"], size);
    this.device.draw({
      stage: "grain_field.frag", defines: field, uniforms: { field_step, seed }, target,
    });
    this._count("grain");
  }

  _drawTone(request, c, edged) {
    const { size, samples, view } = request;
    const defines = this.display.tone[samples > 1 ? "several" : "one"];
    const smooth = edged && this.display.edges === "smooth" && samples === 1;
    if (smooth) this._findEdges(request);
    if (!this.held.renew("tone", defines, c, smooth)) return false;
    const images = { split_image: this._textures.split };
    if (samples > 1) images.diffuse_image = this._textures.diffuse;
    const uniforms = {
      ...this.display.uniforms, ...images, per_size: perSize(size), lowest_row: 0, c,
    };
    // The surround outside the bounds does not change with c.
    const around = JSON.stringify([defines, view.bounds]);
    const bounds = this._around.tone === around ? view.bounds : null;
    this.draw("tone", "tone.frag", defines, uniforms, ["display"], bounds);
    this._around.tone = around;
    if (smooth && this._lists.edges) {
      const { texture, count } = this._lists.edges;
      const listed = { ...uniforms, edge_list: texture };
      const vertices = { mode: "POINTS", vertices: count };
      this.draw("edges", "edge.frag", this.display.edge, listed, ["display"], null, vertices);
    }
    return true;
  }

  /** The pixels at the silhouette; they are found again where the view has changed. */
  _findEdges(request) {
    const { variant, seen, view, size } = request;
    const defines = { ...variant.shape, ...seen };
    const form = this.surface?.formKey?.(request) ?? null;
    const { samples: _, ...seenFrom } = request.seenFrom;
    if (!this.held.renew("coverage", defines, seenFrom, form)) return;
    this._releaseLists();
    delete this._around.coverage; // so that it is cleared: the tiles are others
    if (this.side.shape.analytic) {
      const tiles = edgeTiles(this.side.shape, view, this.numbers);
      this._lists.tiles = vertexList(this.device, fromBottom(tiles, (side) => size[1] - side));
      if (!this._lists.tiles) return;
      const { texture, count } = this._lists.tiles;
      const uniforms = { ...seenFrom, tile_list: texture, per_size: perSize(size) };
      const vertices = { vertices: TILE_VERTICES * count };
      const target = ["coverage"];
      this.draw("coverage", "coverage.frag", defines, uniforms, target, view.bounds, vertices);
    } else {
      this.surface.coverage(request, this);
      this._count("coverage");
    }
    const bytes = this.device.read(this.target(["coverage"]), 0, view.bounds);
    const pixels = edgePixels(bytes, view.bounds, size[1], this.numbers);
    this.edges = pixels;
    this._lists.edges = vertexList(this.device, fromBottom(pixels, () => size[1] - 1));
  }

  /**
   * Draw a pass inside the bounds of the object; null draws the whole picture. tiles: of the
   * surface that it reads.
   */
  draw(name, stage, defines, uniforms, targets, bounds, { tiles = null, mode, vertices } = {}) {
    const target = this.target(targets);
    for (const one of targets) {
      const key = JSON.stringify(bounds);
      if (CLEARED_TARGETS.includes(one) && this._around[one] !== key) {
        const first = OFF_TARGETS.includes(one) ? this.numbers.OFF_OBJECT : 0;
        this.device.clear(this.target([one]), [first, 0, 0, 0]);
        this._around[one] = key;
      }
    }
    const parts = tiles === null || bounds === null ? [[bounds, {}]] : tiles(bounds);
    for (const [scissor, surface] of parts) {
      this.device.draw({
        stage, defines, uniforms: { ...uniforms, ...surface }, target, scissor, mode, vertices,
      });
    }
    this._count(name);
  }

  /** What a pass that writes these targets draws into; made when first asked for. */
  target(names, size = this._size, depth = null) {
    const key = names.join(" ") + (depth ? " depth" : "");
    if (!this._targets[key]) {
      for (const name of names) {
        const kind = TARGET_KINDS[name] ?? "rgba32f";
        this._textures[name] ??= this.device.texture(size[0], size[1], kind);
      }
      this._targets[key] = this.device.target(names.map((name) => this._textures[name]), depth);
    }
    return this._targets[key];
  }

  /** A target's texture as it was last drawn. */
  texture(name) {
    return this._textures[name];
  }

  get size() {
    return this._size;
  }

  _makeRoom(size) {
    if (this._size && size[0] === this._size[0] && size[1] === this._size[1]) return;
    this.release({ albedos: false });
    this.device.checkSize(size[0], size[1]);
    try {
      this._size = [...size];
      this.target(["split"]);
      this.target(["display"]);
      this.reduction.resize(size);
    } catch (error) {
      this.release({ albedos: false });
      throw error;
    }
  }

  _count(name) {
    this.draws[name] = (this.draws[name] ?? 0) + 1;
  }

  _releaseLists() {
    for (const name of ["tiles", "edges"]) {
      if (this._lists[name]) this.device.releaseTexture(this._lists[name].texture);
      this._lists[name] = null;
    }
    this.edges = [];
  }

  /** Free everything that a size needs; it is drawn again when it is next asked for. */
  release({ albedos = true } = {}) {
    for (const target of Object.values(this._targets)) {
      this.device.releaseTarget(target, { textures: false });
    }
    for (const texture of Object.values(this._textures)) this.device.releaseTexture(texture);
    if (albedos && this._albedos) {
      this.device.releaseTexture(this._albedos);
      this._albedos = null;
    }
    this._targets = {};
    this._textures = {};
    this._releaseLists();
    this.reduction.release();
    this.surface?.release?.();
    this._size = null;
    this._clean();
  }

  /** Forget what a lost context took. */
  forget() {
    this._targets = {};
    this._textures = {};
    this._lists = { tiles: null, edges: null };
    this._albedos = null;
    this._size = null;
    this.reduction.forget();
    this.surface?.forget?.();
    this._clean();
  }
}

const perSize = (size) => [1 / size[0], 1 / size[1]];
