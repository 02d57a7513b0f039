// Pixels to rays, and how many samples a pixel needs. The twin of picture/model/view.py,
// pixel_sampling.py and light.py: what depends on the view, the lamp and sigma_N.
//
// A side is one of drawing.sides, numbers are drawing.numbers, an eye and a lamp are of settings.

import { contains, meet } from "./shape.js";
import {
  cross3, dot3, float32, minus3, norm3, plus3, polarPoint, radians, scaled3,
} from "./vectors.js";

/** The eye's frame, rounded to float32 so that every renderer starts from the same numbers. */
export class View {
  /** size: [width, height] in pixels. */
  static of(shape, eye, size, numbers) {
    const place = polarPoint(eye);
    const distance = norm3(place);
    const forward = place.map((x) => -x / distance);
    const azimuth = radians(eye.azimuth_deg);
    const right = [Math.cos(azimuth), 0, -Math.sin(azimuth)];
    const up = cross3(right, forward);
    const [width, height] = size;
    const extent = extentOf(shape, place, right, up, forward);
    let step;
    if (eye.field_of_view_deg === null || eye.field_of_view_deg === undefined) {
      const [across, tall] = extent ?? numbers.WIDE;
      step = Math.max(across / width, tall / height) / numbers.FILL;
    } else {
      step = (2 * Math.tan(0.5 * radians(eye.field_of_view_deg))) / height;
    }
    const shift = float32([eye.shift_right, eye.shift_up]);
    const view = new View();
    view.eye_m = float32(place);
    view.right = float32(right);
    view.up = float32(up);
    view.forward = float32(forward);
    view.pixelStep = Math.fround(step);
    view.shift = shift;
    view.size = [width, height];
    view.bounds = boundsOf(shape, place, [right, up, forward], extent, step, shift, size, numbers);
    return view;
  }

  /** The ray through a place of the picture; whole numbers are centres of pixels, row 0 the top. */
  rayAt(column, row) {
    const [width, height] = this.size;
    const x = (column + 0.5 * (1 - width)) * this.pixelStep + this.shift[0];
    const y = (row + 0.5 * (1 - height)) * this.pixelStep - this.shift[1];
    const { forward, right, up } = this;
    return [0, 1, 2].map((k) => forward[k] + x * right[k] - y * up[k]);
  }

  /** The uniforms of view.glsl: picture/gpu/uniforms.py `view_uniforms`, without the lamps. */
  uniforms(shape, afar) {
    let step = 1;
    let eye_m = this.eye_m;
    if (afar) {
      step = -(dot3(this.eye_m, this.forward) / dot3(this.forward, this.forward));
      eye_m = plus3(this.eye_m, scaled3(step, this.forward));
    }
    return {
      lowest_row: 0,
      eye_m,
      view_right: scaled3(step, this.right),
      view_up: scaled3(step, this.up),
      view_forward: scaled3(step, this.forward),
      pixel_step: this.pixelStep,
      view_shift: this.shift,
      size_px: this.size,
      half_extent_m: shape.half_extent_m,
    };
  }
}

/** The eye that frames the objects of a drawing, each as large beside the other as it would be. */
export function atOneScale({ one_form, sides, numbers }, eye, size) {
  if (one_form || (eye.field_of_view_deg ?? null) !== null) return eye;
  const steps = Object.values(sides).map(({ shape }) => View.of(shape, eye, size, numbers).pixelStep);
  const half = 0.5 * size[1] * Math.max(...steps);
  return { ...eye, field_of_view_deg: (360 / Math.PI) * Math.atan(half) };
}

/** Whether float32 rays from the eye would blur the object by a visible share of a pixel. */
export function fromAfar(shape, eye, numbers) {
  if (!shape.analytic) return false;
  const place = polarPoint(eye);
  const edgeOn =
    shape.kind === "plane" && Math.abs(place[2]) < numbers.EDGE_ON * eye.distance_m;
  if (edgeOn || contains(shape, place)) return false;
  if (shape.curved && eye.distance_m > numbers.AFAR_RADII * shape.half_extent_m[0]) return true;
  return View.of(shape, eye, [1, 1], numbers).pixelStep < numbers.NARROW;
}

/** Whether the eye is above or below a cylinder: picture/gpu/variant.py `_sees_a_cap`. */
export function seesACap(shape, eye) {
  if (shape.kind !== "cylinder") return false;
  return Math.fround(Math.abs(polarPoint(eye)[1])) > Math.fround(shape.half_extent_m[1]);
}

function outlineOf(shape) {
  if (shape.outline_m) return shape.outline_m;
  const [x, y, z] = shape.half_extent_m;
  const points = [];
  if (shape.kind === "cylinder") {
    for (const side of [1, -1]) {
      for (let k = 0; k < 180; k++) {
        const turn = k * ((2 * Math.PI) / 180);
        points.push([Math.sin(turn) * x, side * y, Math.cos(turn) * z]);
      }
    }
    return points;
  }
  for (const sx of [-1, 1]) {
    for (const sy of [-1, 1]) for (const sz of [-1, 1]) points.push([sx * x, sy * y, sz * z]);
  }
  return points;
}

