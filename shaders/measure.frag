#version 330 core

// First step of the reduction: the extremes of one tile of pass 1, of BLOCK x BLOCK pixels STRIDE apart,
// inside a region.
//   extremes  = (smallest (100 - L_d) / L_s, largest L_d, largest L_s, 0)
//   brightest = (L*, L_d, L_s of the brightest pixel, number of pixels that are not finite)

#include "texel.glsl"
#include "tone.glsl"

uniform sampler2D split_image;
uniform ivec4 region;  // left, bottom, right, top: pixels

layout(location = 0) out vec4 extremes;
layout(location = 1) out vec4 brightest;

void main() {
    ivec2 first = region.xy + BLOCK * STRIDE * ivec2(gl_FragCoord.xy);
    extremes = vec4(1e30, -1e30, -1e30, 0.0);
    brightest = vec4(-1e30, 0.0, 0.0, 0.0);
    // Fixed bounds are unrolled. A tile at the edge takes its last pixels again: no extreme changes.
    for (int y = 0; y < BLOCK; ++y) {
        for (int x = 0; x < BLOCK; ++x) {
            ivec2 at = first + STRIDE * ivec2(x, y);
            vec4 split = texel(split_image, min(at, region.zw - 1));
            // What is not finite fails every comparison; some compilers fold isnan away.
            float size = dot(abs(split), vec4(1.0));
            bool finite = size < 1e30;
            bool seen = finite && on_object(split);
            brightest.w += finite || any(greaterThanEqual(at, region.zw)) ? 0.0 : 1.0;
            extremes.x = min(extremes.x, seen ? largest_c(split.xy) : 1e30);
            extremes.yz = max(extremes.yz, seen ? split.xy : vec2(-1e30));
            float total = split.x + split.y;
            brightest.xyz = seen && total > brightest.x ? vec3(total, split.xy) : brightest.xyz;
        }
    }
}
