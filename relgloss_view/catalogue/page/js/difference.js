// CIEDE2000 colour difference, for the filter by colour. The twin of material/difference.py.

const DEGREE = Math.PI / 180;

/** sqrt(C^7 / (C^7 + 25^7)). */
export function chromaWeight(chroma) {
  const c7 = (chroma / 25) ** 7;
  return Math.sqrt(c7 / (c7 + 1));
}

/** Hue angle, radians, 0 to 2 pi; 0 where a and b are 0. */
export function hue(a, b) {
  const angle = Math.atan2(b, a);
  return angle < 0 ? angle + 2 * Math.PI : angle;
}

/**
 * CIEDE2000 difference of two colours [L*, a*, b*]; all parametric weights are one.
 * Source: Sharma, Wu, Dalal 2005, "The CIEDE2000 color-difference formula: implementation notes".
 */
export function deltaE2000([l1, a1, b1], [l2, a2, b2]) {
  const stretch = 1.5 - 0.5 * chromaWeight(0.5 * (Math.hypot(a1, b1) + Math.hypot(a2, b2)));
  const c1 = Math.hypot(a1 * stretch, b1), c2 = Math.hypot(a2 * stretch, b2);
  const h1 = hue(a1 * stretch, b1), h2 = hue(a2 * stretch, b2);
  const gray = c1 * c2 === 0, apart = Math.abs(h1 - h2) > Math.PI;
  let turn = h2 - h1;
  if (gray) turn = 0;
  else if (apart) turn += turn > 0 ? -2 * Math.PI : 2 * Math.PI;
  const hueDifference = 2 * Math.sqrt(c1 * c2) * Math.sin(0.5 * turn);
  const around = h1 + h2 < 2 * Math.PI ? 2 * Math.PI : -2 * Math.PI;
  const meanHue = gray ? h1 + h2 : 0.5 * (h1 + h2 + (apart ? around : 0));
  const square = (0.5 * (l1 + l2) - 50) ** 2, meanChroma = 0.5 * (c1 + c2);
  const t = 1 - 0.17 * Math.cos(meanHue - 30 * DEGREE) + 0.24 * Math.cos(2 * meanHue)
    + 0.32 * Math.cos(3 * meanHue + 6 * DEGREE) - 0.2 * Math.cos(4 * meanHue - 63 * DEGREE);
  const bump = 30 * Math.exp(-(((meanHue / DEGREE - 275) / 25) ** 2));
  const rotation = -Math.sin(2 * bump * DEGREE) * 2 * chromaWeight(meanChroma);
  const lightness = (l2 - l1) / (1 + (0.015 * square) / Math.sqrt(20 + square));
  const chroma = (c2 - c1) / (1 + 0.045 * meanChroma);
  const huePart = hueDifference / (1 + 0.015 * meanChroma * t);
  const total = lightness ** 2 + chroma ** 2 + huePart ** 2 + rotation * chroma * huePart;
  return Math.sqrt(Math.max(total, 0));
}
