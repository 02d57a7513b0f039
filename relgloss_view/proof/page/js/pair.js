// Scaling of L_s*, alike in both pictures. The twin of picture/frame.py `Scaling.of` and of
// picture/pair.py.

/** Of a proof: the sample that both hold, and the design. Twin: proof/settings.py. */
export const SIDES = ["reference", "test"];

/** The factor of all c, 0 to 1, with which no picture clips; contrasts: [[c, c_max or null], ...]. */
export function commonFactor(contrasts) {
  let factor = 1;
  for (const [c, cMax] of contrasts) {
    if (cMax !== null && c > cMax) factor = Math.min(factor, cMax / c);
  }
  return factor;
}

/** The factor while a hand moves: the present one, unless it clips or is much too small. */
export function heldFactor(needed, present, numbers) {
  if (needed < present) return needed / numbers.RESERVE;
  return present > 0 && needed < numbers.SLACK * present ? present : needed;
}

export const NOTHING_SEEN = {
  smallestRatio: 1e30, lDMax: 0, lSMax: 0, brightestLD: 0, brightestLS: 0, notFinite: 0,
};

/**
 * {c, c_max, notes} of a picture; c: the setting's own, of which factor is taken.
 *
 * c_max is the largest c that keeps L_d* + c L_s* at most 100 in every pixel (Ishii et al., eq. 4);
 * null where no pixel shows a highlight. notes: keys of words.
 */
export function scalingOf(c, extremes, factor, numbers) {
  const own = c * factor;
  if (extremes.notFinite) return { c: own, c_max: null, notes: ["not finite"] };
  if (extremes.lDMax > 100 + numbers.CLIP_TOLERANCE) {
    return { c: own, c_max: null, notes: ["diffuse too bright"] };
  }
  if (extremes.lSMax < numbers.NO_LOBE_LSTAR) return { c: own, c_max: null, notes: [] };
  const cMax = Math.max(extremes.smallestRatio, 0);
  return { c: own, c_max: cMax, notes: own > cMax * (1 + 1e-9) ? ["clipped"] : [] };
}