function extentOf(shape, eye, right, up, forward) {
  const distance = norm3(eye);
  if (shape.kind === "sphere") {
    const radius = shape.half_extent_m[0];
    if (distance <= radius) return null;
    const angle = (2 * radius) / Math.sqrt(distance ** 2 - radius ** 2);
    return [angle, angle];
  }
  let across = 0;
  let tall = 0;
  for (const point of outlineOf(shape)) {
    const way = minus3(point, eye);
    const depth = dot3(way, forward);
    if (depth <= 1e-6) return null;
    across = Math.max(across, Math.abs(dot3(way, right)) / depth);
    tall = Math.max(tall, Math.abs(dot3(way, up)) / depth);
  }
  return [2 * across, 2 * tall];
}

/** Whether a rim comes so near the eye that its points no longer bound its outline. */
function isClose(shape, place, forward) {
  if (shape.kind !== "cylinder") return false;
  let nearest = Infinity;
  for (const point of outlineOf(shape)) {
    nearest = Math.min(nearest, dot3(minus3(point, place), forward));
  }
  return nearest < 0.25 * shape.half_extent_m[0];
}

function boundsOf(shape, place, frame, extent, step, shift, size, numbers) {
  if (extent === null || isClose(shape, place, frame[2])) return [0, 0, size[0], size[1]];
  const [right, up, forward] = frame.map(float32);
  const away = scaled3(-1, float32(place));
  const depth = dot3(away, forward);
  const centres = [dot3(away, right) / depth, dot3(away, up) / depth];
  const [[left, rightPx], [bottom, top]] = [0, 1].map((k) => {
    const centre = 0.5 * size[k] + (centres[k] - shift[k]) / step;
    const half = (0.5 * extent[k]) / step;
    const reach =
      half * (1 + numbers.BOUNDS_EXCESS) + numbers.BOUNDS_MARGIN_PX + numbers.ROUNDING / step;
    const clip = (x) => Math.min(Math.max(x, 0), size[k]);
    return [Math.floor(clip(centre - reach)), Math.ceil(clip(centre + reach))];
  });
  return [left, bottom, rightPx, top];
}

/** The lamps that give light, the main one first: {position_m, radius_m, distance_m, share}. */
export function lampsOf(side, lamp) {
  const main = {
    position_m: polarPoint(lamp),
    radius_m: side.lamp.radius_m,
    distance_m: lamp.distance_m,
    share: 1,
  };
  return [main, ...side.further_lamps];
}

const MOST_FURTHER_LAMPS = 3;

/** picture/gpu/uniforms.py `lamp_uniforms`. */
export function lampUniforms(lamps) {
  const uniforms = { lamp_m: lamps[0].position_m };
  if (lamps.length > 1) {
    const places = new Array(4 * MOST_FURTHER_LAMPS).fill(0);
    lamps.slice(1).forEach((lamp, k) => {
      [...lamp.position_m, lamp.share].forEach((x, n) => (places[4 * k + n] = x));
    });
    uniforms.further_lamps = places;
  }
  if (lamps.some((lamp) => lamp.radius_m > 0)) {
    const radius2 = new Array(1 + MOST_FURTHER_LAMPS).fill(0);
    lamps.forEach((lamp, k) => (radius2[k] = lamp.radius_m ** 2));
    uniforms.lamp_radius2 = radius2;
  }
  return uniforms;
}

/** The largest sigma_N of a side's finishes, degrees; its own where it has none. */
export function grainiest(side, sigmaNDeg) {
  if (side.own_sigma_n_deg.length === 0) return sigmaNDeg;
  return Math.max(...side.own_sigma_n_deg.map((own) => own ?? sigmaNDeg));
}

/** Draws of a grain of one size at the eye along each side of a pixel. */
export function eyeGrainSamples(side, display, sigmaNDeg, numbers) {
  if (grainiest(side, sigmaNDeg) === 0 || side.look.grain !== "eye") return 1;
  const pixels = display.pixel_arcmin / side.look.grain_arcmin;
  return pixels <= numbers.PIXELS_A_GRAIN ? 1 : Math.min(numbers.MAX_SAMPLES, Math.ceil(pixels));
}

/** Samples along each side of a pixel: the look's, or as many as the narrowest lobe needs. */
export function sampleCount(side, display, settings, sigmaNDeg, size, numbers) {
  const count = side.look.samples ?? samplesNeeded(side, settings, size, numbers);
  const grains = eyeGrainSamples(side, display, sigmaNDeg, numbers);
  return grains * Math.ceil(count / grains);
}

