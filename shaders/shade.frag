#version 330 core

// Pass 1: meet the object, tilt its normal by the grain, evaluate the fitted BRDF under a lamp at its
// place. Diffuse and specular go to separate targets, as XYZ relative to Y_n; alpha is the share of
// the pixel that the object covers, and XYZ is the mean over that share.
//
// Constants: SHAPE, DIFFUSE_MODEL, LOBES, NOISE, NOISY_DIFFUSE, GRAIN, SAMPLED.

#include "view.glsl"
#include "shape.glsl"
#include "brdf.glsl"
#include "noise.glsl"

uniform vec3 half_extent_m;
uniform vec3 lamp_m;
uniform int samples;  // along each side of a pixel
// pi / (what the perfect diffuser shows at most), so that radiance comes out relative to Y_n.
uniform float irradiance;

uniform vec3 albedo_xyz;
uniform vec3 second_albedo_xyz;
uniform float diffuse_sigma;  // radians
uniform vec3 lobe_strength_xyz[2];
uniform vec3 lobe_shape[2];  // s (radians), facet amplitude, refractive index

#include "grain.glsl"

layout(location = 0) out vec4 diffuse;
layout(location = 1) out vec4 specular;

void main() {
    ivec2 here = pixel();
    vec3 diffuse_sum = vec3(0.0);
    vec3 specular_sum = vec3(0.0);
    float covered = 0.0;
    int side = SAMPLED == 1 ? samples : 1;  // one sample needs no loop, which costs a fifth
    for (int k = 0; k < side * side; ++k) {
        vec2 place = (vec2(float(k % side), float(k / side)) + 0.5) / float(side);
        vec3 ray = ray_through(here, place);
        Hit hit = meet(SHAPE, eye_m, ray, half_extent_m);
        if (!hit.found) continue;
        covered += 1.0;
        vec3 to_lamp = lamp_m - hit.point_m;
        float distance2 = dot(to_lamp, to_lamp);
        vec3 i = to_lamp / sqrt(distance2);
        vec3 o = -normalize(ray);
        vec3 n = grain_normal(hit, o, here);
        Facing grain = facing(n, i, o);
        Facing smooth_surface = grain;
        if (NOISE != NO_NOISE && NOISY_DIFFUSE == 0) smooth_surface = facing(hit.normal, i, o);
        vec2 shapes = diffuse_shapes(DIFFUSE_MODEL, smooth_surface, diffuse_sigma);
        float arriving = irradiance / distance2;
        diffuse_sum += arriving * max(smooth_surface.mu_i, 0.0)
                     * (shapes.x * albedo_xyz + shapes.y * second_albedo_xyz);
        for (int lobe = 0; lobe < LOBES; ++lobe) {
            vec3 shape = lobe_shape[lobe];
            float reflected = torrance_sparrow(grain, shape.x, shape.y, shape.z);
            specular_sum += arriving * max(grain.mu_i, 0.0) * reflected * lobe_strength_xyz[lobe];
        }
    }
    float share = covered / float(side * side);
    diffuse = vec4(diffuse_sum / max(covered, 1.0), share);
    specular = vec4(specular_sum / max(covered, 1.0), share);
}
