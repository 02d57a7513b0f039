#version 330 core

// How many pixels are clipped (x) and how many out of gamut (y), summed by BLOCK x BLOCK tiles inside a
// region. Constant: FIRST, 1 where the source is what the tone pass shows, 0 the step before.

uniform sampler2D source_image;
uniform ivec4 region;  // left, bottom, right, top: pixels

layout(location = 0) out vec4 counts;

void main() {
    ivec2 first = region.xy + BLOCK * ivec2(gl_FragCoord.xy);
    counts = vec4(0.0);
    // Fixed bounds are unrolled, which pays for the small tiles of the first step; what a tile at the edge
    // has beyond the region counts nothing.
    ivec2 side = FIRST == 1 ? ivec2(BLOCK) : min(ivec2(BLOCK), region.zw - first);
    for (int y = 0; y < side.y; ++y) {
        for (int x = 0; x < side.x; ++x) {
            ivec2 at = first + ivec2(x, y);
            vec4 source = texelFetch(source_image, min(at, region.zw - 1), 0);
            if (FIRST == 1) {
                float flags = mod(255.0 - floor(255.0 * source.a + 0.5), 4.0);
                float outside = floor(0.5 * flags);
                source.xy = vec2(flags - 2.0 * outside, outside);
            }
            counts.xy += all(lessThan(at, region.zw)) ? source.xy : vec2(0.0);
        }
    }
}
