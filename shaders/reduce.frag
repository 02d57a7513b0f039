#version 330 core

// Further steps of the reduction: the extremes of BLOCK x BLOCK results of the step before.

uniform sampler2D extremes_image;
uniform sampler2D brightest_image;
uniform ivec4 region;  // left, bottom, right, top: pixels

layout(location = 0) out vec4 extremes;
layout(location = 1) out vec4 brightest;

void main() {
    ivec2 first = region.xy + BLOCK * ivec2(gl_FragCoord.xy);
    ivec2 last = min(first + BLOCK, region.zw);
    extremes = vec4(1e30, -1e30, -1e30, 0.0);
    brightest = vec4(-1e30, 0.0, 0.0, 0.0);
    for (int y = first.y; y < last.y; ++y) {
        for (int x = first.x; x < last.x; ++x) {
            vec4 e = texelFetch(extremes_image, ivec2(x, y), 0);
            vec4 b = texelFetch(brightest_image, ivec2(x, y), 0);
            extremes = vec4(min(extremes.x, e.x), max(extremes.yzw, e.yzw));
            brightest.w += b.w;
            if (b.x > brightest.x) brightest.xyz = b.xyz;
        }
    }
}
