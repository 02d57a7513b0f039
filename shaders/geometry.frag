#version 330 core

// What pass 1 sees at the centre of each pixel, or at the first of its samples that meets the object:
// normal before and after the tilt, point on the object. Drawn only when someone asks for it.
// Constants: SHAPE, CAPS, AFAR, NOISE, GRAIN, SURFACE, FINISHES, SAMPLED.

#include "view.glsl"
#include "shape.glsl"
#include "noise.glsl"
#include "grain_field.glsl"

uniform vec3 half_extent_m;
uniform int samples;  // along each side of a pixel

#include "seen.glsl"
#include "grain.glsl"
#if FINISHES > 0
#include "finish_look.glsl"
#endif

layout(location = 0) out vec4 normal;
layout(location = 1) out vec4 tilted_normal;
layout(location = 2) out vec4 point_m;

void main() {
    ivec2 here = pixel();
    vec2 place = vec2(0.5);
    vec3 ray = ray_through(here, place);
    Hit hit = seen(here, place, ray);  // of what is read, the sample that holds the centre
    for (int k = 0; k < samples * samples && !hit.found; ++k) {
        place = (vec2(float(k % samples), float(k / samples)) + 0.5) / float(samples);
        ray = ray_through(here, place);
        hit = seen(here, place, ray);
    }
#if FINISHES > 0
    float sigma = finishes_at(surface_at(here, place)).sigma_n;
#else
    float sigma = sigma_n;
#endif
    vec3 tilted = grain_normal(hit, -normalize(ray), here, place, sigma);
    normal = hit.found ? vec4(hit.normal, 1.0) : vec4(0.0);
    tilted_normal = hit.found ? vec4(tilted, 1.0) : vec4(0.0);
    point_m = hit.found ? vec4(hit.point_m, 1.0) : vec4(0.0);
}
