#version 330 core

// How many pixels are clipped (x) and how many out of gamut (y), summed by BLOCK x BLOCK tiles inside a
// region. Constant: FIRST, 1 where the source is what the tone pass shows, 0 the step before.

uniform sampler2D source_image;
uniform ivec4 region;  // left, bottom, right, top: pixels

layout(location = 0) out vec4 counts;

void main() {
    ivec2 first = region.xy + BLOCK * ivec2(gl_FragCoord.xy);
    ivec2 last = min(first + BLOCK, region.zw);
    counts = vec4(0.0);
    for (int y = first.y; y < last.y; ++y) {
        for (int x = first.x; x < last.x; ++x) {
            vec4 source = texelFetch(source_image, ivec2(x, y), 0);
            if (FIRST == 1) {
                float flags = 255.0 - floor(255.0 * source.a + 0.5);
                float outside = floor(0.5 * flags);
                source.xy = vec2(flags - 2.0 * outside, outside);
            }
            counts.xy += source.xy;
        }
    }
}
