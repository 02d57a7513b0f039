#version 330 core

// The largest Y of the perfect diffuser's picture, reduced by BLOCK x BLOCK tiles inside a region.
// Constant: FIRST, 1 where the source is the picture itself, 0 where it is the step before.
//   peak = (largest Y, number of pixels on the object, 0, 0)

uniform sampler2D source_image;
uniform ivec4 region;  // left, bottom, right, top: pixels

layout(location = 0) out vec4 peak;

void main() {
    ivec2 first = region.xy + BLOCK * ivec2(gl_FragCoord.xy);
    ivec2 last = min(first + BLOCK, region.zw);
    peak = vec4(0.0);
    for (int y = first.y; y < last.y; ++y) {
        for (int x = first.x; x < last.x; ++x) {
            vec4 source = texelFetch(source_image, ivec2(x, y), 0);
            if (FIRST == 1) source.xy = source.a > 0.0 ? vec2(source.y, 1.0) : vec2(0.0);
            peak.xy = vec2(max(peak.x, source.x), peak.y + source.y);
        }
    }
}
