#version 330 core

// What the perfect diffuser would show in the object's place under lamps of power pi: its largest Y in
// one BLOCK x BLOCK tile of a region of the picture, straight from the geometry.
//   peak = (largest Y, number of pixels on the object, 0, 0)
// Constants: BLOCK, SHAPE, CAPS, AFAR, LAMP, LAMPS, LAMP_SIZE, SAMPLED, SURFACE.

#include "view.glsl"
#include "shape.glsl"

uniform vec3 half_extent_m;
#include "lights.glsl"

uniform int samples;  // along each side of a pixel
#include "seen.glsl"
uniform ivec4 region;  // left, bottom, right, top: pixels

layout(location = 0) out vec4 peak;

// Y in x, 1 where the object is met in y.
vec2 white_through(ivec2 here, vec2 place) {
    vec3 ray = ray_through(here, place);
    Hit hit = seen(here, place, ray);
    float lit = 0.0;
    for (int lamp = 0; lamp < LAMPS; ++lamp) {
        Arriving from = light_of(lamp, hit.point_m);
        lit += max(dot(hit.normal, from.i), 0.0) * from.per_distance2;
    }
    bool faces_eye = dot(hit.normal, ray) < 0.0;
    float y = faces_eye ? lit : 0.0;
    return hit.found ? vec2(y, 1.0) : vec2(0.0);
}

void main() {
    ivec2 first = region.xy + BLOCK * ivec2(gl_FragCoord.xy);
    peak = vec4(0.0);
    for (int y = 0; y < BLOCK; ++y) {
        for (int x = 0; x < BLOCK; ++x) {
            // A tile at the edge takes its last pixels again, which changes no largest value.
            ivec2 at = min(first + ivec2(x, y), region.zw - 1);
            ivec2 here = ivec2(at.x, size_px.y - 1 - at.y);
            vec2 seen = vec2(0.0);
            if (SAMPLED == 0) {
                seen = white_through(here, vec2(0.5));
            } else {
                for (int k = 0; k < samples * samples; ++k) {
                    seen += white_through(here, (vec2(float(k % samples), float(k / samples)) + 0.5)
                                                / float(samples));
                }
            }
            peak.x = max(peak.x, seen.x / max(seen.y, 1.0));
            bool counted = all(lessThan(first + ivec2(x, y), region.zw));
            peak.y += counted && seen.y > 0.0 ? 1.0 : 0.0;
        }
    }
}
