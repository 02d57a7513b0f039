// Where rays meet the four analytic shapes, in float64. The twin of picture/model/shape.py `meet`
// and of pack/shape.py `contains`; halves: half_extent_m.

import { cross3, dot3, minus3, norm3, plus3, scaled3 } from "./vectors.js";

const MISSED = { found: false, point: [0, 0, 0], normal: [0, 0, 1] };

function meetCylinder(eye, ray, halves) {
  const [radius, halfHeight] = halves;
  const [dx, dy, dz] = ray;
  const length2 = dx * dx + dz * dz;
  const moment = eye[0] * dz - eye[2] * dx;
  const discriminant = radius * radius * length2 - moment * moment;
  if (length2 > 0 && discriminant >= 0) {
    const root = Math.sqrt(discriminant);
    const travel = (-(eye[0] * dx + eye[2] * dz) - root) / length2;
    const y = eye[1] + travel * dy;
    if (travel > 0 && Math.abs(y) <= halfHeight) {
      const nx = (moment * dz - root * dx) / (length2 * radius);
      const nz = (-moment * dx - root * dz) / (length2 * radius);
      return { found: true, point: [nx * radius, y, nz * radius], normal: [nx, 0, nz] };
    }
  }
  if (Math.abs(eye[1]) <= halfHeight || dy === 0) return MISSED;
  const cap = eye[1] > 0 ? halfHeight : -halfHeight;
  const travel = (cap - eye[1]) / dy;
  const x = eye[0] + travel * dx;
  const z = eye[2] + travel * dz;
  if (!(travel > 0 && x * x + z * z <= radius * radius)) return MISSED;
  return { found: true, point: [x, cap, z], normal: [0, Math.sign(cap), 0] };
}

function meetSphere(eye, ray, halves) {
  const radius = halves[0];
  const length2 = dot3(ray, ray);
  const moment = cross3(eye, ray);
  const discriminant = radius * radius * length2 - dot3(moment, moment);
  const root = Math.sqrt(Math.max(discriminant, 0));
  if (!(discriminant >= 0 && -dot3(ray, eye) - root > 0)) return MISSED;
  const n = scaled3(1 / (length2 * radius), minus3(cross3(ray, moment), scaled3(root, ray)));
  const normal = scaled3(1 / norm3(n), n);
  return { found: true, point: scaled3(radius, normal), normal };
}

function meetPlane(eye, ray, halves) {
  if (!(eye[2] > 0 && ray[2] < 0)) return MISSED;
  const travel = -eye[2] / ray[2];
  const x = eye[0] + travel * ray[0];
  const y = eye[1] + travel * ray[1];
  if (!(Math.abs(x) <= halves[0] && Math.abs(y) <= halves[1])) return MISSED;
  return { found: true, point: [x, y, 0], normal: [0, 0, 1] };
}

function meetBox(eye, ray, halves) {
  for (let axis = 0; axis < 3; axis++) {
    const side = eye[axis] > 0 ? 1 : -1;
    if (Math.abs(eye[axis]) <= halves[axis] || !(ray[axis] * side < 0)) continue;
    const travel = (side * halves[axis] - eye[axis]) / ray[axis];
    const point = plus3(eye, scaled3(travel, ray));
    point[axis] = side * halves[axis];
    if (travel > 0 && point.every((x, k) => Math.abs(x) <= halves[k])) {
      return { found: true, point, normal: [0, 1, 2].map((k) => (k === axis ? side : 0)) };
    }
  }
  return MISSED;
}

const MEET = { cylinder: meetCylinder, sphere: meetSphere, plane: meetPlane, box: meetBox };

/** The first point of a shape along a ray from the eye: {found, point, normal}. */
export const meet = (kind, eye, ray, halves) => MEET[kind](eye, ray, halves);

/** Whether a point is inside a shape; a plane has no inside. */
export function contains({ kind, half_extent_m: halves }, [x, y, z]) {
  const radius = halves[0];
  if (kind === "plane") return false;
  if (kind === "sphere") return x * x + y * y + z * z <= radius * radius;
  if (kind === "cylinder") return x * x + z * z <= radius * radius && Math.abs(y) <= halves[1];
  return [x, y, z].every((v, k) => Math.abs(v) <= halves[k]);
}
