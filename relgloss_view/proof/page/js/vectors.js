// Vectors of three numbers, in the order of operations that numpy has.

export const dot3 = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
export const norm3 = (a) => Math.sqrt(dot3(a, a));
export const scaled3 = (factor, a) => [factor * a[0], factor * a[1], factor * a[2]];
export const plus3 = (a, b) => [a[0] + b[0], a[1] + b[1], a[2] + b[2]];
export const minus3 = (a, b) => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
export const cross3 = (a, b) => [
  a[1] * b[2] - a[2] * b[1],
  a[2] * b[0] - a[0] * b[2],
  a[0] * b[1] - a[1] * b[0],
];
/** The numbers that a GPU starts from, so that all draw the same scene. */
export const float32 = (vector) => vector.map(Math.fround);
export const radians = (degrees) => degrees * (Math.PI / 180);

/** World position at an azimuth, elevation and distance: scene/setup.py `polar_point`. */
export function polarPoint({ azimuth_deg, elevation_deg, distance_m }) {
  const azimuth = radians(azimuth_deg);
  const elevation = radians(elevation_deg);
  const across = distance_m * Math.cos(elevation);
  return [
    across * Math.sin(azimuth),
    distance_m * Math.sin(elevation),
    across * Math.cos(azimuth),
  ];
}
