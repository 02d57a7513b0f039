#version 330 core

// Pass 1: meet the object, tilt its normal by the grain, evaluate the fitted BRDF under a lamp at its
// place. Diffuse and specular go to two separate float targets, relative to Y_n. What they hold:
//   WRITES_WEIGHTS        the weights of the models' shapes, from which colours.glsl makes XYZ; where the
//                         object is not seen, the first diffuse weight is OFF_OBJECT
//   WRITES_XYZ            XYZ, the mean over the share of the pixel that the object covers; alpha is that
//                         share; with finishes, specular's is their factor k of L_s*
// A cheaper method splits L* here instead of in pass 2 (Ishii et al., eq. 1):
//   WRITES_SPLIT          (L_d*, L_s*, a*, b*); where the object is not seen, L_d* is OFF_OBJECT
//   WRITES_XYZ_AND_SPLIT  both, where several samples share a pixel
//
// Constants: SHAPE, CAPS, AFAR, LAMP, LAMPS, LAMP_SIZE, AMBIENT, DIFFUSE, LOBES, METALS (see colours.glsl), FRESNEL, SHADOWING, FACETS,
// NOISE, NOISY_DIFFUSE, GRAIN,
// SAMPLED, CUBE_ROOT, BANDS, WRITES, SURFACE, FINISHES (0: one material; else see finishes.glsl).

#include "view.glsl"
#include "shape.glsl"
#include "brdf.glsl"
#include "noise.glsl"
#include "grain_field.glsl"
#include "tone.glsl"

uniform vec3 half_extent_m;
#include "lights.glsl"

uniform int samples;  // along each side of a pixel
// pi / (what the perfect diffuser shows at most), so that radiance comes out relative to Y_n.
uniform float irradiance;

#include "seen.glsl"

uniform vec4 diffuse_terms;  // of the roughness: brdf.diffuse_terms
uniform vec4 lobe_shape[2];  // sharpness, amplitude, refractive index, spread: struct Lobe

#include "grain.glsl"
#if LAMP_SIZE == 1
#include "lamp_size.glsl"
#endif
#ifndef AMBIENT
#define AMBIENT 0
#endif
#if AMBIENT == 1
#include "ambient.glsl"
#endif

// The weights of the lobes: one a lobe; where one is a metal's, two a lobe, the white parts last.
#if METALS == 0
#define LOBE_WEIGHTS vec2
#else
#define LOBE_WEIGHTS vec4
#endif
// What a point shows is kept as weights; with finishes or ambient light, which lobes reflect into the
// diffuse picture, as XYZ.
#if FINISHES > 0
#include "finishes.glsl"
#endif
#if FINISHES > 0 || AMBIENT == 1
#define DIFFUSE_LIGHT vec3
#define SPECULAR_LIGHT vec3
#else
#define DIFFUSE_LIGHT vec2
#define SPECULAR_LIGHT LOBE_WEIGHTS
#endif

#if WRITES == WRITES_WEIGHTS
layout(location = 0) out vec2 diffuse;
layout(location = 1) out LOBE_WEIGHTS specular;
#else
#include "colours.glsl"
#if WRITES == WRITES_SPLIT
layout(location = 0) out vec4 split;
#else
layout(location = 0) out vec4 diffuse;
layout(location = 1) out vec4 specular;
#endif
#if WRITES == WRITES_XYZ_AND_SPLIT
layout(location = 2) out vec4 split;
#endif
#if WRITES != WRITES_XYZ
uniform vec3 per_white;  // one over the white of the scene's lamp, whose Y is one
#endif
#endif

// What both parts show, and the share of the pixel that shows the object.
struct Light {
    DIFFUSE_LIGHT diffuse;
    SPECULAR_LIGHT specular;
    float share;
#if FINISHES > 0
    float k;
#endif
};

#if FINISHES > 0
// What a point of the object shows of one lamp; n is the normal of its grain.
Light lit_by(int lamp, Hit hit, vec3 n, vec3 o, Finishes finishes) {
    Arriving from = light_of(lamp, hit.point_m);
    Facing grain = facing(n, from.i, o);
    Facing smooth_surface = grain;
    if (NOISE != NOISE_NONE && NOISY_DIFFUSE == 0) smooth_surface = facing(hit.normal, from.i, o);
    vec3 diffuse_light, specular_light;
    LampSize lamp_size = LampSize(0.0, from.sin2_r);
#if LAMP_SIZE == 1
    lamp_size.share_across = across(n, from.i, o, grain);
#endif
    finishes_light(finishes, grain, smooth_surface, irradiance * from.per_distance2, lamp_size,
                   diffuse_light, specular_light);
    return Light(diffuse_light, specular_light, 1.0, finishes.k);
}
#else
// What a point of the object shows of one lamp; n is the normal of its grain.
Light lit_by(int lamp, Hit hit, vec3 n, vec3 o) {
    Arriving from = light_of(lamp, hit.point_m);
    Facing grain = facing(n, from.i, o);
    Facing smooth_surface = grain;
    if (NOISE != NOISE_NONE && NOISY_DIFFUSE == 0) smooth_surface = facing(hit.normal, from.i, o);
    float arriving = irradiance * from.per_distance2;
    vec2 shapes = diffuse_shapes(DIFFUSE, smooth_surface, diffuse_terms);
    LOBE_WEIGHTS reflected = LOBE_WEIGHTS(0.0);  // by each lobe, at unit strength
#if LAMP_SIZE == 1
    float share_across = across(n, from.i, o, grain);
#endif
    for (int k = 0; k < LOBES; ++k) {
        vec4 shape = lobe_shape[k];
        Lobe lobe = Lobe(shape.x, shape.y, shape.z, shape.w);
        Facing at = grain;
#if LAMP_SIZE == 1
        sized(at, lobe, share_across, from.sin2_r);
#endif
#if METALS == 0
        reflected[k] = torrance_sparrow(at, lobe);
#else
        vec2 parts = ((METALS >> k) & 1) == 1 ? metal_torrance_sparrow(at, lobe)
                                              : vec2(torrance_sparrow(at, lobe), 0.0);
        reflected[k] = parts.x;
        reflected[k + 2] = parts.y;
#endif
    }
    vec2 diffuse_weights = arriving * max(smooth_surface.mu_i, 0.0) * shapes;
    LOBE_WEIGHTS specular_weights = arriving * max(grain.mu_i, 0.0) * reflected;
#if AMBIENT == 1
    return Light(diffuse_xyz(diffuse_weights), specular_xyz(specular_weights), 1.0);
#else
    return Light(diffuse_weights, specular_weights, 1.0);
#endif
}
#endif

