// The weights of a pixel's reflections -> their XYZ. Every shape of the models is free of wavelength, so
// a reflection is a sum of spectra that are the same for the whole picture, each times a weight of the
// pixel. Constants: LOBES, METALS (bits of the lobes that are a metal's), BANDS.

#ifndef METALS
#define METALS 0
#endif
#if METALS != 0
// Where a lobe is a metal's, z and w of the weights are the white parts of the lobes.
uniform vec2 grazing_strength;
#endif

#if BANDS == 0
// The spectra are folded into XYZ before a pixel is drawn, without error.
uniform vec3 albedo_xyz;
uniform vec3 second_albedo_xyz;
uniform vec3 lobe_strength_xyz[2];

vec3 diffuse_xyz(vec2 weights) {
    return weights.x * albedo_xyz + weights.y * second_albedo_xyz;
}

vec3 specular_xyz(vec2 weights) {
    return weights.x * lobe_strength_xyz[0] + (LOBES > 1 ? weights.y * lobe_strength_xyz[1] : vec3(0.0));
}

#if METALS != 0
uniform vec3 lamp_white;

vec3 specular_xyz(vec4 weights) {
    return specular_xyz(weights.xy) + dot(weights.zw, grazing_strength) * lamp_white;
}
#endif
#else
// Band by band, which draws the same: for the chart of speed against accuracy.
uniform vec3 band_weights[BANDS];
uniform vec4 band_reflectance[BANDS];  // albedo, second albedo, strength of each lobe

vec3 diffuse_xyz(vec2 weights) {
    vec3 sum = vec3(0.0);
    for (int k = 0; k < BANDS; ++k) sum += dot(weights, band_reflectance[k].xy) * band_weights[k];
    return sum;
}

vec3 specular_xyz(vec2 weights) {
    vec3 sum = vec3(0.0);
    for (int k = 0; k < BANDS; ++k) sum += dot(weights, band_reflectance[k].zw) * band_weights[k];
    return sum;
}

#if METALS != 0
vec3 specular_xyz(vec4 weights) {
    float white = dot(weights.zw, grazing_strength);
    vec3 sum = vec3(0.0);
    for (int k = 0; k < BANDS; ++k)
        sum += (dot(weights.xy, band_reflectance[k].zw) + white) * band_weights[k];
    return sum;
}
#endif
#endif
