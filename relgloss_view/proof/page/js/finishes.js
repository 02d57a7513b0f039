// The finishes of a pack as the numbers that finishes.glsl takes: what sigma_N and the lamp's spectrum move.

import { radians } from "./vectors.js";

/** sigma_N (radians) and k of each finish: picture/gpu/finishes.py `look_uniforms`. */
export function finishLook(side, sigmaNDeg) {
  const pairs = side.own_sigma_n_deg.map((own, n) => [radians(own ?? sigmaNDeg), side.finish_k[n]]);
  return { finish_look: pairs.flat() };
}

/** The constants of the finishes under a lamp's spectrum; none of a side without a pack. */
export const finishTables = (side, lampName) => side.finish_tables?.[lampName] ?? {};