function depthOf(shape, eye) {
  const away = eye.distance_m;
  let nearest = shape.half_extent_m[shape.curved ? 0 : 2];
  if (shape.outline_m) {
    const place = polarPoint(eye);
    nearest = -Infinity;
    for (const point of shape.outline_m) nearest = Math.max(nearest, dot3(point, place));
    nearest /= away;
  }
  return Math.max(away - nearest, 1e-3 * away);
}

/** Samples along each side of a pixel that keep the energy of the narrowest lobe. */
export function samplesNeeded(side, settings, size, numbers) {
  if (side.narrowest_s === null) return 1;
  const needed = lampsOf(side, settings.lamp).map((lamp) =>
    neededFor(side, settings.eye, lamp, size, numbers),
  );
  return Math.max(...needed);
}

function neededFor(side, eye, lamp, size, numbers) {
  const { shape } = side;
  const away = lamp.distance_m;
  const depth = depthOf(shape, eye);
  const acrossM = View.of(shape, eye, size, numbers).pixelStep * depth;
  let turn = 0.5 * acrossM * (1 / depth + 1 / away);
  const bent = shape.curvature_per_m;
  if (shape.curved || bent > 0) {
    const cosine = dot3(polarPoint(eye), lamp.position_m) / (eye.distance_m * away);
    const cosHalf = Math.sqrt(Math.max(0.5 * (1 + cosine), 0.01));
    turn += shape.outline_m
      ? (acrossM * bent) / cosHalf
      : acrossM / (shape.half_extent_m[0] * cosHalf);
  }
  let narrowest = side.narrowest_s;
  if (lamp.radius_m > 0) {
    narrowest = Math.hypot(narrowest, 0.25 * Math.atan2(lamp.radius_m, away));
  }
  const needed = turn / (numbers.STEP_SD * narrowest);
  return Math.max(1, Math.min(numbers.MAX_SAMPLES, Math.ceil(needed)));
}

/** What the perfect diffuser shows at the point that faces the eye: light.py `front_white`. */
export function frontWhite(hit, lamps) {
  if (!hit.found) return 0;
  return lamps.reduce((sum, lamp) => {
    const way = minus3(lamp.position_m, hit.point);
    const distance2 = dot3(way, way);
    if (distance2 <= 0) return sum;
    let seen = lamp.share * Math.max(dot3(hit.normal, way) / distance2 ** 1.5, 0);
    if (lamp.radius_m > 0) seen *= distance2 / (distance2 + lamp.radius_m ** 2);
    return sum + seen;
  }, 0);
}

/** Where the ray through the picture's axis meets an analytic shape. */
export function frontHit(shape, view) {
  return meet(shape.kind, view.eye_m, view.forward, shape.half_extent_m);
}

/** The white, or 0 where the lamps light nothing or only graze the object. */
export function litWhite(white, lamps, numbers) {
  const limit = lamps.reduce(
    (sum, lamp) =>
      sum +
      (lamp.share * numbers.GRAZING_COSINE) /
        (dot3(lamp.position_m, lamp.position_m) + lamp.radius_m ** 2),
    0,
  );
  return Number.isFinite(white) && white > limit ? white : 0;
}

/** What the lamps' power is, so that they give their share of Y_n; 0 where they light nothing. */
export function lampsIrradiance(white, side) {
  return white > 0 ? (Math.PI * (1 - side.ambient)) / white : 0;
}

/** Steps of the lattice from one texel of the grain's field to the next. */
export function fieldStep(side, display, sigmaNDeg, numbers) {
  const texel = display.pixel_arcmin / eyeGrainSamples(side, display, sigmaNDeg, numbers);
  return Math.fround((numbers.CELL_STEPS * texel) / side.look.grain_arcmin);
}

/** Texels of the field of tilts: one for each draw of the grain, as far as they don't repeat. */
export function fieldSize(side, display, sigmaNDeg, size, numbers) {
  const samples = eyeGrainSamples(side, display, sigmaNDeg, numbers);
  return size.map((length) => Math.min(samples * length, numbers.FIELD_TILE));
}

/** picture/gpu/uniforms.py `grain_uniforms`, or NO_GRAIN of a smooth surface. */
export function grainUniforms(side, display, sigmaNDeg, size, numbers, hasNoise) {
  const none = { sigma_n: 0, grains_per_px: 1, grain_m: 1, seed: 0 };
  if (!hasNoise) return none;
  const { look } = side;
  const sigma_n = radians(grainiest(side, sigmaNDeg));
  if (look.grain !== "eye") {
    return {
      sigma_n,
      grains_per_px: 1 / look.grain_px,
      grain_m: look.grain_mm * 1e-3,
      seed: look.seed,
    };
  }
  const [width, height] = fieldSize(side, display, sigmaNDeg, size, numbers);
  return {
    ...none,
    sigma_n,
    seed: look.seed,
    field_step: fieldStep(side, display, sigmaNDeg, numbers),
    grain_samples: eyeGrainSamples(side, display, sigmaNDeg, numbers),
    per_field: [1 / width, 1 / height],
  };
}
