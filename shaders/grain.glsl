// The normal of a grain at a point of the object: which cell, which draw.

uniform float sigma_n;  // radians
uniform float grains_per_px;
uniform float grain_m;
uniform uint seed;
#if NOISE != NOISE_NONE && GRAIN == GRAIN_EYE
uniform int grain_samples;  // texels of the field along each side of a pixel
uniform vec2 per_field;  // one over the field's width and height, texels
uniform sampler2D grain_field;  // grain_field.frag
#endif

// place: inside the pixel, (0.5, 0.5) its centre. sigma: of the tilt, radians.
vec3 grain_normal(Hit hit, vec3 o, ivec2 pixel, vec2 place, float sigma) {
    if (NOISE == NOISE_NONE) return hit.normal;
#if NOISE != NOISE_NONE && GRAIN == GRAIN_EYE
    ivec2 texel = grain_samples * pixel + ivec2(place * float(grain_samples));
    vec2 at = (vec2(texel & (FIELD_TILE - 1)) + 0.5) * per_field;
    return visible_tilt(hit.normal, o, sigma * textureLod(grain_field, at, 0.0).xy);
#else
    ivec3 cell;
    if (GRAIN == GRAIN_SCREEN) {
        // Exact below 2^23 pixels; software drivers divide whole numbers one pixel at a time.
        cell = ivec3(ivec2(floor((vec2(pixel) + 0.5) * grains_per_px)), 0);
    } else {
        cell = surface_cell(SHAPE, hit, grain_m, half_extent_m);
    }
    return noisy_normal(NOISE, hit.normal, o, cell_hash(cell, seed), sigma);
#endif
}