Light light_through(ivec2 here, vec2 place) {
    vec3 ray = ray_through(here, place);
    Hit hit = seen(here, place, ray);
    vec3 o = -normalize(ray);
#if FINISHES > 0
    Finishes finishes = finishes_at(surface_at(here, place));
    vec3 n = grain_normal(hit, o, here, place, finishes.sigma_n);
#define LIT_BY(lamp) lit_by(lamp, hit, n, o, finishes)
#else
    vec3 n = grain_normal(hit, o, here, place, sigma_n);
#define LIT_BY(lamp) lit_by(lamp, hit, n, o)
#endif
    Light light = LIT_BY(0);
#if LAMPS > 1
    for (int lamp = 1; lamp < LAMPS; ++lamp) {
        Light further = LIT_BY(lamp);
        light.diffuse += further.diffuse;
        light.specular += further.specular;
    }
#endif
#if AMBIENT == 1
    float smooth_mu_o = NOISE != NOISE_NONE && NOISY_DIFFUSE == 0 ? dot(hit.normal, o) : dot(n, o);
#if FINISHES > 0
    light.diffuse += finishes_ambient(finishes, dot(n, o), smooth_mu_o);
#else
    LOBE_WEIGHTS of_lobes = LOBE_WEIGHTS(looked_up(1, dot(n, o)));
    light.diffuse += surround(diffuse_xyz(looked_up(0, smooth_mu_o).xy), specular_xyz(of_lobes));
#endif
#endif
#if FINISHES > 0
    return Light(hit.found ? light.diffuse : vec3(0.0), hit.found ? light.specular : vec3(0.0),
                 hit.found ? 1.0 : 0.0, hit.found ? light.k : 0.0);
#else
    return Light(hit.found ? light.diffuse : DIFFUSE_LIGHT(0.0),
                 hit.found ? light.specular : SPECULAR_LIGHT(0.0), hit.found ? 1.0 : 0.0);
#endif
}

#if FINISHES > 0
const Light DARK = Light(vec3(0.0), vec3(0.0), 0.0, 0.0);
#else
const Light DARK = Light(DIFFUSE_LIGHT(0.0), SPECULAR_LIGHT(0.0), 0.0);
#endif

void main() {
    ivec2 here = pixel();
    Light light = DARK;
    if (SAMPLED == 0) {
        light = light_through(here, vec2(0.5));
    } else {
        for (int k = 0; k < samples * samples; ++k) {
            vec2 place = (vec2(float(k % samples), float(k / samples)) + 0.5) / float(samples);
            Light one = light_through(here, place);
            light.diffuse += one.diffuse;
            light.specular += one.specular;
            light.share += one.share;
#if FINISHES > 0
            light.k += one.k;
#endif
        }
        float mean = 1.0 / max(light.share, 1.0);
#if FINISHES > 0
        light.k *= mean;
#endif
        light.diffuse *= mean;
        light.specular *= mean;
        light.share = light.share / float(samples * samples);
    }
#if WRITES == WRITES_WEIGHTS
    diffuse = light.share > 0.0 ? light.diffuse : vec2(OFF_OBJECT, 0.0);
    specular = light.specular;
#else
#if FINISHES > 0
    vec3 diffuse_light = light.diffuse;
    vec3 specular_light = light.specular;
    float k = light.k;
#elif AMBIENT == 1
    vec3 diffuse_light = light.diffuse;
    vec3 specular_light = light.specular;
    float k = light.share;
#else
    vec3 diffuse_light = diffuse_xyz(light.diffuse);
    vec3 specular_light = specular_xyz(light.specular);
    float k = light.share;
#endif
#if WRITES != WRITES_SPLIT
    diffuse = vec4(diffuse_light, light.share);
    specular = vec4(specular_light, k);
#endif
#if WRITES != WRITES_XYZ
    split = light.share > 0.0 ? split_lab(diffuse_light, specular_light, per_white)
                              : vec4(OFF_OBJECT, 0.0, 0.0, 0.0);
#if FINISHES > 0
    split.y *= light.share > 0.0 ? k : 1.0;
#endif
#endif
#endif
}
