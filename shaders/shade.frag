#version 330 core

// Pass 1: meet the object, tilt its normal by the grain, evaluate the fitted BRDF under a lamp at its
// place. Diffuse and specular go to separate targets, as XYZ relative to Y_n; alpha is the share of
// the pixel that the object covers, and XYZ is the mean over that share. Their CIELAB goes to a third,
// with L* split into its diffuse and its specular part (Ishii et al., eq. 1).
//   split = (L_d*, L_s*, a*, b*); off the object L_d* is OFF_OBJECT
//
// Constants: SHAPE, CAPS, LAMP, DIFFUSE_MODEL, LOBES, FRESNEL, SHADOWING, FACETS, NOISE, NOISY_DIFFUSE,
// GRAIN, SAMPLED, CUBE_ROOT, BANDS, PARTS (which targets).

#include "view.glsl"
#include "shape.glsl"
#include "brdf.glsl"
#include "noise.glsl"
#include "tone.glsl"

uniform vec3 half_extent_m;
#include "lamp.glsl"

uniform int samples;  // along each side of a pixel
// pi / (what the perfect diffuser shows at most), so that radiance comes out relative to Y_n.
uniform float irradiance;

uniform vec4 diffuse_terms;  // of the roughness: brdf.diffuse_terms
uniform vec4 lobe_shape[2];  // sharpness, amplitude, refractive index, spread: struct Lobe
uniform vec3 per_white;      // one over the white of the scene's lamp, whose Y is one

#include "grain.glsl"

// PARTS: 0 the split alone, 1 XYZ alone (of a picture whose split stays as it was drawn), 2 all.
#if PARTS == 0
layout(location = 0) out vec4 split;
#else
layout(location = 0) out vec4 diffuse;
layout(location = 1) out vec4 specular;
#if PARTS == 2
layout(location = 2) out vec4 split;
#endif
#endif

#if BANDS == 0
// Every shape is free of wavelength, so spectra fold into XYZ without error before a pixel is drawn.
uniform vec3 albedo_xyz;
uniform vec3 second_albedo_xyz;
uniform vec3 lobe_strength_xyz[2];

vec3 diffuse_xyz(vec2 shapes) {
    return shapes.x * albedo_xyz + shapes.y * second_albedo_xyz;
}

vec3 specular_xyz(vec2 reflected) {
    return reflected.x * lobe_strength_xyz[0] + (LOBES > 1 ? reflected.y * lobe_strength_xyz[1] : vec3(0.0));
}
#else
// Band by band, which draws the same: for the chart of speed against accuracy.
uniform vec3 band_weights[BANDS];
uniform vec4 band_reflectance[BANDS];  // albedo, second albedo, strength of each lobe

vec3 diffuse_xyz(vec2 shapes) {
    vec3 sum = vec3(0.0);
    for (int k = 0; k < BANDS; ++k) sum += dot(shapes, band_reflectance[k].xy) * band_weights[k];
    return sum;
}

vec3 specular_xyz(vec2 reflected) {
    vec3 sum = vec3(0.0);
    for (int k = 0; k < BANDS; ++k) sum += dot(reflected, band_reflectance[k].zw) * band_weights[k];
    return sum;
}
#endif

struct Light {
    vec3 diffuse;
    vec3 specular;
    float found;
};

Light light_through(ivec2 here, vec2 place) {
    vec3 ray = ray_through(here, place);
    Hit hit = meet(SHAPE, eye_m, ray, half_extent_m);
    float per_distance2;
    vec3 i = to_lamp(hit.point_m, per_distance2);
    vec3 o = -normalize(ray);
    Facing grain = facing(grain_normal(hit, o, here), i, o);
    Facing smooth_surface = grain;
    if (NOISE != NO_NOISE && NOISY_DIFFUSE == 0) smooth_surface = facing(hit.normal, i, o);
    float arriving = irradiance * per_distance2;
    vec2 shapes = diffuse_shapes(DIFFUSE_MODEL, smooth_surface, diffuse_terms);
    vec2 reflected = vec2(0.0);  // by each lobe, at unit strength
    for (int k = 0; k < LOBES; ++k) {
        vec4 shape = lobe_shape[k];
        reflected[k] = torrance_sparrow(grain, Lobe(shape.x, shape.y, shape.z, shape.w));
    }
    vec3 diffuse_light = arriving * max(smooth_surface.mu_i, 0.0) * diffuse_xyz(shapes);
    vec3 specular_light = arriving * max(grain.mu_i, 0.0) * specular_xyz(reflected);
    return Light(hit.found ? diffuse_light : vec3(0.0), hit.found ? specular_light : vec3(0.0),
                 hit.found ? 1.0 : 0.0);
}

void main() {
    ivec2 here = pixel();
    Light light = Light(vec3(0.0), vec3(0.0), 0.0);
    if (SAMPLED == 0) {
        light = light_through(here, vec2(0.5));
    } else {
        for (int k = 0; k < samples * samples; ++k) {
            vec2 place = (vec2(float(k % samples), float(k / samples)) + 0.5) / float(samples);
            Light one = light_through(here, place);
            light.diffuse += one.diffuse;
            light.specular += one.specular;
            light.found += one.found;
        }
        float mean = 1.0 / max(light.found, 1.0);
        light = Light(mean * light.diffuse, mean * light.specular,
                      light.found / float(samples * samples));
    }
#if PARTS != 0
    diffuse = vec4(light.diffuse, light.found);
    specular = vec4(light.specular, light.found);
#endif
#if PARTS != 1
    split = light.found > 0.0 ? split_lab(light.diffuse, light.specular, per_white)
                              : vec4(OFF_OBJECT, 0.0, 0.0, 0.0);
#endif
}
