#version 330 core

// Further steps of white.frag: the largest Y, and how many pixels, of BLOCK x BLOCK results of the step
// before.

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
            peak.xy = vec2(max(peak.x, source.x), peak.y + source.y);
        }
    }
}
