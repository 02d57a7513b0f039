// The normal of a grain at a point of the object: which cell, which draw.

uniform float sigma_n;  // radians
uniform float grains_per_px;
uniform float grain_m;
uniform uint seed;

vec3 grain_normal(Hit hit, vec3 o, ivec2 pixel) {
    if (NOISE == NOISE_NONE) return hit.normal;
    ivec3 cell;
    if (GRAIN == GRAIN_SCREEN) {
        // Exact below 2^23 pixels; software drivers divide whole numbers one pixel at a time.
        cell = ivec3(ivec2(floor((vec2(pixel) + 0.5) * grains_per_px)), 0);
    } else {
        cell = surface_cell(SHAPE, hit, grain_m, half_extent_m);
    }
    return noisy_normal(NOISE, hit.normal, o, cell_hash(cell, seed), sigma_n);
}
