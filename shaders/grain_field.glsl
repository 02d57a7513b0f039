// A smooth random field of tilts over the screen, for grain of one size at the eye.
// Twin: relgloss_view/picture/model/grain_field.py.

#include "noise.glsl"

const int FIELD_FACE = 6;  // of the hash: no face of an object has this number
const int FIELD_TILE = 4096;  // texels, a power of two: the field repeats after so many

// Two independent standard normals that vary smoothly: those of the lattice's points, weighted by
// (1 - r^2 / 4)^3 of their distance r in steps of the lattice, over the root of the summed squares.
vec2 smooth_gaussians(vec2 place, uint seed) {
    vec2 first = floor(place) - 1.0;
    vec2 sum = vec2(0.0);
    float power = 0.0;
    for (int k = 0; k < 16; ++k) {  // no other point is nearer than two steps
        vec2 point = first + vec2(float(k & 3), float(k >> 2));
        vec2 apart = place - point;
        float near = max(1.0 - 0.25 * dot(apart, apart), 0.0);
        float weight = near * near * near;
        uvec3 hash = cell_hash(ivec3(ivec2(point), FIELD_FACE), seed);
        sum += weight * gaussians(uniforms(hash).xy);
        power += weight * weight;
    }
    return sum * inversesqrt(power);
}

// The x with erf(x) = y, for a y from 0 to 1 that is given as 1 - y, by two polynomials (Giles 2012,
// "Approximating the erfinv function", single precision).
float inverse_erf(float one_less) {
    float y = 1.0 - one_less;
    float w = -log(max(one_less, 1e-37) * (1.0 + y));
    float v = w - 2.5;
    float near = 2.81022636e-08;
    near = 3.43273939e-07 + near * v;
    near = -3.5233877e-06 + near * v;
    near = -4.39150654e-06 + near * v;
    near = 0.00021858087 + near * v;
    near = -0.00125372503 + near * v;
    near = -0.00417768164 + near * v;
    near = 0.246640727 + near * v;
    near = 1.50140941 + near * v;
    float u = sqrt(max(w, 0.0)) - 3.0;
    float far = -0.000200214257;
    far = 0.000100950558 + far * u;
    far = 0.00134934322 + far * u;
    far = -0.00367342844 + far * u;
    far = 0.00573950773 + far * u;
    far = -0.0076224613 + far * u;
    far = 0.00943887047 + far * u;
    far = 1.00167406 + far * u;
    far = 2.83297682 + far * u;
    return y * (w < 5.0 ? near : far);
}

// The tilt of the field in units of sigma_N. NOISE_TANGENT: the two Gaussians. NOISE_PAPER: their
// direction, and the angle whose rank among half-normal ones is the rank of their length among Rayleigh
// ones: erf(angle / sqrt 2) = 1 - exp(-length^2 / 2). So the angle is Gaussian, the azimuth uniform, and
// the tilt is smooth where it passes through 0.
vec2 smooth_tilt(int law, vec2 place, uint seed) {
    vec2 g = smooth_gaussians(place, seed);
    if (law == NOISE_TANGENT) return g;
    float length2 = dot(g, g);
    float angle = 1.41421356237310 * inverse_erf(exp(-0.5 * length2));
    return g * (angle * inversesqrt(max(length2, 1e-30)));
}
