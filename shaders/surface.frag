#version 330 core

// What each place of the picture sees of an object that is drawn from triangles or has finishes: point, normal,
// and what is printed there. It depends neither on the lamp nor on sigma_N, k or c.
//   surface_point  = point (m), part of the object
//   surface_normal = unit normal, 1 where the object is seen
//   paint          = artwork: XYZ under D50, times alpha, and alpha
//   second         = the same for the second albedo of the inks'
//                    diffuse model, where they have one in common
//   shares         = specular, then diffuse shares of the finishes, four a target
// Constants: SHAPE, CAPS, AFAR, FINISHES, CHANNELS (targets of four that hold the shares' channels).

#ifndef FINISHES
#define FINISHES 0
#endif

#include "view.glsl"
#include "shape.glsl"

uniform vec3 half_extent_m;
uniform int samples;         // texels along each side of a pixel
uniform ivec2 surface_from;  // lower left of the target, in texels of the picture

layout(location = 0) out vec4 surface_point;
layout(location = 1) out vec4 surface_normal;

// A hit with what a change of the place in the picture does to it.
struct Sight {
    Hit hit;
    vec3 facet;     // normal of the plane in which the point moves
    vec3 across;    // gradient of the label's x along the surface
    vec3 upwards;   // gradient of the label's y
    vec2 label_m;
};

#if SHAPE == SHAPE_TRIANGLES
#include "triangles.glsl"
#else
#include "facets.glsl"
#endif

#if FINISHES > 0
#include "artwork.glsl"
#if INK_SECOND >= 0
#include "second_paint.glsl"
uniform float ink_mean;  // of all inks: finish_second
#endif
layout(location = 2) out vec4 paint;
layout(location = 3) out vec4 second;
layout(location = 4) out vec4 shares_0;
#if FINISHES > 2
layout(location = 5) out vec4 shares_1;
#endif
#if FINISHES > 4
layout(location = 6) out vec4 shares_2;
#endif
#if FINISHES > 6
layout(location = 7) out vec4 shares_3;
#endif
#endif

void main() {
    ivec2 texel = ivec2(gl_FragCoord.xy) + surface_from;
    ivec2 from_below = texel / samples;
    ivec2 inner = texel - samples * from_below;
    ivec2 here = ivec2(from_below.x, size_px.y - 1 - from_below.y);
    vec2 place = (vec2(inner.x, samples - 1 - inner.y) + 0.5) / float(samples);
    vec3 ray = ray_through(here, place);
    vec3 start = start_m(here, place);
    Sight sight = sight_through(start, ray);
    bool found = sight.hit.found;
    surface_point = found ? vec4(sight.hit.point_m, float(sight.hit.face)) : vec4(0.0);
    surface_normal = found ? vec4(sight.hit.normal, 1.0) : vec4(0.0, 0.0, 1.0, 0.0);
#if FINISHES > 0
    // Travel from the eye, in lengths of the ray.
    float travel = dot(sight.hit.point_m - start, ray) / dot(ray, ray) + (AFAR == 1 ? 1.0 : 0.0);
    float step = pixel_step / float(samples);
    vec3 right = moved(step * view_right, sight.facet, ray, travel);
    vec3 down = moved(-step * view_up, sight.facet, ray, travel);
    vec4 turns = vec4(dot(sight.across, right), dot(sight.upwards, right),
                      dot(sight.across, down), dot(sight.upwards, down));
    Print print = print_at(sight.label_m, turns, found, sight.hit.face);
    paint = print.paint;
    second = vec4(0.0);
#if INK_SECOND >= 0
    second = vec4(second_paint(INK_SECOND, print.paint, ink_mean), 0.0);
#endif
    shares_0 = print.shares[0];
#if FINISHES > 2
    shares_1 = print.shares[1];
#endif
#if FINISHES > 4
    shares_2 = print.shares[2];
#endif
#if FINISHES > 6
    shares_3 = print.shares[3];
#endif
#endif
}
