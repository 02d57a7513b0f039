// Hash and Gaussian tilt of the normal. Twin: relgloss_view/picture/model/noise.py.

// pcg3d (Jarzynski, Olano 2020, "Hash functions for GPU rendering"). Integers: identical everywhere.
uvec3 pcg3d(uvec3 v) {
    v = v * 1664525u + 1013904223u;
    v.x += v.y * v.z;
    v.y += v.z * v.x;
    v.z += v.x * v.y;
    v ^= v >> 16u;
    v.x += v.y * v.z;
    v.y += v.z * v.x;
    v.z += v.x * v.y;
    return v;
}

// Three hashes of a grain cell (column, row, face); negative cells wrap, none repeats.
uvec3 cell_hash(ivec3 cell, uint seed) {
    return pcg3d(uvec3(uint(cell.x), uint(cell.y), seed + uint(cell.z) * 0x9E3779B9u));
}

// The upper 23 bits, centred: exact in float32, never 0 or 1, so the logarithm below is finite.
vec3 uniforms(uvec3 hash) {
    return (vec3(hash >> 9u) + 0.5) * 1.1920928955078125e-7;  // 2^-23
}

// cos(2 pi u) for u from 0 to 1 by the series of the sine to x^11, within 6e-8; the language leaves the
// precision of its own cos open.
float cosine_of_turn(float u) {
    float x = 6.28318530717959 * (abs(u - 0.5) - 0.25);  // cos(2 pi u) = sin(x), |x| <= pi/2
    float x2 = x * x;
    return x * (1.0 - x2 * (1.0 / 6.0 - x2 * (1.0 / 120.0 - x2 * (1.0 / 5040.0
             - x2 * (1.0 / 362880.0 - x2 * (1.0 / 39916800.0))))));
}

// (cos, sin) of 2 pi u.
vec2 direction_of_turn(float u) {
    return vec2(cosine_of_turn(u), cosine_of_turn(u < 0.25 ? u + 0.75 : u - 0.25));
}

// Two independent standard normals (Box, Muller 1958).
vec2 gaussians(vec2 u) {
    // The language grants log an error of 2^-21 near 1, so it may come out above 0 there.
    float radius = sqrt(max(-2.0 * log(u.x), 0.0));
    return radius * direction_of_turn(u.y);
}

// Tangent frame of a unit normal (Duff et al. 2017).
void frame(vec3 n, out vec3 tangent, out vec3 bitangent) {
    float side = n.z >= 0.0 ? 1.0 : -1.0;
    float a = -1.0 / (side + n.z);
    float b = n.x * n.y * a;
    tangent = vec3(1.0 + side * n.x * n.x * a, side * b, -side * n.x);
    bitangent = vec3(b, side + n.y * n.y * a, -n.y);
}

// Tilt angles along the tangent and bitangent, radians. NOISE_PAPER: the angle is Gaussian and its azimuth
// uniform (Ishii et al.: "theta follows Gaussian probability distribution"). NOISE_TANGENT: both components
// are Gaussian, so the angle is Rayleigh distributed.
vec2 tilt_angles(int law, uvec3 hash, float sigma) {
    vec3 u = uniforms(hash);
    vec2 g = gaussians(u.xy);
    if (law == NOISE_TANGENT) return sigma * g;
    return sigma * g.x * direction_of_turn(u.z);
}

// (cos(theta), sin(theta)/theta) of theta^2 by their series: within 3e-8 up to 1.02 rad, which is more
// than the largest sigma_N times the largest Gaussian that 23 bits make, 5.77.
vec2 turn(float t2) {
    return vec2(1.0 - t2 * (1.0 / 2.0 - t2 * (1.0 / 24.0 - t2 * (1.0 / 720.0
                - t2 * (1.0 / 40320.0 - t2 * (1.0 / 3628800.0))))),
                1.0 - t2 * (1.0 / 6.0 - t2 * (1.0 / 120.0 - t2 * (1.0 / 5040.0
                - t2 * (1.0 / 362880.0)))));
}

vec3 tilted(vec3 n, vec2 angles) {
    vec3 tangent, bitangent;
    frame(n, tangent, bitangent);
    vec2 t = turn(dot(angles, angles));
    return n * t.x + t.y * (angles.x * tangent + angles.y * bitangent);
}

// The normal of a grain as the eye sees it. A tilt that would turn the grain away from the eye is
// halved up to three times, then dropped: a hidden grain can't be seen, and must not be black.
vec3 visible_tilt(vec3 n, vec3 o, vec2 angles) {
    vec3 tangent, bitangent;
    frame(n, tangent, bitangent);
    // Whether a grain faces the eye follows without its normal. A software driver runs a loop's first turn
    // in any case, and further ones only where some pixel needs them.
    float along = dot(n, o);
    float across = dot(angles, vec2(dot(tangent, o), dot(bitangent, o)));
    float t2 = dot(angles, angles);
    float kept = 0.0;
    vec2 kept_turn = vec2(1.0);
    float share = 1.0;
    do {
        vec2 t = turn(share * share * t2);
        bool faces = kept == 0.0 && along * t.x + share * across * t.y > 0.0;
        kept = faces ? share : kept;
        kept_turn = faces ? t : kept_turn;
        share *= 0.5;
    } while (kept == 0.0 && share >= 0.125);
    return n * kept_turn.x + kept_turn.y * kept * (angles.x * tangent + angles.y * bitangent);
}

// A grain whose tilt follows from its hash.
vec3 noisy_normal(int law, vec3 n, vec3 o, uvec3 hash, float sigma) {
    if (law == NOISE_NONE || sigma <= 0.0) return n;
    return visible_tilt(n, o, tilt_angles(law, hash, sigma));
}
